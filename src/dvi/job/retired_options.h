#pragma once

#include <vector>

#include "dvi/core/options.h"

namespace dvi::job {

/// The options of earlier versions that were renamed or removed.
std::vector<RetiredOption> retired_options();

}  // namespace dvi::job
