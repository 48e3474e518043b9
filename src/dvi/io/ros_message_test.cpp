#include "dvi/io/ros_message.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/io/ros_frames.h"

namespace dvi::io {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

// Lays fields out one after another as CDR or ROS 1 do.
class MessageBytes {
 public:
  explicit MessageBytes(BagEncoding encoding) : encoding_(encoding) {}

  template <class T>
  MessageBytes& add(T value) {
    while (encoding_ == BagEncoding::cdr && bytes_.size() % sizeof(T) != 0) bytes_.push_back('\0');
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
    return *this;
  }
  MessageBytes& add_text(const std::string& text) {
    const bool ended = encoding_ == BagEncoding::cdr;
    add(static_cast<std::uint32_t>(text.size() + (ended ? 1 : 0)));
    bytes_ += text + std::string(ended ? 1 : 0, '\0');
    return *this;
  }
  MessageBytes& add_data(const std::string& data) {
    add(static_cast<std::uint32_t>(data.size()));
    bytes_ += data;
    return *this;
  }
  MessageBytes& add_header(std::int32_t seconds, std::uint32_t nanoseconds, const std::string& frame) {
    if (encoding_ == BagEncoding::ros1) add<std::uint32_t>(7);
    return add(seconds).add(nanoseconds).add_text(frame);
  }
  std::string text() const { return encoding_ == BagEncoding::cdr ? std::string("\0\1\0\0", 4) + bytes_ : bytes_; }

 private:
  BagEncoding encoding_;
  std::string bytes_;
};

class RosMessage : public testing::TestWithParam<BagEncoding> {
 protected:
  MessageBytes bytes{GetParam()};
};

TEST_P(RosMessage, ImagesOfAllEncodingsAreBgr) {
  const auto image = [&](const std::string& encoding, std::uint32_t step, const std::string& data) {
    const std::string message = MessageBytes(GetParam())
                                    .add_header(5, 6, "/optical")
                                    .add<std::uint32_t>(1)
                                    .add<std::uint32_t>(1)
                                    .add_text(encoding)
                                    .add<std::uint8_t>(0)
                                    .add(step)
                                    .add_data(data)
                                    .text();
    EXPECT_EQ(parse_image(message, GetParam()).header.stamp_ns, 5'000'000'006);
    EXPECT_EQ(parse_image(message, GetParam()).header.frame, "optical");
    return cv::Vec3b(to_bgr(parse_image(message, GetParam()))(0, 0));
  };
  EXPECT_EQ(image("rgb8", 3, "\1\2\3"), cv::Vec3b(3, 2, 1));
  EXPECT_EQ(image("bgr8", 8, "\1\2\3     "), cv::Vec3b(1, 2, 3)) << "rows may be longer";
  EXPECT_EQ(image("rgba8", 4, "\1\2\3\4"), cv::Vec3b(3, 2, 1));
  EXPECT_EQ(image("mono8", 1, "\7"), cv::Vec3b(7, 7, 7));
  EXPECT_THAT([&] { image("32FC1", 4, "    "); }, ThrowsMessage<std::invalid_argument>(HasSubstr("32FC1")));
  EXPECT_THAT([&] { image("rgb8", 3, "\1\2"); }, ThrowsMessage<std::invalid_argument>(HasSubstr("2 bytes")));
}

// A point of x, y, z and a time of one type.
template <class T>
std::vector<double> times_of(BagEncoding encoding, const char* name, std::uint8_t type, std::vector<T> times) {
  MessageBytes bytes(encoding);
  std::string data;
  for (const T time : times) {
    for (const float v : {1.0F, 2.0F, 3.0F}) data.append(reinterpret_cast<const char*>(&v), sizeof(v));
    data.append(reinterpret_cast<const char*>(&time), sizeof(time));
  }
  const auto step = static_cast<std::uint32_t>(12 + sizeof(T)), count = static_cast<std::uint32_t>(times.size());
  bytes.add_header(100, 0, "lidar").add<std::uint32_t>(1).add(count).add<std::uint32_t>(4);
  for (std::uint32_t axis = 0; axis < 3; ++axis)
    bytes.add_text(std::string(1, "xyz"[axis])).add(4 * axis).add<std::uint8_t>(7).add<std::uint32_t>(1);
  bytes.add_text(name).add<std::uint32_t>(12).add(type).add<std::uint32_t>(1);
  bytes.add<std::uint8_t>(0).add(step).add(step * count).add_data(data).add<std::uint8_t>(1);
  return parse_cloud(bytes.text(), encoding).after_stamp;
}

TEST_P(RosMessage, PointsHaveTheirTimesAsDriversGiveThem) {
  const auto near = [](double value) { return testing::DoubleNear(value, 1e-6); };
  EXPECT_THAT((times_of<std::uint32_t>(GetParam(), "t", 6, {0, 50'000'000})), ElementsAre(near(0), near(0.05)));
  EXPECT_THAT((times_of<std::uint32_t>(GetParam(), "offset_time", 6, {1'000'000})), ElementsAre(near(0.001)));
  EXPECT_THAT((times_of<float>(GetParam(), "time", 7, {-0.05F, 0.04F})), ElementsAre(near(-0.05), near(0.04)));
  EXPECT_THAT((times_of<double>(GetParam(), "timestamp", 8, {100.02})), ElementsAre(near(100.02)))
      << "not since 1970, and then refused by its length";
  EXPECT_THAT((times_of<double>(GetParam(), "timestamp", 8, {1.7e9})), ElementsAre(near(1.7e9 - 100)));
}

TEST_P(RosMessage, WhatEndsTooEarlyIsRefused) {
  const std::string whole =
      bytes.add_header(1, 2, "camera").add<std::uint32_t>(480).add<std::uint32_t>(640).add_text("plumb_bob").text();
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_THROW(parse_camera_info(whole.substr(0, size), GetParam()), std::invalid_argument) << size;
}

INSTANTIATE_TEST_SUITE_P(Encodings, RosMessage, testing::Values(BagEncoding::cdr, BagEncoding::ros1),
                         [](const auto& e) { return e.param == BagEncoding::cdr ? "Cdr" : "Ros1"; });

TEST(RosFields, ReadsBigEndianCdrAndRefusesOthers) {
  EXPECT_EQ(RosFields(std::string_view("\0\0\0\0\0\0\1\2", 8), BagEncoding::cdr).number<std::uint32_t>(), 0x102U);
  EXPECT_THAT([] { RosFields(std::string_view("\0\7\0\0", 4), BagEncoding::cdr); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("00 07")));
}

RosMotion motion(const char* parent, const char* child, std::int64_t ns, double x) {
  return {{ns, parent}, child, SE3{Eigen::Matrix3d::Identity(), {x, 0, 0}}};
}

TEST(RosFrames, JoinsWhatStandsStillAndFollowsWhatMoves) {
  RosFrames frames;
  frames.add(motion("base", "lidar", 0, 1), true);
  frames.add(motion("base", "mast", 0, 2), false);  // repeated by a publisher that never changes it
  frames.add(motion("base", "mast", 9, 2), false);
  frames.add(motion("mast", "camera", 0, 4), true);
  for (std::int64_t ns : {0, 100}) frames.add(motion("odom", "base", ns, 10 + static_cast<double>(ns)), false);
  frames.add(motion("map", "odom", 0, 1000), true);
  EXPECT_EQ(frames.between("camera", "lidar")->t.x(), 1 - 6);
  EXPECT_FALSE(frames.between("odom", "lidar")) << "it moves";
  EXPECT_FALSE(frames.between("radar", "lidar")) << "nothing is known of it";
  const Trajectory path = frames.motion_of("lidar");
  ASSERT_EQ(path.poses().size(), 2U);
  EXPECT_EQ(path.poses()[1].world_from_body.t.x(), 1000 + 110 + 1);
}

TEST(RosFrames, ARingOfFramesEnds) {
  RosFrames frames;
  frames.add(motion("a", "b", 0, 1), true);
  frames.add(motion("b", "a", 0, 1), true);
  frames.between("a", "c");
  EXPECT_TRUE(frames.motion_of("a").poses().size() < 2);
}

}  // namespace
}  // namespace dvi::io
