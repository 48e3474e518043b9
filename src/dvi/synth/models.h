#pragma once

#include "dvi/synth/paint.h"
#include "dvi/synth/solid.h"

namespace dvi::synth {

/// An object at the origin of its own axes: x forward, y left, z up from the ground.
struct Model {
  std::string type;  ///< the class of its labels
  Solid solid;
  Eigen::Vector3d size;  ///< of its bounding box, centered above the origin
};

Model make_car(Random random, const Noise& noise);
Model make_van(Random random, const Noise& noise);
Model make_truck(Random random, const Noise& noise);
Model make_pedestrian(Random random, const Noise& noise);
/// Makes a walking person: one model for each of kGaitPhases equal parts of a stride of kStrideM meters (two steps).
inline constexpr int kGaitPhases = 16;
inline constexpr double kStrideM = 1.4;
std::vector<Model> make_walker(Random random, const Noise& noise);

/// Paints leaves with gaps between them; `cover` is the approximate share of leaves.
TexturePtr paint_leaves(Random random, double cover);
/// Paints one color with noise.
TexturePtr paint_plain(Random random, const Noise& noise, const cv::Scalar& color, double amplitude = 6);

/// Makes a trunk with a crown of leafy planes with gaps.
Model make_tree(Random random, const TexturePtr& bark, const TexturePtr& leaves);
/// Makes a planter with a hedge of several leafy planes.
Model make_hedge(double length, const TexturePtr& planter, const TexturePtr& leaves);

/// Adds a frustum with the faces left, right, front, back, and top between a lower and an upper rectangle; a null texture omits
/// a face.
struct Rectangle {
  double back, front, half_width, z;
};
struct Faces {
  TexturePtr left, right, front, back, top;
  bool mirrored = true;  ///< mirrors the picture of the right face, so that its front is in front
};
void add_frustum(Solid& solid, const Rectangle& low, const Rectangle& high, const Faces& faces);

/// A limb with a square cross-section. Both ends have the same y.
struct Limb {
  Eigen::Vector3d low, high;
  double half_width;
};
void add_limb(Solid& solid, const Limb& limb, const TexturePtr& cloth);

}  // namespace dvi::synth
