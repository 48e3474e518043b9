#include "dvi/smooth/smooth.h"

#include <cmath>
#include <cstdint>
#include <optional>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "dvi/core/random.h"
#include "dvi/harmonize/filled_frame.h"
#include "dvi/testing/flat_scene.h"

namespace dvi::smooth {
namespace {

constexpr int kWidth = 200, kHeight = 150;
const cv::Rect kHole(60, 40, 80, 60);

harmonize::FilledFrame make_filled(const cv::Mat3f& color, cv::Rect hole = kHole) {
  harmonize::FilledFrame frame;
  frame.color = color.clone();
  frame.mask = cv::Mat1b(color.size(), uchar{0});
  frame.mask(hole) = 255;
  frame.kind = frame.mask / 255;
  frame.provenance = cv::Mat_<cv::Vec3w>(color.size(), cv::Vec3w(1, 2, 3));
  frame.confidence = cv::Mat1b(color.size(), uchar{200});
  frame.depth = cv::Mat1f(color.size(), 10.0F);
  return frame;
}

harmonize::FilledFrame smooth_between(const harmonize::FilledFrame* before, const harmonize::FilledFrame& frame,
                                      const harmonize::FilledFrame* after) {
  std::optional<FramePair> to_before, to_after;
  if (before != nullptr) to_before.emplace(*before, frame);
  if (after != nullptr) to_after.emplace(frame, *after);
  return smooth(to_before ? &*to_before : nullptr, frame, to_after ? &*to_after : nullptr);
}

cv::Mat3f make_texture(int shift = 0, double wavelength = 8) {
  const cv::Mat3b wide = waves(kWidth + 40, kHeight, 3, wavelength);
  cv::Mat3f out;
  wide(cv::Rect(20 + shift, 0, kWidth, kHeight)).convertTo(out, CV_32FC3);
  return out;
}

cv::Mat3f add_noise(const cv::Mat3f& image, double sigma, std::uint64_t seed) {
  Random random(seed);
  cv::Mat3f out = image.clone();
  for (cv::Vec3f& v : out)
    for (int c = 0; c < 3; ++c) v[c] += static_cast<float>(sigma * random.normal());
  return out;
}

double compute_rms(const cv::Mat3f& a, const cv::Mat3f& b, cv::Rect where) {
  return cv::norm(a(where), b(where)) / std::sqrt(3.0 * where.area());
}

TEST(Smooth, AveragesTheNoiseOfAStaticScene) {
  const cv::Mat3f truth = make_texture();
  const harmonize::FilledFrame before = make_filled(add_noise(truth, 3, 1)), frame = make_filled(add_noise(truth, 3, 2)),
                               after = make_filled(add_noise(truth, 3, 3));
  const double noise =
      compute_rms(smooth_between(&before, frame, &after).color, truth, kHole) / compute_rms(frame.color, truth, kHole);
  EXPECT_LT(noise, 0.68);
  EXPECT_GT(noise, 0.5);
  const double one_sided =
      compute_rms(smooth_between(nullptr, frame, &after).color, truth, kHole) / compute_rms(frame.color, truth, kHole);
  EXPECT_LT(one_sided, 0.8);
}

TEST(Smooth, IgnoresBlackNeighbors) {
  const cv::Mat3f white(kHeight, kWidth, cv::Vec3f::all(255)), black(kHeight, kWidth, cv::Vec3f());
  const harmonize::FilledFrame before = make_filled(black), frame = make_filled(white), after = make_filled(black);
  EXPECT_EQ(cv::norm(smooth_between(&before, frame, &after).color, white, cv::NORM_INF), 0);
}

TEST(Smooth, FollowsMotionWithoutBlur) {
  const harmonize::FilledFrame before = make_filled(make_texture(-5)), frame = make_filled(make_texture(0)),
                               after = make_filled(make_texture(5));
  const harmonize::FilledFrame out = smooth_between(&before, frame, &after);
  EXPECT_LT(compute_rms(out.color, frame.color, kHole), 1.5);
  const auto sharpness = [](const cv::Mat3f& image) {
    cv::Mat dx;
    cv::Sobel(image(kHole), dx, CV_32F, 1, 0);
    return cv::norm(dx, cv::NORM_L1);
  };
  EXPECT_GT(sharpness(out.color) / sharpness(frame.color), 0.98);
}

TEST(Smooth, IgnoresAnotherScene) {
  const harmonize::FilledFrame frame = make_filled(make_texture());
  cv::Mat3f other;
  waves(kWidth, kHeight, 99, 8).convertTo(other, CV_32FC3);
  const harmonize::FilledFrame before = make_filled(other);
  EXPECT_LT(compute_rms(smooth_between(&before, frame, nullptr).color, frame.color, kHole), 6);
}

TEST(Smooth, ReducesFlicker) {
  const cv::Mat3f truth = make_texture();
  harmonize::FilledFrame before = make_filled(truth), frame = make_filled(truth), after = make_filled(truth);
  frame.color(kHole) += cv::Scalar::all(8);
  EXPECT_LT(compute_rms(smooth_between(&before, frame, &after).color, truth, kHole), 4);
}

TEST(Smooth, ReplacesColorsThatNeitherNeighborShows) {
  const cv::Mat3f truth = make_texture();
  harmonize::FilledFrame before = make_filled(make_texture(-2)), frame = make_filled(truth),
                         after = make_filled(make_texture(2));
  const cv::Rect streak(90, 60, 12, 3);
  frame.color(streak) = cv::Vec3f(0, 0, 255);
  std::optional<FramePair> first, second;
  first.emplace(before, frame);
  second.emplace(frame, after);
  const SmoothOptions as_published{.replace_outliers = false};
  const double kept = compute_rms(smooth(&*first, frame, &*second, as_published).color, truth, streak);
  EXPECT_GT(kept, 80);
  EXPECT_LT(compute_rms(smooth(&*first, frame, &*second).color, truth, streak), kept / 3);
  EXPECT_LT(compute_rms(smooth(nullptr, frame, &*second).color, frame.color, streak), 1)
      << "with two frames, it is unknown which one is wrong";
}

TEST(Smooth, KeepsColorsThatOneNeighborShows) {
  const cv::Rect patch(90, 60, 12, 12);
  const harmonize::FilledFrame before = make_filled(make_texture());
  harmonize::FilledFrame frame = make_filled(make_texture()), after = make_filled(make_texture());
  frame.color(patch) = after.color(patch) = cv::Vec3f(0, 0, 255);
  EXPECT_LT(compute_rms(smooth_between(&before, frame, &after).color, frame.color, patch), 2);
}

TEST(Smooth, ChangesOnlyColorsOfTheHole) {
  const harmonize::FilledFrame before = make_filled(add_noise(make_texture(), 3, 1)),
                               after = make_filled(add_noise(make_texture(), 3, 3));
  harmonize::FilledFrame frame = make_filled(add_noise(make_texture(), 3, 2));
  frame.kind(70, 100) = static_cast<uchar>(harmonize::Kind::empty);
  const cv::Mat3f input = frame.color.clone();
  const harmonize::FilledFrame out = smooth_between(&before, frame, &after);
  EXPECT_EQ(cv::norm(frame.color, input, cv::NORM_INF), 0) << "the input does not change";
  EXPECT_EQ(cv::norm(out.color, input, cv::NORM_INF, frame.mask == 0), 0);
  EXPECT_GT(cv::norm(out.color, input, cv::NORM_INF), 0);
  EXPECT_EQ(out.color(70, 100), input(70, 100));
  EXPECT_EQ(cv::norm(out.kind, frame.kind, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(out.provenance, frame.provenance, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(out.confidence, frame.confidence, cv::NORM_INF), 0);
}

TEST(Smooth, ReturnsTheInputWithoutNeighborsOrHole) {
  const harmonize::FilledFrame before = make_filled(add_noise(make_texture(), 3, 1)), frame = make_filled(make_texture()),
                               whole = make_filled(make_texture(), {});
  EXPECT_EQ(cv::norm(smooth_between(nullptr, frame, nullptr).color, frame.color, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(smooth_between(&before, whole, nullptr).color, whole.color, cv::NORM_INF), 0);
}

TEST(Smooth, AcceptsAnyHoleAndAnySize) {
  const auto cut = [](int width, int height, cv::Rect hole) {
    return make_filled(make_texture()(cv::Rect(0, 0, width, height)), hole);
  };
  for (const cv::Size size : {cv::Size(200, 150), cv::Size(40, 33), cv::Size(33, 90), cv::Size(16, 16), cv::Size(3, 2)})
    for (const cv::Rect& hole : {cv::Rect({}, size), cv::Rect(0, 0, 1, 1), cv::Rect(size.width - 1, size.height - 2, 1, 2)}) {
      const harmonize::FilledFrame frame = cut(size.width, size.height, hole);
      const harmonize::FilledFrame out = smooth_between(&frame, frame, &frame);
      EXPECT_LT(cv::norm(out.color, frame.color, cv::NORM_INF), 30) << size;
    }
}

TEST(Smooth, SmoothsSeparateHoles) {
  const auto wide = [&](int shift) {
    cv::Mat3f out(kHeight, 500, cv::Vec3f::all(128));
    make_texture(shift).copyTo(out(cv::Rect(0, 0, kWidth, kHeight)));
    make_texture(shift).copyTo(out(cv::Rect(300, 0, kWidth, kHeight)));
    harmonize::FilledFrame frame = make_filled(add_noise(out, 3, 7 + shift));
    frame.mask(kHole + cv::Point(300, 0)) = 255;
    frame.kind = frame.mask / 255;
    return frame;
  };
  const harmonize::FilledFrame before = wide(-2), frame = wide(0), after = wide(2);
  const harmonize::FilledFrame out = smooth_between(&before, frame, &after);
  for (const int x : {0, 300}) {
    const cv::Rect part(x, 0, kWidth, kHeight);
    const double noise =
        compute_rms(out.color(part), make_texture(), kHole) / compute_rms(frame.color(part), make_texture(), kHole);
    EXPECT_LT(noise, 0.8) << x;
  }
}

TEST(Smooth, OnePairIsUsedForBothFrames) {
  harmonize::FilledFrame earlier = make_filled(add_noise(make_texture(-3), 3, 1)),
                         later = make_filled(add_noise(make_texture(), 3, 2), kHole + cv::Point(30, 10));
  later.gain = cv::Vec3f(2, 2, 2);  // half as bright, with the same colors after applying the gain
  later.color *= 0.5;
  const FramePair pair(earlier, later);
  const harmonize::FilledFrame first = smooth(nullptr, earlier, &pair), second = smooth(&pair, later, nullptr);
  EXPECT_LT(compute_rms(first.color, make_texture(-3), kHole) / compute_rms(earlier.color, make_texture(-3), kHole), 0.8);
  cv::Mat3f light = second.color.clone(), given = later.color.clone();
  light *= 2;
  given *= 2;
  EXPECT_LT(compute_rms(light, make_texture(), kHole + cv::Point(30, 10)) /
                compute_rms(given, make_texture(), kHole + cv::Point(30, 10)),
            0.8);
}

TEST(Smooth, DoesNotDependOnTheNumberOfThreads) {
  const harmonize::FilledFrame before = make_filled(add_noise(make_texture(-3), 3, 1)),
                               frame = make_filled(add_noise(make_texture(), 3, 2));
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  const harmonize::FilledFrame one = smooth_between(&before, frame, nullptr);
  cv::setNumThreads(4);
  const harmonize::FilledFrame four = smooth_between(&before, frame, nullptr);
  cv::setNumThreads(threads);
  EXPECT_EQ(cv::norm(one.color, four.color, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace dvi::smooth
