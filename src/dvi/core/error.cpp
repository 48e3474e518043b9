#include "dvi/core/error.h"

namespace dvi {

InputError::InputError(const std::filesystem::path& path, const std::string& problem, const std::string& remedy)
    : std::runtime_error(path.string() + ": " + problem + (remedy.empty() ? "" : "; " + remedy)) {}

}  // namespace dvi
