#include "dvi/datasets/reader.h"
#include "dvi/media/write_image.h"
#include "dvi/testing/image_folder.h"

namespace dvi::datasets {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kCamera =
    "[drive]\nversion = 1\n[camera.front]\nsize = [8, 6]\nK = [4, 0, 4, 0, 4, 3, 0, 0, 1]\n"
    "camera_from_lidar = [0, -1, 0, 0,  0, 0, -1, 0,  1, 0, 0, 0]\n";

class Folder : public testing::Test {
 protected:
  Folder() {
    folder.write("dvi.toml", kCamera);
    for (const char* name : {"a", "b", "c"}) {
      folder.write_image(std::string("images/front/") + name + ".png", cv::Mat3b(6, 8, cv::Vec3b()));
      folder.write_bin(std::string("lidar/") + name + ".bin", {1, 0, 0, 0, 0, 1, 0, 0});
    }
  }
  Drive read() const { return read_drive(folder.path); }
  std::string error() const {
    return input_error([&] { read(); });
  }
  TestFolder folder;
};

TEST_F(Folder, MatchesEqualNamesAtTheRateWithoutTimes) {
  folder.write("dvi.toml", std::string(kCamera) + "[lidar]\nrate = 20\n");
  const Drive drive = read();
  ASSERT_EQ(drive.frames.size(), 3U);
  EXPECT_EQ(drive.frames[2].number, 2);
  EXPECT_EQ(drive.frames[2].time_ns, 100'000'000);
  EXPECT_EQ(drive.scan_headers[2].time_ns, 100'000'000);
  EXPECT_EQ(drive.scan_headers[2].start_ns, 75'000'000);
  EXPECT_EQ(drive.camera.width, 8);
  EXPECT_TRUE(drive.poses.empty());
  EXPECT_TRUE(drive.warnings.empty());
}

TEST_F(Folder, ReadsTimesPosesMasksAndBoxes) {
  folder.write("dvi.toml", std::string(kCamera) + "offset_s = 0.001\n[lidar]\nstamp = \"start\"\nrotation = \"none\"\n");
  folder.write("times/front.txt", "a 1.05\nb 1.15\nc 1.25\n");
  folder.write("times/lidar.txt", "a 1.0\nb 1.1\nc 1.2\n");
  folder.write("poses.txt", "a 1 0 0 0 0 1 0 0 0 0 1 0\nc 1 0 0 2 0 1 0 0 0 0 1 0\n");
  folder.write("boxes.json",
               R"({"version":1,"frames":{"b":[{"track":0,"class":"car","center":[9,0,0],"size":[4,2,1],"yaw":0}]}})");
  folder.write_image("masks/front/b.png", cv::Mat1b(6, 8, uchar{1}));
  const Drive drive = read();
  EXPECT_EQ(drive.frames[1].time_ns, 1'151'000'000);
  EXPECT_EQ(drive.scan_headers[1].time_ns, 1'150'000'000);
  EXPECT_EQ(drive.poses.poses()[1].time_ns, 1'250'000'000);
  EXPECT_NEAR(drive.poses.at(1'150'000'000)->t.x(), 1, 1e-9);
  EXPECT_EQ(drive.frames[1].labels.size(), 1U);
  EXPECT_EQ((*drive.masks[1])(0, 0), 255);
  EXPECT_EQ((*drive.masks[0])(0, 0), 0);
  EXPECT_EQ(drive.scans[0]->time[1], 0);
  EXPECT_EQ(drive.other_files.size(), 5U);
  EXPECT_THAT(drive.warnings, testing::ElementsAre("boxes.json has no labels for 1 of 3 frames, in which nothing is removed: 0",
                                                   "no pose for the scans of frames 1",
                                                   "boxes.json ends early: it has no labels for frames 2"));
}

TEST_F(Folder, ReadsSpansOfScansPosesOfAnyTimeAndLabelsOfOneCamera) {
  folder.write("times/lidar.txt", "a 1.0 0.95 1.04\nb 1.1\nc 1.2 1.15 1.25\n");
  folder.write("poses.txt", "a 1 0 0 0 0 1 0 0 0 0 1 0\n@1.05 1 0 0 7 0 1 0 0 0 0 1 0\n");
  folder.write("boxes.json", R"({"version":1,"camera":"front","frames":{"b":[
      {"class":"car","rect":[1,2,3,4],"outline":{"size":[6,8],"counts":[40,8]}},
      {"class":"van","center":[9,0,0],"size":[4,2,1],"yaw":0,"rotation":[1,0,0,0,0,-1,0,1,0]}]}})");
  const Drive drive = read();
  EXPECT_EQ(drive.scan_headers[0].end_ns, 1'040'000'000);
  EXPECT_EQ(drive.scan_headers[1].end_ns, 1'150'000'000);
  EXPECT_EQ(drive.poses.poses()[1].time_ns, 1'050'000'000);
  EXPECT_FALSE(drive.labeled_around);
  const std::vector<Label>& labels = drive.frames[1].labels;
  ASSERT_EQ(labels.size(), 2U);
  EXPECT_EQ(labels[0].rect, cv::Rect2d(1, 2, 3, 4));
  EXPECT_EQ(labels[0].instance->runs.back(), 8U);
  EXPECT_EQ(labels[1].box->frame_from_box.R(1, 2), -1);
  folder.write("times/lidar.txt", "a 1.0 1.01 1.04\nb 1.1\nc 1.2\n");
  EXPECT_THAT(error(), AllOf(HasSubstr("lidar.txt:1"), HasSubstr("does not start before its time")));
}

TEST_F(Folder, MakesScansOfDepthImages) {
  fs::remove_all(folder.path / "lidar");
  cv::Mat1w depth(6, 8, ushort{0});
  depth(3, 6) = 2000;
  folder.write_image("depth/front/a.png", depth);
  folder.write_image("depth/front/b.png", cv::Mat1w(6, 8, ushort{0}));
  folder.write_image("depth/front/c.png", cv::Mat1w(5, 8, ushort{9}));
  folder.write("dvi.toml", "[camera.front]\nK = [4, 0, 4, 0, 4, 3, 0, 0, 1]\noffset_s = 0.5\n");
  const Drive drive = read();
  EXPECT_EQ(drive.sensor, Sensor::depth_camera);
  EXPECT_EQ(drive.scan_headers[0].time_ns, 500'000'000);
  EXPECT_EQ(drive.frames[0].time_ns, 500'000'000);
  const auto scan = drive.scans[0];
  ASSERT_EQ(scan->size(), 1U);
  EXPECT_TRUE(scan->points[0].isApprox(Eigen::Vector3f(1, 0, 2)));
  EXPECT_EQ(scan->time[0], 0);
  EXPECT_THAT(input_error([&] { drive.scans[1]; }), HasSubstr("b.png: holds no depth"));
  EXPECT_THAT(input_error([&] { drive.scans[2]; }), HasSubstr("c.png: is not a 16-bit gray image of 8x6"));
}

TEST_F(Folder, HasScansOfALidarUnlessDviTomlStatesAnotherSensor) {
  EXPECT_EQ(read().sensor, Sensor::lidar);
  folder.write("dvi.toml", std::string(kCamera) + "[lidar]\nsensor = \"depth_camera\"\n");
  EXPECT_EQ(read().sensor, Sensor::depth_camera);
  folder.write("dvi.toml", std::string(kCamera) + "[lidar]\nsensor = \"radar\"\n");
  EXPECT_THAT(error(), HasSubstr("'sensor' is not one of lidar, depth_camera"));
}

TEST_F(Folder, UsesTheCameraNamedInDviToml) {
  for (const char* name : {"a", "b", "c"})
    folder.write_image(std::string("images/a_rear/") + name + ".png", cv::Mat3b(6, 8, cv::Vec3b()));
  const std::string front = std::string(kCamera).substr(std::string(kCamera).find("[camera"));
  const std::string rear = "[camera.a_rear]" + front.substr(front.find('\n'));
  const auto write = [&](const std::string& head) { folder.write("dvi.toml", "[drive]\n" + head + front + rear); };
  write("");
  EXPECT_EQ(read().camera_name, "a_rear") << "the first by name";
  write("camera = \"front\"\n");
  EXPECT_EQ(read().camera_name, "front");
  EXPECT_EQ(read_drive(folder.path, {.camera = "a_rear", .frames = {}, .span = {}}).camera_name, "a_rear");
  write("camera = \"left\"\n");
  EXPECT_THAT(error(), HasSubstr("'camera' is not one of a_rear, front"));
}

TEST_F(Folder, ReadsExtrinsicsOfThreeOrFourRows) {
  const SE3 expected = read().camera_from_lidar;
  std::string text = kCamera;
  const std::size_t at = text.find("camera_from_lidar"), end = text.find(']', at);
  const auto add_row = [&](const std::string& row) { folder.write("dvi.toml", text.substr(0, end) + row + text.substr(end)); };
  const auto with = [&](const std::string& row) { return add_row(row), error(); };
  add_row(", 0, 0, 0, 1");
  EXPECT_TRUE(read().camera_from_lidar.t.isApprox(expected.t));
  EXPECT_THAT(with(", 0, 0, 0, 2"), HasSubstr("'camera_from_lidar' is not 0, 0, 0, 1; the matrix may be transposed"));
  EXPECT_THAT(with(", 0, 0, 0"), HasSubstr("'camera_from_lidar' is not a list of 12 numbers"));
  folder.write("dvi.toml",
               "[camera.front]\nK = [[4, 0, 4], [0, 4, 3], [0, 0, 1]]\n"
               "camera_from_lidar = [[0, -1, 0, 0], [0, 0, -1, 0], [1, 0, 0, 0], [0, 0, 0, 1]]\n");
  EXPECT_TRUE(read().camera_from_lidar.R.isApprox(expected.R)) << "rows as lists";
  EXPECT_EQ(read().camera.cx, 4);
}

TEST_F(Folder, RefusesSettingsThatAreMissingOrMalformed) {
  const auto with = [&](const std::string& text) { return folder.write("dvi.toml", text), error(); };
  EXPECT_THAT(with("[camera.front"), HasSubstr("dvi.toml:1:"));
  for (const char* text : {"[.front]\n", "[=]\n", "[[#\n", "[\x19]\n", "[", "K = ["})  // the library asserts a key here
    EXPECT_THAT(with(text), HasSubstr("dvi.toml")) << text;
  EXPECT_THAT(with("[drive]\nversion = 7\n"), HasSubstr("dvi.toml:2: 'version' is 7"));
  EXPECT_THAT(with("[cammera.front]\n"), HasSubstr("the file has no key 'cammera'"));
  EXPECT_THAT(with("lidar = 10\n"), AllOf(HasSubstr("dvi.toml:1: 'lidar' is not a table"), HasSubstr("[lidar]")));
  EXPECT_THAT(with("camera = \"front\"\n"), HasSubstr("'camera' is not a table"));
  EXPECT_THAT(with("[camera.front]\nk = []\n"), AllOf(HasSubstr("no key 'k'"), HasSubstr("it has size, K")));
  EXPECT_THAT(with("[camera.front]\nK = [1, 2]\n"), HasSubstr("'K' is not a list of 9 numbers"));
  EXPECT_THAT(with("[camera.front]\nsize = [8, 6]\n"), HasSubstr("[camera.front] has no K"));
  EXPECT_THAT(with("[camera.front]\nK = [4, 0, 4, 0, 4, 3, 0, 0, 1]\n"), HasSubstr("has no camera_from_lidar"));
  EXPECT_THAT(with("[camera.front]\nK = [4, 0, 0, 0, 4, 0, 4, 3, 1]\n"), HasSubstr("dvi.toml:2: 'K' is transposed"));
  EXPECT_THAT(with("[camera.front]\nsize = [65536, 65536]\n"), HasSubstr("'size' is 65536x65536"));
  EXPECT_THAT(with("[camera.front]\nsize = [8.5, 6]\n"), HasSubstr("whole pixels"));
  EXPECT_THAT(with("[camera.front]\nK = [1e12, 0, 4, 0, 4, 3, 0, 0, 1]\ncamera_from_lidar=[1,0,0,0,0,1,0,0,0,0,1,0]\n"),
              HasSubstr("dvi.toml: [camera.front]: fx = 1e+12 px is not within"));
  EXPECT_THAT(with("[camera.\"../../evil\"]\n"), HasSubstr("'../../evil' is not a valid name of a camera"));
  EXPECT_THAT(with("[camera.\"\"]\n"), HasSubstr("'' is not a valid name of a camera"));
  EXPECT_THAT(with("[camera.front]\ncamera_from_lidar = [1,0,0,0,0,1,0,0,0,0,-1,0]\n"), HasSubstr("it mirrors"));
  EXPECT_THAT(with("[camera.front]\ncamera_from_lidar = [1,0,0,0,0,1,0,0,0,0,2,0]\n"), HasSubstr("does not hold a rotation"));
  EXPECT_THAT(with(std::string(kCamera) + "[lidar]\nrotation = \"left\"\n"), HasSubstr("clockwise, counterclockwise, none"));
  EXPECT_THAT(with("[camera.rear]\n"), HasSubstr("no images of a camera that dvi.toml names"));
  EXPECT_THAT(with("[lidar]\nrate = 10\n"), HasSubstr("no table [camera.NAME]"));
  fs::remove(folder.path / "dvi.toml");
  EXPECT_THAT(error(), AllOf(HasSubstr("dvi.toml: is missing"), HasSubstr("dvi init")));
}

TEST_F(Folder, ReadsCameraModels) {
  const auto with = [&](const std::string& lines) { return folder.write("dvi.toml", kCamera + lines), read().camera; };
  EXPECT_EQ(with("model = \"pinhole\"\ndistortion_model = \"plumb_bob\"\n").model, CameraModel::pinhole);
  EXPECT_EQ(with("model = \"pinhole\"\ndistortion = [0.1, 0, 0, 0.2]\n").distortion[3], 0.2);
  EXPECT_EQ(with("distortion = [0.1, 0, 0, 0, 0, 0.2, 0, 0]\n").distortion[5], 0.2);
  for (const char* lines : {"model = \"fisheye\"\n", "distortion_model = \"equidistant\"\n", "model = \"KANNALA_BRANDT\"\n",
                            "model = \"pinhole\"\ndistortion_model = \"equidistant\"\n"}) {
    const Camera camera = with(std::string("distortion = [0.1, 0.2, 0.3, 0.4]\n") + lines);
    EXPECT_EQ(camera.model, CameraModel::fisheye) << lines;
    EXPECT_EQ(camera.distortion[3], 0.4);
  }
  const Camera unified = with("model = \"omni\"\ndistortion_model = \"radtan\"\nxi = 1.5\ndistortion = [0.1, 0, 0, 0]\n");
  EXPECT_EQ(unified.model, CameraModel::unified);
  EXPECT_EQ(unified.xi, 1.5);
  EXPECT_EQ(with("model = \"cylindrical\"\n").model, CameraModel::cylindrical);
}

TEST_F(Folder, DerivesTheMatrixOfAWholePanorama) {
  const auto with = [&](const char* size) {
    return folder.write("dvi.toml", std::string("[camera.front]\nmodel = \"equirectangular\"\n") + size +
                                        "camera_from_lidar = [0,-1,0,0, 0,0,-1,0, 1,0,0,0]\n");
  };
  with("");
  EXPECT_THAT(error(), AllOf(HasSubstr("'model' needs K"), HasSubstr("twice as wide as high")));
  with("size = [8, 6]\n");
  EXPECT_THAT(error(), HasSubstr("'model' needs K"));
  folder.write("dvi.toml", "[camera.front]\ndistortion_model = \"equirectangular\"\n");
  EXPECT_THAT(error(), HasSubstr("dvi.toml:2: 'distortion_model' needs K"));
}

TEST_F(Folder, RefusesOtherModelsOfDistortion) {
  const auto with = [&](const std::string& lines) { return folder.write("dvi.toml", kCamera + lines), error(); };
  EXPECT_THAT(with("distortion = [-0.02, 0.005, -0.001, 0.0002]\n"),
              AllOf(HasSubstr("dvi.toml:7: 'distortion' has 4 numbers"), HasSubstr("model = \"fisheye\"")));
  EXPECT_THAT(with("distortion = [0.1]\n"), HasSubstr("'distortion' has 1 numbers instead of 5"));
  EXPECT_THAT(with("distortion = [0, 0, 0, 0, 0, 0, 0, 0, 0.1, 0, 0, 0]\n"),
              AllOf(HasSubstr("thin prism"), HasSubstr("undistort the images first")));
  EXPECT_THAT(with("distortion = \"none\"\n"), HasSubstr("'distortion' is not a list of numbers"));
  for (const char* key : {"model", "distortion_model"})
    EXPECT_THAT(with(std::string(key) + " = \"division\"\n"),
                AllOf(HasSubstr(std::string("'") + key + "' is 'division'"), HasSubstr("undistort the images")));
  EXPECT_THAT(with("model = \"fisheye\"\ndistortion = [0, 0, 0, 0, 0]\n"), HasSubstr("has 5 numbers instead of 4"));
  EXPECT_THAT(with("model = \"unified\"\n"), AllOf(HasSubstr("needs xi"), HasSubstr("calibration")));
  EXPECT_THAT(with("model = \"unified\"\nxi = -1\n"), HasSubstr("'xi' needs xi, between 0 and 10"));
  EXPECT_THAT(with("xi = 1\n"), HasSubstr("the model is not \"unified\""));
  EXPECT_THAT(with("model = \"cylindrical\"\ndistortion = [0.1]\n"), HasSubstr("panoramas have no distortion"));
}

TEST_F(Folder, ReadsTextFilesOfOtherSystems) {
  folder.write("dvi.toml", std::string("\xEF\xBB\xBF") + kCamera);
  folder.write("times/front.txt",
               "\xEF\xBB\xBF"
               "a 1.0\r\nb 1.1\r\nc 1.2e+00\r\n");
  folder.write("times/lidar.txt", "a 1.0\rb 1.1\rc 1.2\r");
  EXPECT_EQ(read().frames[2].time_ns, 1'200'000'000);
  EXPECT_EQ(read().scan_headers[1].time_ns, 1'100'000'000);
  folder.write("times/front.txt", std::string("\xFF\xFE"
                                              "a\0 \0",
                                              6));
  EXPECT_THAT(error(), HasSubstr("front.txt: is UTF-16 text; save it as UTF-8"));
}

TEST_F(Folder, RefusesBrokenTimesPosesAndMasks) {
  folder.write("times/front.txt", "a 1.0\nb\n");
  EXPECT_THAT(error(), HasSubstr("front.txt:2: has 1 entries"));
  folder.write("times/front.txt", "a 1.0\nb noon\n");
  EXPECT_THAT(error(), HasSubstr("front.txt:2: 'noon' is not a time"));
  folder.write("times/front.txt", "a 1.0\nb 1.1\n");
  EXPECT_THAT(error(), AllOf(HasSubstr("c.png: has no time"), HasSubstr("front.txt")));
  folder.write("times/front.txt", "a 1.0\nb 1.0\nc 1.2\n");
  EXPECT_THAT(error(), HasSubstr("b.png: has a time that is not after that of a"));
  fs::remove_all(folder.path / "times");
  folder.write("poses.txt", "a 1 0 0 0 0 1 0 0 0 0 1 0\n\n");
  EXPECT_THAT(error(), HasSubstr("poses.txt:2: the line is empty"));
  fs::remove(folder.path / "poses.txt");
  folder.write_image("masks/front/z.png", cv::Mat1b(6, 8, uchar{1}));
  EXPECT_THAT(error(), HasSubstr("z.png: is not a mask of an image"));
}

}  // namespace
}  // namespace dvi::datasets
