#include "dvi/bags/bag_topics.h"

#include "dvi/testing/image_folder.h"
#include "dvi/testing/test_ros_message.h"

namespace dvi::bags {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

// A bag in memory: topics with one message each.
class TopicsOf : public testing::Test {
 protected:
  void add(const std::string& name, const std::string& type, const std::string& message = "") {
    bag_.topics.push_back({name, type, BagEncoding::cdr, {{0, 0, 0, messages_.size()}}});
    messages_.push_back(message);
  }
  void add_image(const std::string& name, const std::string& encoding) {
    add(name, "sensor_msgs/Image",
        MessageBytes(BagEncoding::cdr)
            .add_header(5, 6, "optical")
            .add<std::uint32_t>(1)
            .add<std::uint32_t>(1)
            .add_text(encoding)
            .add<std::uint8_t>(0)
            .add<std::uint32_t>(2)
            .add_data("  ")
            .text());
  }
  BagChoice choose(const std::vector<std::string>& named = {}) {
    bag_.read = [messages = messages_](const BagEntry& entry) { return messages[entry.offset]; };
    return choose_topics("drive", bag_, named);
  }
  std::string error() {
    return input_error([&] { choose(); });
  }

 private:
  Bag bag_;
  std::vector<std::string> messages_;
};

TEST_F(TopicsOf, RefusesVideoWithARemedy) {
  add("/camera/ffmpeg", "ffmpeg_image_transport_msgs/FFMPEGPacket");
  add("/points", "sensor_msgs/PointCloud2");
  EXPECT_THAT(error(), AllOf(HasSubstr("no topic of images; /camera/ffmpeg holds compressed video"), HasSubstr("republish"),
                             HasSubstr("it has /camera/ffmpeg")));
}

TEST_F(TopicsOf, RefusesPacketsWithARemedy) {
  add_image("/camera/image_raw", "rgb8");
  add("/velodyne_packets", "velodyne_msgs/VelodyneScan");
  EXPECT_THAT(error(), AllOf(HasSubstr("/velodyne_packets holds packets of a LiDAR"), HasSubstr("sensor_msgs/PointCloud2")));
}

TEST_F(TopicsOf, ReadsLivoxAsScans) {
  add_image("/camera/image_raw", "rgb8");
  std::size_t bytes = 10;
  for (const char* type : {"livox_ros_driver/CustomMsg", "livox_ros_driver2/CustomMsg", "livox_interfaces/CustomMsg"}) {
    add(std::string("/") + type, type, std::string(++bytes, ' '));
    EXPECT_EQ(choose().points->type, type);
  }
}

TEST_F(TopicsOf, ReadsGrayOf16BitsAsImagesIfThereAreNoOthers) {
  add_image("/left/image_raw", "mono16");
  add("/points", "sensor_msgs/PointCloud2", "x");
  EXPECT_EQ(choose().cameras.front().images->name, "/left/image_raw");
  add_image("/color/image_raw", "rgb8");
  ASSERT_EQ(choose().cameras.size(), 1U) << "mono16 can be depth";
  EXPECT_EQ(choose().cameras.front().images->name, "/color/image_raw");
  EXPECT_EQ(choose({"image=/left/image_raw"}).cameras.front().images->name, "/left/image_raw");
}

TEST_F(TopicsOf, DoesNotReadGrayOf16BitsAsImagesAndDepth) {
  add_image("/left/image_raw", "mono16");
  EXPECT_THAT(error(), HasSubstr("none of depth images"));
  add_image("/depth/image_raw", "mono16");
  EXPECT_EQ(choose().cameras.size(), 1U);
  EXPECT_EQ(choose().depth.images->name, "/depth/image_raw");
}

TEST_F(TopicsOf, ExplainsUnusedDepth) {
  add_image("/camera/image_rect_raw", "16UC1");
  add("/points", "sensor_msgs/PointCloud2", "x");
  EXPECT_THAT(error(), HasSubstr("/camera/image_rect_raw holds depth by its encoding"));
}

}  // namespace
}  // namespace dvi::bags
