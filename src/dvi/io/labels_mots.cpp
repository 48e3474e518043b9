#include <limits>
#include <numeric>

#include "dvi/io/labels.h"
#include "dvi/io/text.h"

namespace dvi::io {
namespace {

constexpr int kCar = 1, kPedestrian = 2, kIgnore = 10;
constexpr int kIdsAClass = 1000;  // an id is class * 1000 + the number of the track

// COCO's compressed runs: six bits a character, five of them value, from the third run on as difference to the one before last.
std::vector<std::uint32_t> decode_runs(const TextLine& line, const std::string& text) {
  constexpr char kZero = '0';
  constexpr int kMore = 0x20, kSign = 0x10, kValue = 0x1F, kLongest = 6;
  std::vector<std::int64_t> runs;
  for (std::size_t at = 0; at < text.size();) {
    std::int64_t run = 0;
    int digit = 0, bits = kMore;
    for (; bits & kMore; ++digit) {
      if (at == text.size() || digit > kLongest) line.fail("its outline is cut");
      bits = text[at++] - kZero;
      run |= static_cast<std::int64_t>(bits & kValue) << (5 * digit);
    }
    if (bits & kSign) run -= std::int64_t{1} << (5 * digit);
    if (runs.size() > 2) run += runs[runs.size() - 2];
    if (run < 0 || run > std::numeric_limits<std::uint32_t>::max()) line.fail("its outline is malformed");
    runs.push_back(run);
  }
  return {runs.begin(), runs.end()};
}

}  // namespace

LabelsByNumber read_mots(const fs::path& file, cv::Size size) {
  LabelsByNumber labels;
  for (const TextLine& line : read_text_lines(file)) {
    if (line.size() != 6)
      line.fail("has " + std::to_string(line.size()) + " entries instead of 6", "frame id class height width rle");
    const int type = line.integer(2);
    std::vector<Label>& frame_labels = labels[line.integer(0)];
    if (type == kIgnore) continue;
    const cv::Size own(line.integer(4), line.integer(3));
    if (own != size)
      line.fail("is of an image of " + std::to_string(own.width) + "x" + std::to_string(own.height) +
                " pixels, the drive's are " + std::to_string(size.width) + "x" + std::to_string(size.height));
    Label label;
    label.track = line.integer(1) % kIdsAClass;
    label.type = type == kCar ? "car" : type == kPedestrian ? "pedestrian" : "class " + std::to_string(type);
    label.instance = Instance{own, decode_runs(line, line.word(5))};
    const auto& runs = label.instance->runs;
    if (std::accumulate(runs.begin(), runs.end(), std::int64_t{0}) != own.area())
      line.fail("its outline does not fill the image");
    frame_labels.push_back(std::move(label));
  }
  return labels;
}

}  // namespace dvi::io
