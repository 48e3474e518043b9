#include "dvi/metrics/point_scores.h"

#include <cmath>
#include <limits>

#include "dvi/drive/point_labels.h"

namespace dvi::metrics {
namespace {

double divide(std::size_t part, std::size_t whole) {
  return whole == 0 ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

PointCounts& PointCounts::operator+=(const PointCounts& other) {
  statics += other.statics;
  labeled_static += other.labeled_static;
  dynamics += other.dynamics;
  labeled_dynamic += other.labeled_dynamic;
  return *this;
}

double PointCounts::static_accuracy() const { return divide(labeled_static, statics); }
double PointCounts::dynamic_accuracy() const { return divide(labeled_dynamic, dynamics); }
double PointCounts::associated_accuracy() const { return std::sqrt(static_accuracy() * dynamic_accuracy()); }
double PointCounts::dynamic_iou() const { return divide(labeled_dynamic, dynamics + statics - labeled_static); }

PointScores& PointScores::operator+=(const PointScores& other) {
  scans += other.scans;
  all += other.all;
  in_view += other.in_view;
  return *this;
}

PointScores score_labels(const std::vector<std::uint32_t>& truth, const std::vector<std::uint32_t>& labels,
                         const std::vector<bool>& in_view) {
  PointScores out{1, {}, {}};
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const bool is_dynamic = is_moving_point_class(class_of_point(truth[i]));
    const bool is_right = is_moving_point_class(class_of_point(labels[i])) == is_dynamic;
    for (PointCounts* counts : {&out.all, in_view[i] ? &out.in_view : nullptr}) {
      if (!counts) continue;
      ++(is_dynamic ? counts->dynamics : counts->statics);
      if (is_right) ++(is_dynamic ? counts->labeled_dynamic : counts->labeled_static);
    }
  }
  return out;
}

}  // namespace dvi::metrics
