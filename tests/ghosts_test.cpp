#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <string>

#include <nlohmann/json.hpp>

#include "dvi/core/files.h"
#include "dvi/datasets/reader.h"
#include "program.h"

namespace dvi {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class GhostsOfAResult : public ProgramTest {
 protected:
  // Writes labels of one object at a position in the world, in every frame. `with_box`: with a 3D box, else only its rectangle.
  void write_labels(const std::string& name, const Eigen::Vector3d& position, bool with_box) const {
    const Drive drive = datasets::read_drive(folder / "drive");
    json frames = json::object();
    for (const Frame& frame : drive.frames) {
      json label{{"track", 40}, {"class", "car"}, {"rect", {10, 10, 20, 20}}};
      const SE3 lidar_from_world = drive.poses.at(frame.time_ns)->inverse();
      const Eigen::Vector3d center = lidar_from_world * position;
      const Eigen::Matrix3d& R = lidar_from_world.R;
      if (with_box) {
        label["center"] = {center.x(), center.y(), center.z()};
        label["size"] = {4.0, 5.0, 3.0};
        label["rotation"] = {R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)};
      }
      frames[frame.name] = {label};
    }
    write_file(folder / name, json{{"version", 1}, {"camera", drive.camera_name}, {"frames", frames}}.dump());
  }

  json eval(const std::string& arguments) const {
    const Result result = dvi("eval out --quiet --json " + arguments);
    EXPECT_EQ(result.code, 0) << result.err;
    return json::parse(result.out);
  }
};

TEST_F(GhostsOfAResult, AreCountedByLabelsWithAndWithoutATruth) {
  small_drive();
  ASSERT_EQ(dvi("run drive -o out --quiet").code, 0);
  write_labels("on_the_road.json", {16, 0, 0}, true);
  const json found = eval("--labels on_the_road.json");
  EXPECT_FALSE(found.contains("all"));
  EXPECT_GT(found["artifacts"]["hole_pixels"], 0);
  const json& ghosts = found["ghosts"];
  ASSERT_TRUE(ghosts.is_object()) << found.dump();
  EXPECT_EQ(ghosts["stationary_tracks"], 1);
  EXPECT_EQ(ghosts["tracks"][0]["track"], 40);
  EXPECT_EQ(ghosts["tracks"][0]["class"], "car");
  EXPECT_GT(ghosts["tracks"][0]["removed"], 0);
  EXPECT_EQ(ghosts["not_judged"], 0);
  EXPECT_EQ(ghosts["per_frame"].size(), 6U);
  EXPECT_GT(ghosts["ghosts"], 0);
  EXPECT_LT(ghosts["ghosts"], ghosts["copied"]);
  std::size_t copied = 0;
  for (const json& frame : ghosts["per_frame"]) copied += frame["copied"].get<std::size_t>();
  EXPECT_EQ(ghosts["copied"], copied);
  const json scored = eval("--truth drive/truth --labels on_the_road.json");
  EXPECT_EQ(scored["ghosts"], ghosts);
  EXPECT_GT(scored["all"]["pixels"], 0);
  EXPECT_THAT(dvi("eval out --quiet --labels on_the_road.json").out, HasSubstr("show one of 1 stationary labeled objects"));

  write_labels("in_the_sky.json", {16, 0, 300}, true);
  EXPECT_EQ(eval("--labels in_the_sky.json")["ghosts"]["ghosts"], 0);
}

TEST_F(GhostsOfAResult, AreThoseOfTheLabelsOfTheRun) {
  small_drive();
  write_labels("on_the_road.json", {16, 0, 0}, true);
  ASSERT_EQ(dvi("run drive -o out --quiet --masks on_the_road.json").code, 0);
  EXPECT_EQ(eval("")["ghosts"]["stationary_tracks"], 1);
  fs::rename(folder / "drive", folder / "moved");
  const json without = eval("--truth moved/truth");
  EXPECT_TRUE(without["ghosts"].is_null());
  EXPECT_THAT(without["ghosts_left_out"], HasSubstr("drive"));
}

TEST_F(GhostsOfAResult, AreLeftOutWithTheReason) {
  small_drive();
  ASSERT_EQ(dvi("run drive -o out --quiet").code, 0);
  write_labels("flat.json", {16, 0, 0}, false);
  const json flat = eval("--labels flat.json");
  EXPECT_TRUE(flat["ghosts"].is_null());
  EXPECT_THAT(flat["ghosts_left_out"], HasSubstr("no stationary object"));
  EXPECT_THAT(dvi("eval out --quiet --labels flat.json").out, HasSubstr("ghosts: not known, because the labels"));

  const Result missing = dvi("eval out --quiet --labels missing.json");
  EXPECT_EQ(missing.code, 3);
  EXPECT_THAT(missing.err, HasSubstr("missing.json: does not exist"));
  write_file(folder / "broken.json", "{\"version\": 1, ");
  EXPECT_EQ(dvi("eval out --quiet --labels broken.json").code, 3);

  fs::remove(folder / "drive/boxes.json");
  EXPECT_THAT(eval("")["ghosts_left_out"], HasSubstr("drive has no labels; give --labels FILE"));
  ASSERT_EQ(dvi("run drive -o out2 --method telea --quiet").code, 0);
  EXPECT_THAT(dvi("eval out2 --quiet").out, HasSubstr("out2 has no poses"));
}

}  // namespace
}  // namespace dvi
