#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/core/interrupt.h"
#include "dvi/drive/label.h"
#include "dvi/geometry/box.h"
#include "dvi/geometry/camera.h"

namespace dvi::metrics {

/// Parameters of the ghost counts.
struct GhostParams {
  double inner_share = 0.85;     ///< of a box in each direction, which its object fills
  double behind_m = 0.5;         ///< distance behind a box from which a point does not belong to its object
  double before_m = 0.2;         ///< distance before a box up to which a point belongs to its object
  double unknown_depth_m = 500;  ///< of pixels without depth, such as the sky
  std::size_t worst_frames = 5;  ///< listed frames
};
inline constexpr GhostParams kGhost;

/// An object that stays in place during the whole drive.
struct StationaryObject {
  int track = -1;
  std::string type;
  Box world;  ///< world axes
};

/// A camera at the time of one of its frames.
struct GhostSource {
  Camera camera;
  SE3 camera_from_world;
  std::map<int, Instance> outlines = {};  ///< by track: the outlines of objects whose labels in this frame have one
};

/// The removed objects and the sources of a result.
struct GhostScene {
  std::vector<StationaryObject> objects;
  std::vector<std::string> frames;                  ///< names of the target's frames, which are the first sources
  std::vector<std::optional<GhostSource>> sources;  ///< by source number; nothing for sources that are not judged
};

/// Copied pixels.
struct GhostCounts {
  std::size_t copied = 0;  ///< from the sources of the scene
  std::size_t ghosts = 0;  ///< their source pixel shows a stationary object in front of the copied point
  std::size_t in_map = 0;  ///< the copied point lies in a stationary object

  GhostCounts& operator+=(const GhostCounts& other);
  double ghost_share() const;  ///< of the copied pixels; 0 if there are none
  double in_map_share() const;
};

/// The pixels in which a stationary object is removed.
struct GhostTrack {
  int track = -1;
  std::string type;
  std::size_t removed = 0;   ///< pixels of the holes in its silhouette, of all frames
  std::size_t refilled = 0;  ///< ghosts among them

  double refilled_share() const;  ///< 0 if nothing is removed
};

struct GhostFrame {
  std::string name;
  GhostCounts counts;
};

/// How much of a result is filled with removed objects that stay in place. No truth is needed.
struct Ghosts {
  GhostCounts total;
  std::size_t unjudged = 0;        ///< copied pixels from sources that the scene leaves out
  std::vector<GhostTrack> tracks;  ///< of all objects, in the order of the scene
  std::vector<GhostFrame> frames;  ///< in order

  /// Returns the frames with the most ghosts, at most kGhost.worst_frames, without those that have none.
  std::vector<GhostFrame> find_worst_frames() const;
};

/// Counts the ghosts in the frames of a run (kind/, provenance/, depth/). The source pixel of a copy shows an object if its ray
/// passes through the object's box, shrunk to its inner share, and ends behind it, and if it lies in the object's outline where
/// the source has one: beside it, the box shows the background. Other objects that hide the box are not taken into account.
/// Frames that are not in frames/ are left out. Calls `tick` once per frame. Throws InputError if an image is missing or
/// differs in size from the camera, or if a pixel has a source that the scene does not have.
Ghosts count_ghosts(const fs::path& out, const GhostScene& scene, const Tick& tick = [] {});

}  // namespace dvi::metrics
