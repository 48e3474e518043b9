#include "dvi/labels/coco_runs.h"

#include <limits>
#include <numeric>
#include <stdexcept>

namespace dvi::labels {

// Six bits a character, five of them value, from the third run on as difference to the one before last.
std::vector<std::uint32_t> decode_runs(std::string_view text) {
  constexpr char kZero = '0';
  constexpr int kMore = 0x20, kSign = 0x10, kValue = 0x1F, kLongest = 6;
  std::vector<std::int64_t> runs;
  for (std::size_t at = 0; at < text.size();) {
    std::int64_t run = 0;
    int digit = 0, bits = kMore;
    for (; bits & kMore; ++digit) {
      if (at == text.size() || digit > kLongest) throw std::invalid_argument("its outline is cut");
      bits = text[at++] - kZero;
      run |= static_cast<std::int64_t>(bits & kValue) << (5 * digit);
    }
    if (bits & kSign) run -= std::int64_t{1} << (5 * digit);
    if (runs.size() > 2) run += runs[runs.size() - 2];
    if (run < 0 || run > std::numeric_limits<std::uint32_t>::max()) throw std::invalid_argument("its outline is malformed");
    runs.push_back(run);
  }
  return {runs.begin(), runs.end()};
}

void require_filled(const std::vector<std::uint32_t>& runs, cv::Size size) {
  if (std::accumulate(runs.begin(), runs.end(), std::int64_t{0}) != std::int64_t{size.width} * size.height)
    throw std::invalid_argument("its outline does not fill the image");
}

}  // namespace dvi::labels
