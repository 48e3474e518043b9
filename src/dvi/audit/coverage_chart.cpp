#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dvi/audit/coverage.h"

namespace dvi::audit {
namespace {

constexpr int kHeightPx = 240, kLeftPx = 70, kRightPx = 30, kTopPx = 64, kBottomPx = 56;
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kFontScale = 0.42;
constexpr int kMinWidthPx = 640, kMaxBarPx = 24;
const cv::Scalar kWhite(255, 255, 255), kInk(40, 40, 40), kGrid(215, 215, 215);
const cv::Scalar kCopied(180, 120, 40), kElsewhere(60, 160, 240), kUnobserved(190, 190, 190);

void draw_text(cv::Mat3b& chart, const std::string& text, cv::Point at) {
  cv::putText(chart, text, at, kFont, kFontScale, kInk, 1, cv::LINE_AA);
}

int to_row(double share) { return kTopPx + cvRound((1 - share) * kHeightPx); }

/// Draws the frame numbers below the bars that have room for them.
void draw_frame_axis(cv::Mat3b& chart, int bar, const std::vector<int>& numbers) {
  constexpr int kMinDistancePx = 64;
  const int every = std::max(1, (kMinDistancePx + bar - 1) / bar), frames = static_cast<int>(numbers.size()),
            y = kTopPx + kHeightPx;
  for (int i = 0; i < frames; i += every) {
    const int x = kLeftPx + i * bar + bar / 2;
    cv::line(chart, {x, y}, {x, y + 4}, kInk);
    const std::string text = std::to_string(numbers[static_cast<std::size_t>(i)]);
    draw_text(chart, text, {x - cv::getTextSize(text, kFont, kFontScale, 1, nullptr).width / 2, y + 18});
  }
  cv::line(chart, {kLeftPx, y}, {kLeftPx + frames * bar, y}, kInk);
  draw_text(chart, "frame number", {kLeftPx + frames * bar / 2 - 44, y + 42});
}

void draw_share_axis(cv::Mat3b& chart, int right) {
  draw_text(chart, "share of the removed area", {8, kTopPx - 14});
  for (const int percent : {0, 25, 50, 75, 100}) {
    const int y = to_row(percent / 100.0);
    cv::line(chart, {kLeftPx, y}, {right, y}, kGrid);
    draw_text(chart, std::to_string(percent) + " %", {8, y + 4});
  }
}

void draw_legend(cv::Mat3b& chart) {
  int x = kLeftPx;
  for (const auto& [color, text] : {std::pair(kCopied, "observed by this drive"),
                                    std::pair(kElsewhere, "observed by source drives"), std::pair(kUnobserved, "unobserved")}) {
    cv::rectangle(chart, cv::Rect(x, 12, 12, 12), color, cv::FILLED);
    draw_text(chart, text, {x + 18, 22});
    x += 220;
  }
}

}  // namespace

cv::Mat3b draw_coverage_chart(const Coverage& coverage, const std::vector<int>& numbers) {
  const int frames = static_cast<int>(coverage.frames.size());
  const int bar = std::clamp(kMinWidthPx / std::max(frames, 1), 1, kMaxBarPx);
  cv::Mat3b chart(kTopPx + kHeightPx + kBottomPx, std::max(kMinWidthPx, frames * bar) + kLeftPx + kRightPx);
  chart.setTo(kWhite);
  draw_share_axis(chart, kLeftPx + frames * bar);
  draw_frame_axis(chart, bar, numbers);
  draw_legend(chart);
  for (int i = 0; i < frames; ++i) {
    const HoleShares& hole = coverage.frames[i].hole;
    double base = 0;
    for (const auto& [color, share] : {std::pair(kCopied, hole.copied), std::pair(kElsewhere, hole.copied_elsewhere),
                                       std::pair(kUnobserved, hole.unobserved)}) {
      const int top = to_row(base + share), bottom = to_row(base);
      if (bottom > top) chart(cv::Rect(kLeftPx + i * bar, top, bar > 3 ? bar - 1 : bar, bottom - top)).setTo(color);
      base += share;
    }
  }
  return chart;
}

}  // namespace dvi::audit
