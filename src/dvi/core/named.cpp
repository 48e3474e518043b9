#include "dvi/core/named.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace dvi {

void refuse_name(const std::vector<std::string>& names) {
  throw std::invalid_argument(fmt::format("must be one of {}", fmt::join(names, ", ")));
}

}  // namespace dvi
