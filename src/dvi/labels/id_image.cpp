#include "dvi/labels/id_image.h"

#include <opencv2/core.hpp>

#include "dvi/drive/outline.h"

namespace dvi::labels {

std::map<int, Instance> outline_ids(const cv::Mat1i& ids) {
  std::map<int, cv::Rect> parts;
  for (int y = 0; y < ids.rows; ++y)
    for (int x = 0; x < ids.cols; ++x) {
      const int id = ids(y, x);
      if (id == 0) continue;
      int end = x + 1;
      while (end < ids.cols && ids(y, end) == id) ++end;
      const cv::Rect run(x, y, end - x, 1);
      const auto [part, is_new] = parts.emplace(id, run);
      if (!is_new) part->second |= run;
      x = end - 1;
    }
  std::map<int, Instance> outlines;
  for (const auto& [id, part] : parts) {
    cv::Mat1b mask;
    cv::compare(ids(part), id, mask, cv::CMP_EQ);
    outlines[id] = to_outline(mask, part.tl(), ids.size());
  }
  return outlines;
}

}  // namespace dvi::labels
