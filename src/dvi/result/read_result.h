#pragma once

#include "dvi/core/files.h"
#include "dvi/drive/drive.h"
#include "dvi/drive/view.h"
#include "dvi/objects/residue.h"

namespace dvi::result {

/// Returns a function that reads the finished frames of the target from the output folder, to measure the residue of its
/// objects. It refers to the drive and its views, which must outlive it.
objects::ReadResult make_result_reader(const fs::path& out, const Drive& target, const Views& views);

}  // namespace dvi::result
