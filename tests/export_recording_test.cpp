#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "dvi/bags/bag.h"
#include "dvi/bags/copy_bag.h"
#include "dvi/bags/ros_image.h"
#include "dvi/datasets/reader.h"
#include "dvi/media/image_file.h"
#include "dvi/media/write_image.h"
#include "program.h"

namespace dvi {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const fs::path kBags = DVI_TEST_BAGS;

/// Cleaned recordings, which `dvi export bag` and `folder` write as they were recorded.
class ExportRecording : public ProgramTest {
 protected:
  /// Copies a bag of tests/layouts, and removes a rectangle of its first camera's images.
  void clean_bag(const std::string& name, const std::string& options = "") const {
    fs::copy(kBags / name, folder / name);
    cv::Mat1b mask(32, 32, uchar{0});
    mask(cv::Rect(10, 12, 8, 6)) = 255;
    for (const char* frame : {"000000", "000001", "000002"}) {
      make_folder(folder / "masks");
      media::write_png(folder / "masks" / (std::string(frame) + ".png"), mask);
    }
    const Result run = dvi("run " + name + " -o out --masks masks --quiet " + options);
    ASSERT_EQ(run.code, 0) << run.err;
  }

  void expect_refused(const std::string& arguments, const std::string& message) const {
    const auto before = ::dvi::contents(folder / "out");
    const Result result = dvi("export " + arguments);
    EXPECT_EQ(result.code, 3) << arguments;
    EXPECT_THAT(result.err, HasSubstr(message)) << arguments;
    EXPECT_TRUE(before == ::dvi::contents(folder / "out")) << arguments;
  }

  /// Copies a bag and changes a pixel of its first camera's second image.
  void change_pixel(const std::string& from, const std::string& to) const {
    const bags::Bag bag = bags::open_bag(folder / from);
    for (const bags::BagTopic& topic : bag.topics)
      if (topic.name.starts_with("/front/image_raw")) {
        bags::ReplacedMessages replaced;
        replaced.numbers[topic.messages[1].chunk][topic.messages[1].offset] = 0;
        replaced.replace = [&](std::size_t, std::string_view message) {
          const bags::RosCompressedImage image = bags::parse_image_file(message, topic.encoding);
          media::ImageEdit edit{bags::to_bgr(image, 16), cv::Mat1b(32, 32, uchar{0})};
          edit.is_changed(3, 4) = 1;
          edit.colors(3, 4)[0] ^= 1U;
          return bags::edit_compressed_image(message, topic.encoding, edit, 95).value();
        };
        bags::copy_bag_file(folder / from, folder / to, replaced);
      }
  }

  cv::Mat3b frame(std::size_t i) const {
    return media::read_image(folder / "out/frames" / (std::to_string(1'000'000 + i).substr(1) + ".png"), {32, 32});
  }
};

class ExportBag : public ExportRecording, public testing::WithParamInterface<const char*> {};

TEST_P(ExportBag, ReplacesTheImagesOfTheCameraOnly) {
  const std::string name = GetParam(), ending = fs::path(name).extension();
  clean_bag(name);
  const Result result = dvi("export bag out -o clean" + ending + " --quiet --json");
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("\"clean" + ending + "\""), HasSubstr("\"cleaned images\": 3"),
                                HasSubstr("\"of them changed\": 3")));
  EXPECT_THAT(result.out, HasSubstr("the images of /right/image_raw are unchanged, with the traffic that they show"));
  const bags::Bag before = bags::open_bag(folder / name), after = bags::open_bag(folder / ("clean" + ending));
  ASSERT_EQ(before.topics.size(), after.topics.size());
  std::size_t images = 0;
  for (std::size_t t = 0; t < before.topics.size(); ++t) {
    const bags::BagTopic &topic = before.topics[t], &copy = after.topics[t];
    EXPECT_EQ(topic.name, copy.name);
    ASSERT_EQ(topic.messages.size(), copy.messages.size());
    for (std::size_t i = 0; i < topic.messages.size(); ++i) {
      EXPECT_EQ(topic.messages[i].time_ns, copy.messages[i].time_ns);
      const std::string old = before.read(topic.messages[i]), message = after.read(copy.messages[i]);
      if (!topic.name.starts_with("/front/image_raw")) {
        EXPECT_EQ(old, message) << topic.name;
        continue;
      }
      ++images;
      const bags::RosCompressedImage image = bags::parse_image_file(message, topic.encoding),
                                     recorded = bags::parse_image_file(old, topic.encoding);
      EXPECT_EQ(cv::norm(bags::to_bgr(image, 16), frame(i), cv::NORM_INF), 0);
      EXPECT_EQ(image.format, recorded.format);
      EXPECT_EQ(bags::read_header(message, topic.encoding).stamp_ns, bags::read_header(old, topic.encoding).stamp_ns);
      cv::Mat3b difference;
      cv::absdiff(bags::to_bgr(image, 16), bags::to_bgr(recorded, 16), difference);
      difference(cv::Rect(10, 12, 8, 6)).setTo(cv::Scalar());
      EXPECT_EQ(cv::norm(difference, cv::NORM_INF), 0) << "outside of the mask";
    }
  }
  EXPECT_EQ(images, 3U);
  const Drive drive = datasets::read_drive(folder / ("clean" + ending));
  ASSERT_EQ(drive.frames.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(cv::norm(*drive.images[i], frame(i), cv::NORM_INF), 0);
}

INSTANTIATE_TEST_SUITE_P(Kinds, ExportBag,
                         testing::Values("zstd.mcap", "lz4_without_index.mcap", "without_chunks.mcap", "lz4.bag", "bz2.bag",
                                         "sqlite.db3"));

TEST_F(ExportRecording, CleansOneCameraAfterTheOther) {
  clean_bag("zstd.mcap", "--camera right");
  ASSERT_EQ(dvi("export bag out -o right.mcap --quiet").code, 0);
  ASSERT_EQ(dvi("run zstd.mcap -o front --masks masks --camera front --quiet").code, 0);
  ASSERT_EQ(dvi("export bag front -o both.mcap --input right.mcap --quiet").code, 0);
  ASSERT_EQ(dvi("export bag front -o front.mcap --quiet").code, 0);
  const auto messages = [&](const char* file, const std::string& topic) {
    const bags::Bag bag = bags::open_bag(folder / file);
    std::vector<std::string> out;
    for (const bags::BagTopic& t : bag.topics)
      if (t.name.starts_with(topic))
        for (const bags::BagEntry& entry : t.messages) out.push_back(bag.read(entry));
    return out;
  };
  EXPECT_EQ(messages("both.mcap", "/front"), messages("front.mcap", "/front"));
  EXPECT_EQ(messages("both.mcap", "/right"), messages("right.mcap", "/right"));
  EXPECT_NE(messages("both.mcap", "/right"), messages("front.mcap", "/right"));
}

TEST_F(ExportRecording, CleansSeveralCamerasTogether) {
  clean_bag("zstd.mcap", "--camera all");
  ASSERT_EQ(dvi("export bag out -o all.mcap --quiet").code, 0);
  for (const char* camera : {"front", "right"}) {
    const Drive drive = datasets::read_drive(folder / "all.mcap", {.camera = camera});
    ASSERT_EQ(drive.frames.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
      const fs::path clean = folder / "out" / camera / "frames" / (drive.frames[i].name + ".png");
      EXPECT_EQ(cv::norm(*drive.images[i], media::read_image(clean, {32, 32}), cv::NORM_INF), 0) << clean;
    }
  }
}

TEST_F(ExportRecording, ReplacesTheImagesOfSeveralCameras) {
  small_drive("drive", "--stereo-m 0.5", 4);
  ASSERT_EQ(dvi("run drive -o out --camera all --frames 1:3 --quiet").code, 0);
  const Result result = dvi("export folder out -o clean --quiet --json");
  ASSERT_EQ(result.code, 0) << result.err;
  for (const char* camera : {"front", "right"})
    EXPECT_THAT(result.out, HasSubstr(std::string("1 of 4 images of ") + camera + " are not frames of the result"));
  for (const char* image : {"front/000001.png", "front/000003.png", "right/000001.png", "right/000003.png"}) {
    const std::string camera = fs::path(image).parent_path().string(), name = fs::path(image).filename().string();
    EXPECT_EQ(cv::norm(media::read_image(folder / "clean/images" / image, kSize),
                       media::read_image(folder / "out" / camera / "frames" / name, kSize), cv::NORM_INF),
              0)
        << image;
  }
  EXPECT_EQ(read_file(folder / "clean/images/right/000000.png"), read_file(folder / "drive/images/right/000000.png"));
}

TEST_F(ExportRecording, NamesBagsThatItCannotExport) {
  clean_bag("zstd.mcap", "--frames 0:1");
  const Result part = dvi("export bag out -o part.mcap --quiet --json");
  EXPECT_EQ(part.code, 0);
  EXPECT_THAT(part.out, HasSubstr("1 of 3 images of /front/image_raw/compressed are not frames of the result"));
  expect_refused("bag out -o part.mcap", "exists");
  expect_refused("bag out -o clean.bag", "does not end in .mcap as the recording does");
  expect_refused("folder out -o clean", "dvi export bag");
  fs::copy(kBags / "lz4.bag", folder / "lz4.bag");
  ASSERT_EQ(dvi("export bag out -o same.bag --input lz4.bag --quiet").code, 0) << "the same images";
  fs::copy(kBags / "rgbd.bag", folder / "other.bag");
  expect_refused("bag out -o clean.bag --input other.bag", "has no camera front, which the run cleaned");
  ASSERT_EQ(dvi("export bag out -o twice.mcap --input part.mcap --quiet").code, 0) << "the same images, already cleaned";
  EXPECT_EQ(read_file(folder / "twice.mcap"), read_file(folder / "part.mcap"));
  change_pixel("zstd.mcap", "changed.mcap");
  expect_refused("bag out -o clean.mcap --input changed.mcap", "it is not the image that the run cleaned");
  const std::string bytes = read_file(folder / "zstd.mcap");
  write_file(folder / "zstd.mcap", bytes.substr(0, bytes.size() / 2));
  expect_refused("bag out -o clean.mcap", "truncated");
  fs::remove(folder / "zstd.mcap");
  expect_refused("bag out -o clean.mcap", "does not exist");
  EXPECT_FALSE(fs::exists(folder / "clean.mcap"));
}

TEST_F(ExportRecording, KeepsTheFilesOfASplitBag) {
  fs::create_directories(folder / "split");
  fs::copy(kBags / "sqlite.db3", folder / "split/split_0.db3");
  write_file(folder / "split/metadata.yaml",
             "rosbag2_bagfile_information:\n  version: 4\n  relative_file_paths:\n    - split_0.db3\n");
  ASSERT_EQ(dvi("run split -o out --quiet").code, 0);
  expect_refused("bag out -o split/clean", "is in the folder of the recording");
  expect_refused("bag out -o clean.db3", "the recording");
  ASSERT_EQ(dvi("export bag out -o clean --quiet").code, 0);
  EXPECT_EQ(read_file(folder / "clean/metadata.yaml"), read_file(folder / "split/metadata.yaml"));
  EXPECT_EQ(datasets::read_drive(folder / "clean").frames.size(), 3U);
}

TEST_F(ExportRecording, WritesTheLayoutOfTheRecording) {
  const fs::path drive = small_drive();
  ASSERT_EQ(dvi("run drive -o out --frames 1:4 --quiet").code, 0);
  fs::create_symlink(drive, drive / "loop");
  make_folder(drive / "result/.dvi");
  write_file(drive / "result/report.json", "{}");
  auto before = ::dvi::contents(drive);
  EXPECT_EQ(before.erase("result/report.json"), 1U);
  const Result result = dvi("export folder out -o clean --quiet --json");
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("2 of 6 images of front are not frames of the result"),
                                HasSubstr("1 links and files outside of")));
  const auto after = ::dvi::contents(folder / "clean");
  ASSERT_EQ(before.size(), after.size());
  for (const auto& [file, bytes] : before) {
    ASSERT_TRUE(after.contains(file)) << file;
    const std::string frame = fs::path(file).stem().string();
    const bool is_cleaned = file.starts_with("images/") && fs::exists(folder / "out/frames" / (frame + ".png"));
    if (!is_cleaned)
      EXPECT_EQ(after.at(file), bytes) << file;
    else
      EXPECT_EQ(cv::norm(media::read_image(folder / "clean" / file, kSize),
                         media::read_image(folder / "out/frames" / (frame + ".png"), kSize), cv::NORM_INF),
                0);
  }
  expect_refused("folder out -o drive/clean", "is in the folder of the recording");
  EXPECT_FALSE(fs::exists(drive / "clean"));
  expect_refused("bag out -o clean.bag", "dvi export folder");
  cv::Mat3b changed = media::read_image(drive / "images/front/000003.png", kSize);
  changed(0, 0) += cv::Vec3b(1, 1, 1);
  media::write_png(drive / "images/front/000003.png", changed);
  expect_refused("folder out -o again", "is not the image that the run cleaned");
  fs::remove(drive / "images/front/000002.png");
  expect_refused("folder out -o again", "which the run cleaned");
  EXPECT_FALSE(fs::exists(folder / "again"));
}

TEST_F(ExportRecording, RemovesPointsFromTheScansOfABag) {
  constexpr std::size_t kPoints = 161;  // points of each scan; the last one is not a return
  std::vector<std::uint32_t> labels(kPoints, 0);
  std::fill(labels.begin() + 10, labels.begin() + 30, 252);
  make_folder(folder / "points");
  for (const char* scan : {"000000", "000001", "000002"})
    write_file(folder / "points" / (std::string(scan) + ".label"),
               {reinterpret_cast<const char*>(labels.data()), labels.size() * sizeof(std::uint32_t)});
  clean_bag("lz4.bag", "--masks points");
  const Result result = dvi("export bag out --points -o clean.bag --quiet --json");
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("\"cleaned scans\": 3"), HasSubstr("\"removed points\": 60"),
                                HasSubstr("\"cleaned images\": 3")));
  const Drive before = datasets::read_drive(folder / "lz4.bag"), after = datasets::read_drive(folder / "clean.bag");
  for (std::size_t i = 0; i < 3; ++i) {
    auto expected = before.scans[i]->points;
    expected.erase(expected.begin() + 10, expected.begin() + 30);
    EXPECT_EQ(after.scans[i]->points, expected);
    EXPECT_EQ(cv::norm(*after.images[i], frame(i), cv::NORM_INF), 0);
  }
}

TEST_F(ExportRecording, RemovesPointsFromScansAndTheirLabels) {
  const fs::path drive = small_drive();
  ASSERT_EQ(dvi("run drive -o out --poses given --masks found --quiet").code, 0);
  ASSERT_EQ(dvi("export labels out -o labels --quiet").code, 0);
  const Result result = dvi("export folder out --points -o clean --quiet --json");
  ASSERT_EQ(result.code, 0) << result.err;
  std::size_t removed = 0, cleaned = 0;
  for (const char* kind : {"lidar", "truth_points"})
    for (const auto& [file, bytes] : ::dvi::contents(drive / kind)) {
      const fs::path labels = folder / "labels" / (fs::path(file).stem().string() + ".label");
      std::string expected = bytes;
      if (fs::exists(labels)) {
        const std::string values = read_file(labels);
        const std::size_t points = values.size() / sizeof(std::uint32_t), step = bytes.size() / points;
        expected.clear();
        for (std::size_t i = 0; i < points; ++i)
          if (values.substr(4 * i, 4) == std::string(4, '\0')) expected += bytes.substr(i * step, step);
        if (fs::path(file).extension() == ".bin") ++cleaned, removed += (bytes.size() - expected.size()) / step;
      }
      EXPECT_TRUE(read_file(folder / "clean" / kind / file) == expected) << kind << file;
    }
  EXPECT_GT(removed, 0U);
  EXPECT_THAT(result.out, AllOf(HasSubstr("\"removed points\": " + std::to_string(removed)),
                                HasSubstr("\"cleaned scans\": " + std::to_string(cleaned))));
}

TEST_F(ExportRecording, RemovesNoPointsFromDepthImages) {
  fs::copy(kBags / "rgbd.bag", folder / "rgbd.bag");
  ASSERT_EQ(dvi("run rgbd.bag -o out --quiet").code, 0);
  expect_refused("bag out --points -o clean.bag", "has depth images instead of scans, from which no points can be removed");
  EXPECT_FALSE(fs::exists(folder / "clean.bag"));
}

class ExportLayout : public ExportRecording, public testing::WithParamInterface<std::pair<const char*, const char*>> {};

TEST_P(ExportLayout, IsReadLikeTheRecording) {
  small_drive();
  const auto [layout, drive] = GetParam();
  ASSERT_EQ(shell(std::string("python3 " DVI_LAYOUTS " ") + layout + " drive recorded").code, 0);
  const Result run = dvi(std::string("run recorded/") + drive + " -o out --poses given --quiet");
  ASSERT_EQ(run.code, 0) << run.err;
  ASSERT_EQ(dvi("export folder out -o clean --quiet").code, 0);
  const auto recorded = ::dvi::contents(folder / "recorded");
  for (const auto& [file, bytes] : ::dvi::contents(folder / "clean"))
    if (recorded.contains(file) && !file.ends_with("g"))  // no image
      EXPECT_EQ(bytes, recorded.at(file)) << file;
    else
      EXPECT_TRUE(recorded.contains(file)) << file;
  const Drive before = datasets::read_drive(folder / "recorded" / drive),
              after = datasets::read_drive(folder / "clean" / drive);
  EXPECT_EQ(before.frames.size(), after.frames.size());
  EXPECT_EQ(before.scan_headers.size(), after.scan_headers.size());
  EXPECT_EQ(before.poses.poses().size(), after.poses.poses().size());
  EXPECT_EQ(before.has_labels(), after.has_labels());
}

INSTANTIATE_TEST_SUITE_P(Layouts, ExportLayout,
                         testing::Values(std::pair{"kitti-odometry", "sequences/00"},
                                         std::pair{"kitti-360", "data_2d_raw/2013_05_28_drive_0000_sync"},
                                         std::pair{"nuscenes", "scene-0061"}));

}  // namespace
}  // namespace dvi
