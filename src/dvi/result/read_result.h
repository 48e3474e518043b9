#pragma once

#include <string>

#include "dvi/core/files.h"
#include "dvi/drive/drive.h"
#include "dvi/drive/view.h"
#include "dvi/objects/residue.h"

namespace dvi::result {

/// The frames of one camera in a result.
struct ResultOfCamera {
  fs::path out;
  std::string camera;  ///< in the names of the frames (core/frame_name.h)
  int sequence = 0;    ///< that of its views
};

/// Returns a function that reads the finished frames of a camera, to measure the residue of its objects. It refers to the drive
/// and its views, which must outlive it.
objects::ReadResult make_result_reader(const ResultOfCamera& result, const Drive& drive, const Views& views);

}  // namespace dvi::result
