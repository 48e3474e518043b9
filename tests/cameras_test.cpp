#include <set>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "dvi/core/files.h"
#include "program.h"

namespace dvi {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Key;
using testing::StartsWith;

/// Cleans several cameras of a drive in one run.
class Cameras : public ProgramTest {
 protected:
  fs::path stereo_drive() const { return small_drive("drive", "--stereo-m 0.5", 4); }
  nlohmann::json read(const fs::path& file) const { return nlohmann::json::parse(read_file(folder / file)); }
  /// Returns the files of a result, without the files that only plans have.
  std::map<std::string, std::string> result(const std::string& out) const {
    std::map<std::string, std::string> files = contents(folder / out);
    std::erase_if(files,
                  [](const auto& file) { return file.first == ".dvi/plan.json" || file.first.starts_with(".dvi/costs"); });
    return files;
  }
  void expect_refused(const std::string& arguments, int code, const std::string& reason) const {
    const Result refused = dvi(arguments);
    EXPECT_EQ(refused.code, code) << arguments;
    EXPECT_THAT(refused.err, HasSubstr(reason));
    EXPECT_FALSE(fs::exists(folder / "refused"));
  }
};

TEST_F(Cameras, HaveFoldersOfTheirOwnAndShareTheOtherFiles) {
  stereo_drive();
  const Result run = dvi("run drive --camera all -o out");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("out/CAMERA/frames"));
  for (const char* camera : {"front", "right"}) {
    const fs::path of_camera = folder / "out" / camera;
    for (const char* pictures :
         {"frames", "masks", "kind", "provenance", "sources_used", "harmonization", "confidence", "depth"})
      EXPECT_EQ(list_files(of_camera / pictures, {".png"}).size(), 4U) << camera << " " << pictures;
    for (const char* file : {"video.mp4", "compare.mp4", "contact.png"}) EXPECT_TRUE(fs::exists(of_camera / file)) << file;
    EXPECT_EQ(read_lines(folder / "out/map" / camera / "poses.txt").size(), 4U);
  }
  EXPECT_NE(read_file(folder / "out/map/front/poses.txt"), read_file(folder / "out/map/right/poses.txt"));
  EXPECT_EQ(read_file(folder / "out/map/front/poses.txt"), read_file(folder / "out/map/poses.txt"));
  EXPECT_FALSE(fs::exists(folder / "out/frames"));
  const nlohmann::json report = read("out/report.json");
  EXPECT_EQ(report["cameras"], (nlohmann::json{"front", "right"}));
  ASSERT_EQ(report["frames"].size(), 8U);
  EXPECT_EQ(report["frames"][5]["camera"], "right");
  EXPECT_EQ(report["frames"][5]["name"], "000001");
  const nlohmann::json sources = read("out/sources.json")["sources"];
  ASSERT_EQ(sources.size(), 8U);
  EXPECT_EQ(sources[4]["camera"], "right");
  std::set<std::string> cameras;
  const nlohmann::json objects = read("out/objects.json")["objects"];
  for (const nlohmann::json& object : objects) cameras.insert(object.at("camera"));
  EXPECT_THAT(cameras, ElementsAre("front", "right"));
  EXPECT_THAT(dvi("run drive --camera all -o out").err, HasSubstr("nothing to do"));
  const Result inspected = dvi("inspect out right/000001 120 80 --json");
  EXPECT_EQ(inspected.code, 0) << inspected.err;
  EXPECT_EQ(nlohmann::json::parse(inspected.out)["frame"], "right/000001");
}

TEST_F(Cameras, AreAuditedAndScoredTogether) {
  stereo_drive();
  ASSERT_EQ(dvi("run drive --camera right,front -o out --quiet").code, 0);
  expect_refused("import-fill out out/front/frames", 3, "is not a folder");
  EXPECT_EQ(read("out/report.json")["cameras"], (nlohmann::json{"right", "front"})) << "in the given order";
  const Result audit = dvi("audit out drive --json --quiet");
  EXPECT_EQ(audit.code, 0) << audit.out << audit.err;
  EXPECT_EQ(nlohmann::json::parse(audit.out)["frames"], 8);
  make_folder(folder / "truth/front");
  for (const fs::path& file : list_files(folder / "drive/truth", {".png"}))
    fs::copy_file(file, folder / "truth/front" / file.filename());
  fs::copy(folder / "drive/truth/right", folder / "truth/right");
  const Result scored = dvi("eval out --truth truth --json --quiet");
  ASSERT_EQ(scored.code, 0) << scored.err;
  const nlohmann::json evaluation = nlohmann::json::parse(scored.out);
  EXPECT_GT(evaluation["copied"]["psnr"], 24);
  std::map<std::string, int> names;
  for (const nlohmann::json& frame : evaluation["per_frame"]) ++names[frame.at("name")];
  EXPECT_THAT(names, Contains(Key("front/000001")));
  EXPECT_THAT(names, Contains(Key("right/000001")));
}

TEST_F(Cameras, AreExportedTogether) {
  stereo_drive();
  ASSERT_EQ(dvi("run drive --camera all -o out --quiet").code, 0);
  for (const char* format : {"colmap", "nerfstudio", "mcap", "video"})
    ASSERT_EQ(dvi(std::string("export ") + format + " out -o " + format + " --quiet").code, 0) << format;
  for (const char* camera : {"front", "right"})
    EXPECT_TRUE(read_file(folder / "video" / camera / "video.mp4") == read_file(folder / "out" / camera / "video.mp4"))
        << camera;

  const std::vector<std::string> cameras = read_lines(folder / "colmap/sparse/0/cameras.txt");
  ASSERT_EQ(cameras.size(), 3U) << "a comment and two cameras";
  EXPECT_THAT(cameras[1], StartsWith("1 PINHOLE 240 136 "));
  EXPECT_THAT(cameras[2], StartsWith("2 PINHOLE 240 136 "));
  std::vector<std::string> images;
  for (const std::string& line : read_lines(folder / "colmap/sparse/0/images.txt"))
    if (line.ends_with(".png")) images.push_back(line);
  ASSERT_EQ(images.size(), 8U);
  EXPECT_THAT(images[3], EndsWith(" 1 front/000003.png"));
  EXPECT_THAT(images[4], EndsWith(" 2 right/000000.png"));
  EXPECT_TRUE(fs::exists(folder / "colmap/images/right/000003.png"));
  EXPECT_TRUE(fs::exists(folder / "colmap/masks/right/000003.png.png"));

  const std::vector<std::string> rigs = read_lines(folder / "colmap/sparse/0/rigs.txt");
  ASSERT_EQ(rigs.size(), 2U) << "one rig";
  EXPECT_THAT(rigs[1], StartsWith("1 2 CAMERA 1 CAMERA 2 1 "));
  const std::vector<std::string> moments = read_lines(folder / "colmap/sparse/0/frames.txt");
  ASSERT_EQ(moments.size(), 5U) << "both images of a moment are one frame";
  EXPECT_THAT(moments[4], AllOf(StartsWith("4 1 "), EndsWith(" 2 CAMERA 1 4 CAMERA 2 8")));

  const nlohmann::json transforms = read("nerfstudio/transforms.json");
  EXPECT_FALSE(transforms.contains("fl_x")) << "each frame has its camera";
  ASSERT_EQ(transforms["frames"].size(), 8U);
  EXPECT_EQ(transforms["frames"][7]["file_path"], "images/right/000003.png");
  EXPECT_EQ(transforms["frames"][7]["w"], 240);
  EXPECT_TRUE(fs::exists(folder / "nerfstudio/depth/right/000003.png"));
  // The second camera is half a meter to the right of the first one, along its x axis.
  const auto position = [&](std::size_t frame) {
    const nlohmann::json& m = transforms["frames"][frame]["transform_matrix"];
    return cv::Vec3d(m[0][3], m[1][3], m[2][3]);
  };
  EXPECT_NEAR(cv::norm(position(4) - position(0)), 0.5, 0.01);

  const std::string mcap = read_file(folder / "mcap/drive.mcap");
  for (const char* topic : {"/front/image/compressed", "/right/image/compressed", "/right/camera_info"})
    EXPECT_THAT(mcap, HasSubstr(topic));
}

TEST_F(Cameras, HaveMasksToCorrect) {
  stereo_drive();
  const Result made = dvi("mask drive --camera all -o masks --quiet --json");
  ASSERT_EQ(made.code, 0) << made.err;
  const nlohmann::json cameras = nlohmann::json::parse(made.out).at("cameras");
  ASSERT_EQ(cameras.size(), 2U);
  EXPECT_EQ(cameras[1].at("camera"), "right");
  for (const char* camera : {"front", "right"}) {
    EXPECT_EQ(list_files(folder / "masks/masks" / camera, {".png"}).size(), 4U);
    for (const char* file : {"contact.png", "masks.json", "coco.json", "annotations.xml"})
      EXPECT_TRUE(fs::exists(folder / "masks" / camera / file)) << file;
  }
  // A region that is drawn into a mask of the second camera is removed there.
  const fs::path file = folder / "masks/masks/right/000002.png";
  cv::Mat mask = cv::imread(file.string(), 0);
  mask(cv::Rect(20, 20, 30, 20)) = 255;
  cv::imwrite(file.string(), mask);
  ASSERT_EQ(dvi("run drive --camera all --masks masks -o out --quiet").code, 0);
  const cv::Mat removed = cv::imread((folder / "out/right/masks/000002.png").string(), 0);
  EXPECT_EQ(cv::countNonZero(removed(cv::Rect(20, 20, 30, 20))), 600);
}

TEST_F(Cameras, NameTheImagesThatAreNotCleaned) {
  stereo_drive();
  fs::remove(folder / "drive/images/front/000003.png");
  fs::remove(folder / "drive/masks/front/000003.png");
  fs::copy(folder / "drive/images/right", folder / "drive/images/rear");
  const Result run = dvi("run drive --camera all -o out");
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("1 of 4 images of right are not cleaned"));
  EXPECT_THAT(run.err, HasSubstr("the images of rear are not used, because dvi.toml has no table [camera.rear]"));
  EXPECT_EQ(list_files(folder / "out/right/frames", {".png"}).size(), 3U);
}

TEST_F(Cameras, TakeTheFillOfAnotherProgram) {
  stereo_drive();
  ASSERT_EQ(dvi("run drive --camera all -o out --quiet").code, 0);
  const auto before = contents(folder / "out");
  ASSERT_EQ(dvi("export holes out -o holes --quiet").code, 0);
  for (const char* camera : {"front", "right"}) {
    make_folder(folder / "filled" / camera);
    for (const fs::path& file : list_files(folder / "holes" / camera / "frames", {".png"})) {
      cv::Mat image = cv::imread(file.string());
      image.setTo(cv::Scalar(90, 100, 110), cv::imread((folder / "holes" / camera / "masks" / file.filename()).string(), 0));
      cv::imwrite((folder / "filled" / camera / file.filename()).string(), image);
    }
  }
  const Result imported = dvi("import-fill out filled --quiet");
  ASSERT_EQ(imported.code, 0) << imported.err;
  for (const char* camera : {"front", "right"}) {
    const cv::Mat kind = cv::imread((folder / "out" / camera / "kind/000002.png").string(), cv::IMREAD_UNCHANGED);
    EXPECT_GT(cv::countNonZero(kind == 6), 50) << camera;
    EXPECT_EQ(cv::countNonZero(kind == 4), 0) << camera;
  }
  EXPECT_EQ(dvi("audit out drive --quiet").code, 0);
  ASSERT_EQ(dvi("import-fill out --undo --quiet").code, 0);
  const auto after = contents(folder / "out");
  for (const auto& [file, bytes] : before)
    if (file.ends_with(".png") || file.starts_with("map/")) {
      EXPECT_EQ(after.at(file), bytes) << file;
    }
  EXPECT_EQ(after.size(), before.size());
}

TEST_F(Cameras, AreFilledInPiecesWithTheSameBytes) {
  stereo_drive();
  ASSERT_EQ(dvi("run drive --camera front,right -o whole --quiet --threads 2").code, 0);
  const Result plan = dvi("plan drive --camera front,right -o out --quiet --json");
  EXPECT_EQ(nlohmann::json::parse(plan.out)["frames"], (nlohmann::json{0, 1, 2, 3})) << "each number once";
  ASSERT_EQ(dvi("fill out --frames 2:3 --quiet --threads 1").code, 0);
  EXPECT_EQ(list_files(folder / "out/right/frames", {".png"}).size(), 2U);
  const Result early = dvi("finish out --quiet");
  EXPECT_EQ(early.code, 3);
  EXPECT_THAT(early.err, HasSubstr("--frames 0:1 fills"));
  ASSERT_EQ(dvi("fill out --quiet").code, 0);
  ASSERT_EQ(dvi("finish out --quiet").code, 0);
  EXPECT_EQ(result("out"), result("whole"));
}

TEST_F(Cameras, WithoutMasksTakeThoseOfTheFirst) {
  stereo_drive();
  fs::remove_all(folder / "drive/masks/right");
  fs::remove(folder / "drive/boxes.json");
  ASSERT_EQ(dvi("run drive --camera front,right --masks drive/masks --set objects.complete=false -o out --quiet").code, 0);
  for (const fs::path& file : list_files(folder / "out/right/masks", {".png"})) {
    const cv::Mat1b mask = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
    EXPECT_GT(cv::countNonZero(mask), 500) << "the mask of the first camera is reprojected";
    EXPECT_LT(cv::countNonZero(mask), static_cast<int>(mask.total()) / 2);
    EXPECT_EQ(cv::countNonZero(mask.col(mask.cols - 1)), 0) << "the first camera does not show this side, which is kept";
  }
  int copies = 0, from_unknown = 0;
  for (const char* camera : {"front", "right"})
    for (const fs::path& file : list_files(folder / "out" / camera / "provenance", {".png"}))
      for (const cv::Mat_<cv::Vec3w> provenance = cv::imread(file.string(), cv::IMREAD_UNCHANGED);
           const cv::Vec3w& from : provenance) {  // blue, green, red: 16 y, 16 x, number + 1
        copies += from[2] > 4 ? 1 : 0;
        from_unknown += from[2] > 4 && from[1] >= 16 * (kSize.width - 2) ? 1 : 0;
      }
  EXPECT_GT(copies, 100) << "from the second camera";
  EXPECT_EQ(from_unknown, 0) << "this side may show traffic";
  EXPECT_EQ(dvi("audit out drive --quiet").code, 0);
}

TEST_F(Cameras, ARunOfOneCameraReplacesOneOfSeveral) {
  stereo_drive();
  ASSERT_EQ(dvi("run drive --camera all -o out --quiet").code, 0);
  const Result other = dvi("run drive -o out --quiet");
  EXPECT_EQ(other.code, 0) << other.err;
  EXPECT_EQ(list_files(folder / "out/frames", {".png"}).size(), 4U);
  EXPECT_TRUE(list_files(folder / "out/right/frames", {".png"}).empty()) << "frames of another run are removed";
  EXPECT_EQ(dvi("audit out drive --quiet").code, 0);
}

TEST_F(Cameras, GrayOnesAreCleanedInARunOfTheirOwn) {
  stereo_drive();
  for (const fs::path& file : list_files(folder / "drive/images/right", {".png", ".jpg"}))
    cv::imwrite(file.string(), cv::imread(file.string(), cv::IMREAD_GRAYSCALE));
  expect_refused("run drive --camera front,right -o refused --quiet", 2, "cleaned in runs of their own");
  const Result all = dvi("run drive --camera all -o out");
  EXPECT_EQ(all.code, 0);
  EXPECT_THAT(all.err, HasSubstr("camera right is not cleaned, because it has no colors"));
  EXPECT_TRUE(fs::exists(folder / "out/frames")) << "one camera remains";
  ASSERT_EQ(dvi("mask drive --camera all -o masks --quiet").code, 0);
  EXPECT_TRUE(fs::exists(folder / "masks/masks/front"));
  EXPECT_FALSE(fs::exists(folder / "masks/masks/right")) << "its masks are not those of a run";
}

TEST_F(Cameras, AreRefusedWhereOneIsTaken) {
  stereo_drive();
  expect_refused("run drive --camera front,rear -o refused", 2, "--camera rear: the drive has front, right");
  expect_refused("run drive --camera all --method telea -o refused", 2, "--method telea takes one camera");
  expect_refused("plan drive --camera all --section 1/2 -o refused", 2, "takes one camera");
  expect_refused("check drive --camera all", 2, "dvi check takes one camera");
  expect_refused("convert drive --camera all -o refused", 2, "dvi convert takes one camera");
  fs::rename(folder / "drive/images/right", folder / "drive/images/map");
  fs::rename(folder / "drive/masks/right", folder / "drive/masks/map");
  fs::rename(folder / "drive/times/right.txt", folder / "drive/times/map.txt");
  std::string config = read_file(folder / "drive/dvi.toml");
  config.replace(config.find("right"), 5, "map");
  write_file(folder / "drive/dvi.toml", config);
  expect_refused("run drive --camera all -o refused", 3, "cannot have a folder for camera 'map'");
}

}  // namespace
}  // namespace dvi
