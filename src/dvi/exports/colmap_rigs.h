#pragma once

#include <string>

#include "dvi/exports/result.h"

namespace dvi::exports {

/// The files rigs.txt and frames.txt of a COLMAP model, which versions from 3.12 on read.
struct ColmapRigs {
  std::string rigs, frames;
};

/// Describes the cameras of a result as rigs. Cameras whose pose relative to the first camera is the same at all times (within
/// 1 cm and 0.1 degrees of the mean) form a rig with it; images taken at the same time, to 5 ms, are one frame of it. Every
/// other camera is a rig of its own, because it is triggered at other times. Image and camera numbers are those of images.txt
/// and cameras.txt: the indices in the result plus 1.
ColmapRigs describe_rigs(const Result& result);

}  // namespace dvi::exports
