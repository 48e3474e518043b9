#include "dvi/labels/coco_runs.h"

#include <limits>
#include <numeric>
#include <stdexcept>

namespace dvi::labels {

// Each character has six bits, five of them of the value. From the third run on, a run is stored as the difference from the run
// before the previous one.
std::vector<std::uint32_t> decode_runs(std::string_view text) {
  constexpr char kZeroDigit = '0';
  constexpr int kMoreBit = 0x20, kSignBit = 0x10, kValueBits = 0x1F, kMaxDigits = 6;
  std::vector<std::int64_t> runs;
  for (std::size_t at = 0; at < text.size();) {
    std::int64_t run = 0;
    int digit = 0, bits = kMoreBit;
    for (; bits & kMoreBit; ++digit) {
      if (at == text.size() || digit > kMaxDigits) throw std::invalid_argument("its outline is truncated");
      bits = text[at++] - kZeroDigit;
      run |= static_cast<std::int64_t>(bits & kValueBits) << (5 * digit);
    }
    if (bits & kSignBit) run -= std::int64_t{1} << (5 * digit);
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
