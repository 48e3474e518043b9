#include "dvi/bags/ros_cloud.h"

#include <cmath>

#include "dvi/testing/test_ros_message.h"

namespace dvi::bags {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

class RosClouds : public testing::TestWithParam<BagEncoding> {};

// Makes points of x, y, z and a field of one type.
template <class T>
RosCloud cloud_of(BagEncoding encoding, const char* name, std::uint8_t type, std::vector<T> times) {
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
  return parse_cloud(bytes.text(), encoding);
}

template <class T>
std::vector<double> times_of(BagEncoding encoding, const char* name, std::uint8_t type, std::vector<T> times) {
  const RosCloud cloud = cloud_of(encoding, name, type, std::move(times));
  EXPECT_EQ(cloud.time_field, cloud.times.empty() ? "" : name);
  return cloud.times;
}

TEST_P(RosClouds, LimitTheNumbersOfBeams) {
  EXPECT_THAT((cloud_of<float>(GetParam(), "ring", 7, {NAN, -1, 3, 1e9F}).ring), ElementsAre(0, 0, 3, 65535));
}

TEST_P(RosClouds, ReadTheTimesOfPoints) {
  EXPECT_THAT((times_of<std::uint32_t>(GetParam(), "t", 6, {0, 50'000'000})), ElementsAre(0, 5e7));
  EXPECT_THAT((times_of<std::uint32_t>(GetParam(), "offset_time", 6, {1'000'000})), ElementsAre(1e6));
  EXPECT_THAT((times_of<float>(GetParam(), "time", 7, {-0.5F, 0.25F})), ElementsAre(-0.5, 0.25));
  EXPECT_THAT((times_of<double>(GetParam(), "timestamp", 8, {1.7e9})), ElementsAre(1.7e9));
  EXPECT_THAT((times_of<float>(GetParam(), "gps_time", 7, {1})), ElementsAre(1));
  EXPECT_THAT((times_of<double>(GetParam(), "range", 8, {1.7e9})), ElementsAre());
}

// The message follows CustomMsg and CustomPoint in Livox-SDK/livox_ros_driver2 (msg/). CDR aligns numbers to their size.
TEST_P(RosClouds, ReadLivoxPoints) {
  MessageBytes bytes(GetParam());
  bytes.add_header(100, 7, "livox_frame").add<std::uint64_t>(100'000'000'007).add<std::uint32_t>(3);
  bytes.add<std::uint8_t>(1).add<std::uint8_t>(0).add<std::uint8_t>(0).add<std::uint8_t>(0).add<std::uint32_t>(3);
  for (std::uint32_t i = 0; i < 3; ++i) {
    const float x = i == 1 ? 0 : 2 + static_cast<float>(i);  // a point at the origin is not a return
    bytes.add<std::uint32_t>(1000 * i).add(x).add<float>(0).add<float>(0);
    bytes.add<std::uint8_t>(40).add<std::uint8_t>(16).add(static_cast<std::uint8_t>(i));
  }
  const RosCloud cloud = parse_livox(bytes.text(), GetParam());
  EXPECT_EQ(cloud.header.frame, "livox_frame");
  EXPECT_THAT(cloud.points, ElementsAre(Eigen::Vector3f(2, 0, 0), Eigen::Vector3f(4, 0, 0)));
  EXPECT_THAT(cloud.times, ElementsAre(0, 2000));
  EXPECT_THAT(cloud.intensity, ElementsAre(40, 40));
  EXPECT_THAT(cloud.ring, ElementsAre(0, 2));
  for (std::size_t size = 0; size < bytes.text().size(); ++size)
    EXPECT_THROW(parse_livox(bytes.text().substr(0, size), GetParam()), std::invalid_argument) << size;
}

TEST_P(RosClouds, RefuseMoreStatedThanExistingPoints) {
  MessageBytes livox(GetParam());
  livox.add_header(100, 7, "livox_frame").add<std::uint64_t>(0).add<std::uint32_t>(0x80000000);
  for (int i = 0; i < 4; ++i) livox.add<std::uint8_t>(0);
  livox.add<std::uint32_t>(0x80000000);
  EXPECT_THAT([&] { parse_livox(livox.text(), GetParam()); }, ThrowsMessage<std::invalid_argument>(HasSubstr("is truncated")));
  MessageBytes cloud(GetParam());
  cloud.add_header(100, 7, "lidar").add<std::uint32_t>(0xFFFFFFFF).add<std::uint32_t>(0xFFFFFFFF).add<std::uint32_t>(3);
  for (std::uint32_t axis = 0; axis < 3; ++axis)
    cloud.add_text(std::string(1, "xyz"[axis])).add(4 * axis).add<std::uint8_t>(7).add<std::uint32_t>(1);
  cloud.add<std::uint8_t>(0).add<std::uint32_t>(12).add<std::uint32_t>(0xFFFFFFFF).add_data("").add<std::uint8_t>(1);
  EXPECT_THAT([&] { parse_cloud(cloud.text(), GetParam()); }, ThrowsMessage<std::invalid_argument>(HasSubstr("0 bytes")));
}

// Makes a cloud of points (i, 0, 1) with a number of one byte, in rows.
std::string make_cloud(BagEncoding encoding, std::uint32_t height, std::uint32_t width, const std::vector<float>& x) {
  MessageBytes bytes(encoding);
  std::string data;
  for (std::size_t i = 0; i < x.size(); ++i) {
    for (const float v : {x[i], 0.0F, 1.0F}) data.append(reinterpret_cast<const char*>(&v), sizeof(v));
    data += static_cast<char>('a' + i);
    if (i % width == width - 1) data += std::string(height > 1 ? 3 : 0, '.');  // rows may be longer than their points
  }
  bytes.add_header(100, 0, "lidar").add(height).add(width).add<std::uint32_t>(4);
  for (std::uint32_t axis = 0; axis < 3; ++axis)
    bytes.add_text(std::string(1, "xyz"[axis])).add(4 * axis).add<std::uint8_t>(7).add<std::uint32_t>(1);
  bytes.add_text("ring").add<std::uint32_t>(12).add<std::uint8_t>(2).add<std::uint32_t>(1);
  bytes.add<std::uint8_t>(0).add<std::uint32_t>(13).add<std::uint32_t>(13 * width + (height > 1 ? 3 : 0));
  bytes.add_data(data).add<std::uint8_t>(1);
  return bytes.text();
}

TEST_P(RosClouds, StateTheIndicesOfReturns) {
  const RosCloud cloud = parse_cloud(make_cloud(GetParam(), 1, 4, {NAN, 2, INFINITY, 4}), GetParam());
  EXPECT_EQ(cloud.message_points, 4U);
  EXPECT_THAT(cloud.index, ElementsAre(1, 3));
}

TEST_P(RosClouds, LosePointsOfOneRow) {
  const std::string message = make_cloud(GetParam(), 1, 4, {1, 2, 3, 4});
  const std::string removed = remove_cloud_points(message, GetParam(), {true, false, true, false});
  EXPECT_EQ(removed.size(), message.size() - 2 * 13);
  const RosCloudTable table = read_cloud_table(removed, GetParam());
  EXPECT_EQ(table.width, 2U);
  EXPECT_EQ(table.row_step, 26U);
  EXPECT_EQ(removed.back(), message.back()) << "is_dense";
  const RosCloud cloud = parse_cloud(removed, GetParam());
  EXPECT_THAT(cloud.points, ElementsAre(Eigen::Vector3f(2, 0, 1), Eigen::Vector3f(4, 0, 1)));
  EXPECT_THAT(cloud.ring, ElementsAre('b', 'd'));
  EXPECT_EQ(remove_cloud_points(message, GetParam(), std::vector<bool>(4, false)), message);
  EXPECT_EQ(read_cloud_table(remove_cloud_points(message, GetParam(), std::vector<bool>(4, true)), GetParam()).width, 0U);
}

TEST_P(RosClouds, KeepTheirRowsWithoutRemovedPoints) {
  const std::string message = make_cloud(GetParam(), 2, 2, {1, 2, 3, 4});
  const std::string removed = remove_cloud_points(message, GetParam(), {false, false, true, false});
  EXPECT_EQ(removed.size(), message.size());
  EXPECT_EQ(removed.back(), 0) << "is_dense";
  EXPECT_EQ(read_cloud_table(removed, GetParam()).height, 2U);
  const RosCloud cloud = parse_cloud(removed, GetParam());
  EXPECT_THAT(cloud.index, ElementsAre(0, 1, 3));
  EXPECT_THAT(cloud.ring, ElementsAre('a', 'b', 'd'));
}

TEST_P(RosClouds, RefuseToRemoveFromOtherPoints) {
  const std::string message = make_cloud(GetParam(), 1, 4, {1, 2, 3, 4});
  EXPECT_THAT([&] { remove_cloud_points(message, GetParam(), {true}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("it has 4 points instead of 1")));
}

TEST_P(RosClouds, LoseLivoxPoints) {
  const auto make = [&](const std::vector<std::uint32_t>& times) {
    MessageBytes bytes(GetParam());
    const auto count = static_cast<std::uint32_t>(times.size());
    bytes.add_header(100, 7, "livox_frame").add<std::uint64_t>(100'000'000'007).add(count);
    bytes.add<std::uint8_t>(1).add<std::uint8_t>(2).add<std::uint8_t>(3).add<std::uint8_t>(4).add(count);
    for (const std::uint32_t time : times) {
      bytes.add(time).add<float>(1).add<float>(2).add<float>(3);
      bytes.add<std::uint8_t>(40).add<std::uint8_t>(16).add<std::uint8_t>(5);
    }
    return bytes.text();
  };
  const std::string message = make({10, 20, 30, 40});
  EXPECT_EQ(remove_livox_points(message, GetParam(), {true, false, true, false}), make({20, 40}));
  EXPECT_EQ(remove_livox_points(message, GetParam(), {false, false, false, true}), make({10, 20, 30}));
  EXPECT_EQ(remove_livox_points(message, GetParam(), {true, true, true, true}), make({}));
  EXPECT_EQ(remove_livox_points(message, GetParam(), std::vector<bool>(4, false)), message);
  EXPECT_THROW(remove_livox_points(message, GetParam(), {true}), std::invalid_argument);
  EXPECT_THROW(remove_livox_points(message.substr(0, message.size() - 1), GetParam(), std::vector<bool>(4, true)),
               std::invalid_argument);
}

INSTANTIATE_TEST_SUITE_P(Encodings, RosClouds, testing::Values(BagEncoding::cdr, BagEncoding::ros1),
                         [](const auto& e) { return e.param == BagEncoding::cdr ? "Cdr" : "Ros1"; });

}  // namespace
}  // namespace dvi::bags
