#pragma once

#include <functional>
#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/core/lazy.h"
#include "dvi/core/progress.h"
#include "dvi/drive/point_labels.h"

namespace dvi::exports {

/// The scans of the drive of a result, with labels of the removed objects.
struct LabeledScans {
  std::vector<std::string> names;  ///< of the scans, in order
  Lazy<PointLabels> labels;        ///< per scan: one per point of its file, in the order of the file
};

/// Returns, per point of a scan's file, whether it is one of a removed object.
std::vector<bool> find_removed_points(const LabeledScans& scans, std::size_t scan);

/// Labels the scans of a finished result of `dvi run` (commands::label_scans()).
using LabelScans = std::function<LabeledScans(const fs::path& out, Progress& progress)>;

}  // namespace dvi::exports
