#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <set>
#include <vector>

#include <nlohmann/json.hpp>

#include "program.h"

namespace dvi {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::vector<std::uint32_t> read_values(const fs::path& file) {
  const std::string bytes = read_file(file);
  std::vector<std::uint32_t> values(bytes.size() / sizeof(std::uint32_t));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

constexpr std::size_t kPointBytes = 16;  // x, y, z, intensity

/// A finished result of a drive whose moving objects were found.
class ExportLabels : public ProgramTest {
 protected:
  void SetUp() override { small_drive(); }
  void run_drive() const {
    const Result run = dvi("run drive -o out --poses given --masks found --quiet");
    ASSERT_EQ(run.code, 0) << run.err;
  }
  Result eval(const std::string& arguments) const { return dvi("eval out --quiet " + arguments); }
  nlohmann::json points_json(const std::string& truth) const {
    const Result scored = eval("--json --points " + truth);
    EXPECT_EQ(scored.code, 0) << scored.err;
    return nlohmann::json::parse(scored.out).at("points");
  }
};

TEST_F(ExportLabels, WritesOneLabelPerPointOfEachScan) {
  // The first scan gets a point that is not a return, before all others.
  const std::string scan = read_file(folder / "drive/lidar/000000.bin");
  write_file(folder / "drive/lidar/000000.bin", std::string(kPointBytes, '\0') + scan);
  const std::string truth = read_file(folder / "drive/truth_points/000000.label");
  write_file(folder / "drive/truth_points/000000.label", std::string(4, '\0') + truth);
  run_drive();
  const Result exported = dvi("export labels out -o labels --quiet --json");
  ASSERT_EQ(exported.code, 0) << exported.err;
  EXPECT_EQ(nlohmann::json::parse(exported.out).at("counts").at("scans"), 6);
  std::set<std::uint32_t> numbers;
  for (const fs::path& file : list_files(folder / "drive/lidar", {".bin"})) {
    const std::vector<std::uint32_t> values = read_values(folder / "labels" / (file.stem().string() + ".label"));
    EXPECT_EQ(values.size() * kPointBytes, fs::file_size(file)) << file;
    for (const std::uint32_t value : values) {
      EXPECT_TRUE(value == 0 || (value & 0xFFFFU) == 254 || (value & 0xFFFFU) == 259) << value;
      if (value != 0) numbers.insert(value >> 16U);
    }
  }
  EXPECT_EQ(read_values(folder / "labels/000000.label").front(), 0U);
  const nlohmann::json removed = nlohmann::json::parse(read_file(folder / "out/objects.json")).at("objects");
  EXPECT_FALSE(removed.empty());
  for (const nlohmann::json& object : removed)
    EXPECT_TRUE(numbers.contains(object.at("object").get<std::uint32_t>())) << object;
  EXPECT_THAT(read_file(folder / "labels/labels.yaml"), AllOf(HasSubstr("252: \"moving-car\""), HasSubstr("0: \"unlabeled\"")));

  // The scores are those of the exported labels.
  const nlohmann::json scores = points_json("drive/truth_points");
  EXPECT_EQ(scores.at("scans"), 6);
  EXPECT_GT(scores.at("in_view").at("da"), 0.6) << "few sparse scans";
  EXPECT_GT(scores.at("in_view").at("sa"), 0.99);
  EXPECT_LT(scores.at("in_view").at("static"), scores.at("all").at("static"));
  const nlohmann::json own = points_json("labels");
  for (const char* figure : {"sa", "da", "aa", "iou"}) EXPECT_EQ(own.at("all").at(figure), 1) << figure;
  EXPECT_THAT(eval("--points drive/truth_points").out, AllOf(HasSubstr("points of 6 scans"), HasSubstr("in view")));

  // Any number of threads writes the same files, which can be given as masks.
  ASSERT_EQ(dvi("export labels out -o again --quiet --threads 1").code, 0);
  EXPECT_EQ(contents(folder / "labels"), contents(folder / "again"));
  EXPECT_EQ(dvi("mask drive -o masks --quiet --poses given --masks ./labels").code, 0);
}

TEST_F(ExportLabels, RefusesATruthThatDoesNotFit) {
  run_drive();
  const auto expect_error = [&](const std::string& truth, const std::string& words) {
    const Result result = eval("--points " + truth);
    EXPECT_EQ(result.code, 3);
    EXPECT_THAT(result.err, HasSubstr(words));
  };
  expect_error("nowhere", "is not a folder");
  expect_error("drive/lidar", "has no .label files");
  fs::copy(folder / "drive/truth_points", folder / "truth");
  write_file(folder / "truth/000002.label", std::string(8, '\0'));
  expect_error("truth", "000002.label: has 2 labels, but its scan has");
  write_file(folder / "truth/000002.label", "seven b");
  expect_error("truth", "7 bytes are not a whole number of labels");
  fs::remove(folder / "truth/000002.label");
  expect_error("truth", "000002.label: is missing");
}

TEST_F(ExportLabels, NeedsAResultWithPosesAndScans) {
  ASSERT_EQ(dvi("run drive -o out --method telea --quiet").code, 0);
  const Result baseline = eval("--points drive/truth_points");
  EXPECT_EQ(baseline.code, 3);
  EXPECT_THAT(baseline.err, HasSubstr("is a result of --method telea"));
  EXPECT_EQ(dvi("export labels out -o labels --quiet").code, 3);
  fs::remove_all(folder / "out");
  run_drive();
  fs::remove_all(folder / "drive/lidar");
  EXPECT_EQ(dvi("export labels out -o labels --quiet").code, 3);
  EXPECT_FALSE(fs::exists(folder / "labels"));
  fs::remove(folder / "out/report.json");
  const Result unfinished = eval("--points drive/truth_points");
  EXPECT_EQ(unfinished.code, 3);
  EXPECT_THAT(unfinished.err, HasSubstr("is not a finished result"));
}

}  // namespace
}  // namespace dvi
