#pragma once

#include "dvi/synth/paint.h"
#include "dvi/synth/solid.h"

namespace dvi::synth {

/// Something that stands at the origin of its own axes: x forward, y left, z up from the ground.
struct Model {
  std::string type;  ///< as a label names it
  Solid solid;
  Eigen::Vector3d size;  ///< of the box round it, centered above the origin
};

Model make_car(Random random, const Noise& noise);
Model make_van(Random random, const Noise& noise);
Model make_truck(Random random, const Noise& noise);
Model make_pedestrian(Random random, const Noise& noise);
/// A person who walks: one model for each of kGaitPhases equal parts of a stride of kStride meters, two steps.
inline constexpr int kGaitPhases = 16;
inline constexpr double kStride = 1.4;
std::vector<Model> make_walker(Random random, const Noise& noise);

/// Leaves with gaps between them; `cover` is about the share that is leaf.
TexturePtr paint_leaves(Random random, double cover);
/// One color, rough.
TexturePtr paint_plain(Random random, const Noise& noise, const cv::Scalar& color, double amplitude = 6);

/// A trunk and a crown of leafy planes with gaps.
Model make_tree(Random random, const TexturePtr& bark, const TexturePtr& leaves);
/// A planter with a hedge of several leafy planes.
Model make_hedge(double length, const TexturePtr& planter, const TexturePtr& leaves);

/// A frustum: faces left, right, front, back, top between a lower and an upper rectangle; a null texture leaves a face out.
struct Rectangle {
  double back, front, half_width, z;
};
struct Faces {
  TexturePtr left, right, front, back, top;
  bool mirrored = true;  ///< the right face's picture, so that what is in front stays in front
};
void add_frustum(Solid& solid, const Rectangle& low, const Rectangle& high, const Faces& faces);

}  // namespace dvi::synth
