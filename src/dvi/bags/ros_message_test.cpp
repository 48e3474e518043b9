#include "dvi/bags/ros_message.h"

#include "dvi/bags/ros_frames.h"
#include "dvi/testing/test_ros_message.h"

namespace dvi::bags {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

class RosMessage : public testing::TestWithParam<BagEncoding> {
 protected:
  MessageBytes bytes{GetParam()};
};

TEST_P(RosMessage, RefusesTruncatedMessages) {
  const std::string whole =
      bytes.add_header(1, 2, "camera").add<std::uint32_t>(480).add<std::uint32_t>(640).add_text("plumb_bob").text();
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_THROW(parse_camera_info(whole.substr(0, size), GetParam()), std::invalid_argument) << size;
}

// A false length must not allocate memory.
TEST_P(RosMessage, RefusesLengthsOfGigabytes) {
  const auto text = [&](std::uint32_t length) {
    return MessageBytes(GetParam()).add_header(1, 2, "camera").add(std::uint32_t{1}).add(std::uint32_t{1}).add(length).text();
  };
  const std::string tf = MessageBytes(GetParam()).add(std::uint32_t{0xFFFFFFFF}).text();
  for (const std::uint32_t length : {0x7FFFFFFFU, 0x80000000U, 0xFFFFFFFFU}) {
    EXPECT_THAT([&] { parse_camera_info(text(length), GetParam()); },
                ThrowsMessage<std::invalid_argument>(HasSubstr("is truncated")));
    EXPECT_THAT([&] { parse_tf(tf, GetParam()); }, ThrowsMessage<std::invalid_argument>(HasSubstr("is truncated")));
  }
}

// tf2 ignores such transforms (TF_DENORMALIZED_QUATERNION).
TEST_P(RosMessage, KeepsAndMarksInvalidTransforms) {
  MessageBytes tf(GetParam());
  tf.add(std::uint32_t{2});
  for (const double w : {0.0, 1.0}) {
    tf.add_header(1, 2, "base").add_text("lidar");
    for (const double value : {1.0, 2.0, 3.0, 0.0, 0.0, 0.0, w}) tf.add(value);
  }
  const std::vector<RosMotion> motions = parse_tf(tf.text(), GetParam());
  ASSERT_EQ(motions.size(), 2U);
  EXPECT_FALSE(motions[0].valid);
  EXPECT_TRUE(motions[1].valid);
  EXPECT_EQ(motions[1].parent_from_child.t.z(), 3);
  MessageBytes pose(GetParam());
  pose.add_header(1, 2, "map");
  for (int i = 0; i < 7; ++i) pose.add(0.0);
  EXPECT_THAT([&] { parse_pose(pose.text(), GetParam()); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("not a quaternion")));
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

TEST(RosFrames, ConnectsStationaryFramesAndFollowsMovingOnes) {
  RosFrames frames;
  frames.add(motion("base", "lidar", 0, 1), true);
  frames.add(motion("base", "mast", 0, 2), false);  // a publisher repeats it without changes
  frames.add(motion("base", "mast", 9, 2), false);
  frames.add(motion("mast", "camera", 0, 4), true);
  for (std::int64_t ns : {0, 100}) frames.add(motion("odom", "base", ns, 10 + static_cast<double>(ns)), false);
  frames.add(motion("map", "odom", 0, 1000), true);
  EXPECT_EQ(frames.find_transform("camera", "lidar")->t.x(), 1 - 6);
  EXPECT_FALSE(frames.find_transform("odom", "lidar")) << "the frame moves";
  EXPECT_FALSE(frames.find_transform("radar", "lidar")) << "the frame is unknown";
  const Trajectory path = frames.find_motion("lidar");
  ASSERT_EQ(path.poses().size(), 2U);
  EXPECT_EQ(path.poses()[1].world_from_body.t.x(), 1000 + 110 + 1);
}

TEST(RosFrames, StopsAtCyclesOfFrames) {
  RosFrames frames;
  frames.add(motion("a", "b", 0, 1), true);
  frames.add(motion("b", "a", 0, 1), true);
  frames.find_transform("a", "c");
  EXPECT_TRUE(frames.find_motion("a").poses().size() < 2);
}

}  // namespace
}  // namespace dvi::bags
