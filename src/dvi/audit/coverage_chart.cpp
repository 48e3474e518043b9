#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "dvi/audit/forecast.h"

namespace dvi::audit {
namespace {

constexpr int kHeight = 240, kLeft = 70, kRight = 30, kTop = 64, kBottom = 56;  // px
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kSize = 0.42;
constexpr int kLeastWidth = 640, kWidestBar = 24;
const cv::Scalar kWhite(255, 255, 255), kInk(40, 40, 40), kGrid(215, 215, 215);
const cv::Scalar kCopied(180, 120, 40), kElsewhere(60, 160, 240), kNever(190, 190, 190);

void write(cv::Mat3b& chart, const std::string& text, cv::Point at) {
  cv::putText(chart, text, at, kFont, kSize, kInk, 1, cv::LINE_AA);
}

int row_of(double share) { return kTop + cvRound((1 - share) * kHeight); }

/// Frame numbers below every bar that has room for its own.
void frame_axis(cv::Mat3b& chart, int bar, const std::vector<int>& numbers) {
  constexpr int kApart = 64;  // px
  const int every = std::max(1, (kApart + bar - 1) / bar), frames = static_cast<int>(numbers.size()), y = kTop + kHeight;
  for (int i = 0; i < frames; i += every) {
    const int x = kLeft + i * bar + bar / 2;
    cv::line(chart, {x, y}, {x, y + 4}, kInk);
    const std::string text = std::to_string(numbers[static_cast<std::size_t>(i)]);
    write(chart, text, {x - cv::getTextSize(text, kFont, kSize, 1, nullptr).width / 2, y + 18});
  }
  cv::line(chart, {kLeft, y}, {kLeft + frames * bar, y}, kInk);
  write(chart, "frame number", {kLeft + frames * bar / 2 - 44, y + 42});
}

void axes(cv::Mat3b& chart, int right) {
  write(chart, "share of the removed area", {8, kTop - 14});
  for (const int percent : {0, 25, 50, 75, 100}) {
    const int y = row_of(percent / 100.0);
    cv::line(chart, {kLeft, y}, {right, y}, kGrid);
    write(chart, std::to_string(percent) + " %", {8, y + 4});
  }
}

void legend(cv::Mat3b& chart) {
  int x = kLeft;
  for (const auto& [color, text] : {std::pair(kCopied, "seen by this drive"), std::pair(kElsewhere, "seen by source drives"),
                                    std::pair(kNever, "unobserved")}) {
    cv::rectangle(chart, cv::Rect(x, 12, 12, 12), color, cv::FILLED);
    write(chart, text, {x + 18, 22});
    x += 190;
  }
}

}  // namespace

cv::Mat3b forecast_chart(const Forecast& forecast, const std::vector<int>& numbers) {
  const int frames = static_cast<int>(forecast.frames.size());
  const int bar = std::clamp(kLeastWidth / std::max(frames, 1), 1, kWidestBar);
  cv::Mat3b chart(kTop + kHeight + kBottom, std::max(kLeastWidth, frames * bar) + kLeft + kRight);
  chart.setTo(kWhite);
  axes(chart, kLeft + frames * bar);
  frame_axis(chart, bar, numbers);
  legend(chart);
  for (int i = 0; i < frames; ++i) {
    const HoleShares& hole = forecast.frames[i].hole;
    double base = 0;
    for (const auto& [color, share] :
         {std::pair(kCopied, hole.copied), std::pair(kElsewhere, hole.copied_elsewhere), std::pair(kNever, hole.unobserved)}) {
      const int top = row_of(base + share), bottom = row_of(base);
      if (bottom > top) chart(cv::Rect(kLeft + i * bar, top, bar > 3 ? bar - 1 : bar, bottom - top)).setTo(color);
      base += share;
    }
  }
  return chart;
}

}  // namespace dvi::audit
