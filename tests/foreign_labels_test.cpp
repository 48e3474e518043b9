#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "dvi/core/error.h"
#include "dvi/inputs/collect_evidence.h"
#include "dvi/media/write_image.h"
#include "dvi/testing/find_recording.h"
#include "program.h"

namespace dvi {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// Reads label files that other programs wrote (datumaro's test data), each with a drive whose images have the names and the
/// size in the file. The expected numbers of pixels are derived from the numbers in the files.
class ForeignLabels : public ProgramTest {
 protected:
  void SetUp() override {
    labels = find_recording("foreign_files/labels");
    DVI_SKIP_WITHOUT(labels);
  }

  /// A drive of the plain layout with a scan of some points per image.
  void drive_of(const std::vector<std::string>& names, cv::Size size) const {
    fs::remove_all(folder / "drive");
    std::string poses;
    for (std::size_t i = 0; i < names.size(); ++i) {
      make_folder(folder / "drive/images/front");
      make_folder(folder / "drive/lidar");
      media::write_png(folder / "drive/images/front" / (names[i] + ".png"), cv::Mat3b(size, cv::Vec3b(90, 90, 90)));
      std::string scan;
      for (int k = 0; k < 400; ++k) {
        const float point[4] = {4 + 0.1F * static_cast<float>(k % 20), 0.2F * static_cast<float>(k / 20) - 2, -1, 0.5F};
        scan.append(reinterpret_cast<const char*>(point), sizeof(point));
      }
      write_file(folder / "drive/lidar" / (names[i] + ".bin"), scan);
      poses += fmt::format("{} 1 0 0 {} 0 1 0 0 0 0 1 0\n", names[i], 0.1 * static_cast<double>(i));
    }
    write_file(folder / "drive/poses.txt", poses);
    write_file(
        folder / "drive/dvi.toml",
        fmt::format("[drive]\nversion = 1\n[camera.front]\nsize = [{0}, {1}]\nK = [{0}, 0, {2}, 0, {0}, {3}, 0, 0, 1]\n"
                    "camera_from_lidar = [0, -1, 0, 0, 0, 0, -1, 0, 1, 0, 0, 0]\n[lidar]\nrate = 10\nrotation = \"none\"\n",
                    size.width, size.height, 0.5 * (size.width - 1), 0.5 * (size.height - 1)));
  }

  struct Masked {
    int code = 0;             ///< as the program would end
    std::vector<int> pixels;  ///< masked in each image, in order of names
    std::string err;          ///< warnings, or the error
  };

  /// What `dvi mask drive --masks FILE` does, exactly as the file says, in this process.
  Masked mask(const std::string& file, const std::string& classes = "",
              labels::Polarity polarity = labels::Polarity::automatic) const {
    job::Job job;
    job.target = (folder / "drive").string();
    job.read.masks = {job::MasksFrom::parse((labels / file).string())};
    job.read.mask_files = {.polarity = polarity, .classes = classes};
    job.options.masks.shadows = false;
    job.options.masks.dilate_px = 0;
    Progress progress(ProgressStyle::quiet);
    Masked out;
    try {
      const inputs::Recordings drives{inputs::open_recording(job.target, job.read, inputs::MaskNeed::required, progress)};
      const inputs::Poses poses = inputs::use_given_poses(drives);
      const objects::Masks masks = inputs::find_masks(drives, poses, job, progress);
      for (std::size_t i = 0; i < masks.front().images.size(); ++i)
        out.pixels.push_back(cv::countNonZero(*masks.front().images[i]));
    } catch (const InputError& e) {
      out.code = 3;
      out.err = e.what();
    }
    for (const std::string& warning : progress.warnings()) out.err += "\n" + warning;
    return out;
  }

  void expect_masked(const std::string& file, const std::vector<int>& pixels, const std::string& classes = "",
                     labels::Polarity polarity = labels::Polarity::automatic) const {
    const Masked result = mask(file, classes, polarity);
    EXPECT_EQ(result.code, 0) << file << result.err;
    EXPECT_EQ(result.pixels, pixels) << file << result.err;
  }
  void expect_refused(const std::string& file, const char* reason, const char* remedy) const {
    const Masked result = mask(file);
    EXPECT_EQ(result.code, 3) << file;
    EXPECT_THAT(result.err, AllOf(HasSubstr(reason), HasSubstr(remedy))) << file;
  }

  fs::path labels;
};

TEST_F(ForeignLabels, CocoInstances) {
  const std::string coco = "coco_dataset/";
  drive_of({"a"}, {10, 5});
  // One bbox of 3 x 1; of stuff, 10 + 10 pixels in run lengths.
  for (const char* file : {"coco_instances/annotations/instances_train.json", "coco/annotations/instances_train.json",
                           "mmdet_coco/annotations/instances_train.json", "coco_roboflow/train/_annotations.coco.json",
                           "coco_person_keypoints/annotations/person_keypoints_train.json"})
    expect_masked(coco + file, {3});
  expect_masked(coco + "coco_stuff/annotations/stuff_train.json", {20});
  drive_of({"b"}, {5, 10});
  // A polygon of 1 x 2 pixels within two columns of 10 in run lengths.
  for (const char* file :
       {"coco_instances/annotations/instances_val.json", "mmdet_coco/annotations/instances_val.json",
        "coco_roboflow/val/_annotations.coco.json", "coco_person_keypoints/annotations/person_keypoints_val.json",
        "coco_stuff/annotations/stuff_val.json"})
    expect_masked(coco + file, {20});
  expect_masked(coco + "coco_instances/annotations/instances_val.json", {2}, "a");
}

TEST_F(ForeignLabels, CocoWithoutInstances) {
  const std::string coco = "coco_dataset/";
  drive_of({"a"}, {10, 5});
  expect_refused(coco + "coco_labels/annotations/labels_train.json", "neither a segmentation nor a bbox", "docs/masks.md");
  expect_refused(coco + "coco_captions/annotations/captions_train.json", "holds COCO captions", "instances");
  expect_refused(coco + "coco_instances/annotations/instances_val.json", "no image of the drive: its first image is b.jpg",
                 "same name");
  const Masked none = mask(coco + "coco_image_info/annotations/image_info_train.json");
  EXPECT_EQ(none.code, 0);
  EXPECT_THAT(none.err, HasSubstr("its labels (0 in 1 frames) remove nothing"));
}

TEST_F(ForeignLabels, Cvat) {
  const std::string cvat = "cvat_dataset/";
  drive_of({"img0"}, {8, 8});
  expect_masked(cvat + "for_images/export_task/train.xml", {8});  // a box of 4 x 2
  EXPECT_THAT(mask(cvat + "for_images/export_task/train.xml").err, HasSubstr("1 <polyline> ignored"));
  expect_refused(cvat + "for_images/export_project/annotations.xml", "has two images called img0",
                 "keep the images of one camera");
  // Frames 10, 13, 16, 19 of a video: a box of 7 x 1 in the first of them only, beside points and a polyline.
  drive_of({"frame_000010", "frame_000013", "frame_000016", "frame_000019"}, {25, 20});
  expect_masked(cvat + "for_video/annotations.xml", {7, 0, 0, 0});
  drive_of({"000000", "000001"}, {25, 20});
  expect_refused(cvat + "for_video/annotations.xml", "its shapes are in frames 10 to 10, but the drive's images are 0 to 1",
                 "n-th");
}

TEST_F(ForeignLabels, CocoPanoptic) {
  const std::string panoptic = "coco_dataset/coco_panoptic/annotations/";
  drive_of({"a"}, {5, 5});
  expect_masked(panoptic + "panoptic_train.json", {25});  // converters mark all categories as stuff
  drive_of({"b"}, {5, 10});
  expect_masked(panoptic + "panoptic_val.json", {40});
  expect_masked(panoptic + "panoptic_val.json", {20}, "2");
}

TEST_F(ForeignLabels, Yolo) {
  drive_of({"1"}, {15, 10});
  // Boxes of 4 x 2 from (0, 2) and of 2 x 3 from (3, 3), which share one pixel.
  for (const char* yolo : {"yolo_dataset/strict/obj_train_data", "yolo_dataset/annotations/Annotations",
                           "yolo_dataset/labels/labels/train", "yolo_dataset/labels/labels/val"}) {
    expect_masked(yolo, {13});
    expect_masked(yolo, {8}, "2");
  }
}

TEST_F(ForeignLabels, FormatsThatAreNotRead) {
  drive_of({"1"}, {15, 10});
  expect_refused("yolo_dataset/strict/obj_train_data/1.txt", "holds YOLO labels of one image", "give the folder");
  for (const char* kitti :
       {"kitti_dataset/kitti_3d/training/label_2", "kitti_dataset/kitti_detection/training/label_2/000030_10.txt"})
    expect_refused(kitti, "holds KITTI object labels", "tracking labels");
  expect_refused("kitti_dataset/kitti_raw/tracklet_labels.xml", "an <item> has the size -1.03 x 7.95 x -3.62 m", "");
  expect_refused("mots_dataset/train/instances/labels.txt", "holds no labels in a supported format", "COCO JSON");
}

TEST_F(ForeignLabels, MotsPictures) {
  drive_of({"1", "2"}, {5, 1});
  expect_refused("mots_dataset/train/instances", "looks like an image of class ids", "--classes");
  expect_masked("mots_dataset/train/instances", {4, 1}, "", labels::Polarity::white);
  expect_masked("mots_dataset/train/instances", {1, 0}, "3");  // the value is class * 1000 + instance
  drive_of({"3"}, {5, 1});
  expect_masked("mots_dataset/val/instances", {1});
}

TEST_F(ForeignLabels, KittiPictures) {
  // 3, 3, 27 (1), 27 (2), 27 (2) and 31 (1), 31 (1), 12 (1), 3, 3: ids, with the instance in brackets, as id * 256 + instance.
  const std::string kitti = "kitti_dataset/kitti_segmentation/training/instance";
  drive_of({"000030_10", "000030_11"}, {5, 1});
  expect_masked(kitti, {3, 0}, "truck");
  expect_masked(kitti, {3, 2}, "truck,train");
  EXPECT_THAT(mask(kitti, "truck").err, HasSubstr("class * 256"));
  expect_refused(kitti, "looks like an image of class ids", "--classes");
}

TEST_F(ForeignLabels, CityscapesPictures) {
  const std::string of_city = "cityscapes_dataset/dataset/gtFine/", city = "/defaultcity",
                    all = "cityscapes_dataset/train_dataset/";
  drive_of({"defaultcity_000001_000031_leftImg8bit", "defaultcity_000001_000032_leftImg8bit"}, {5, 1});
  expect_masked(of_city + "test" + city, {3, 0}, "truck");
  expect_masked(of_city + "test" + city, {3, 2}, "truck,train");
  expect_refused(all + "gtFine/test" + city, "both match image defaultcity_000001_000031_leftImg8bit", "keep one");
  drive_of({"defaultcity_000002_000045"}, {5, 1});
  expect_masked(of_city + "train" + city, {1}, "person");
}

}  // namespace
}  // namespace dvi
