#pragma once

#include <nlohmann/json_fwd.hpp>

#include "dvi/inputs/recordings.h"

namespace dvi::result {

/// Returns the contents of sources.json: the image of each source number in the provenance, and all cameras.
nlohmann::json sources_json(const Views& views, const inputs::Recordings& drives);

}  // namespace dvi::result
