#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/core/error.h"
#include "dvi/exports/exporter.h"
#include "dvi/exports/geotiff.h"
#include "dvi/exports/ground_raster.h"
#include "dvi/exports/map_cloud.h"
#include "dvi/exports/mcap_writer.h"
#include "dvi/exports/ros_messages.h"
#include "dvi/media/write_ply.h"
#include "dvi/testing/temp_folder.h"

namespace dvi::exports {
namespace {

using testing::AllOf;
using testing::HasSubstr;

CloudPoint at(float x, float y, float z) { return {{x, y, z}, {1, 2, 3}, {0, 0, 1}, 0.5F, 0, 1}; }

fs::path write_cloud(const TempFolder& folder, const std::vector<CloudPoint>& cloud) {
  std::vector<Eigen::Vector3f> points;
  std::vector<cv::Vec3b> colors;
  std::vector<std::vector<float>> scalars(6);
  for (const CloudPoint& p : cloud) {
    points.push_back(p.position);
    colors.push_back(p.color);
    const std::array<float, 6> values{p.normal.x(), p.normal.y(), p.normal.z(), p.intensity, p.first_s, p.last_s};
    for (std::size_t k = 0; k < values.size(); ++k) scalars[k].push_back(values[k]);
  }
  media::PlyCloud ply{points, colors, {}, "a map"};
  const std::array<const char*, 6> names{"nx", "ny", "nz", "intensity", "first", "last"};
  for (std::size_t k = 0; k < names.size(); ++k) ply.scalars.push_back({names[k], scalars[k]});
  media::write_ply(folder.path / "map.ply", ply);
  return folder.path / "map.ply";
}

TEST(MapCloud, ReadsWrittenMapsAndThinsThemEvenly) {
  const TempFolder folder;
  std::vector<CloudPoint> cloud;
  for (int i = 0; i < 10; ++i) cloud.push_back(at(static_cast<float>(i), -1, 2));
  const fs::path ply = write_cloud(folder, cloud);
  const std::vector<CloudPoint> read = read_map_cloud(ply);
  ASSERT_EQ(read.size(), 10U);
  EXPECT_EQ(read[7].position, cloud[7].position);
  EXPECT_EQ(read[7].color, cloud[7].color);
  EXPECT_EQ(read[7].normal, cloud[7].normal);
  EXPECT_EQ(read[7].last_s, 1);
  EXPECT_EQ(read_map_cloud(ply, 5).size(), 5U);
  EXPECT_EQ(thin_cloud(cloud, 3).size(), 3U);
  EXPECT_EQ(thin_cloud(cloud, 0).size(), 10U);
}

TEST(MapCloud, RefusesFilesThatAreNotMapsOfAResult) {
  const TempFolder folder;
  EXPECT_THAT(input_error([&] { read_map_cloud(write_cloud(folder, {})); }), HasSubstr("holds no points"));
  EXPECT_THAT(input_error([&] { read_map_cloud(folder.path / "none.ply"); }), HasSubstr("cannot be read"));
  const std::string whole = read_file(write_cloud(folder, {at(0, 0, 0), at(1, 0, 0)}));
  const fs::path cut = folder.write("cut.ply", whole.substr(0, whole.size() - 1));
  EXPECT_THAT(input_error([&] { read_map_cloud(cut); }), HasSubstr("is truncated: its header declares 2 points"));
  const fs::path other =
      folder.write("other.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n");
  EXPECT_THAT(input_error([&] { read_map_cloud(other); }), HasSubstr("is not a map of dvi"));
}

TEST(Ground, IsTheLowestSurfaceAndKeepsItsSlope) {
  std::vector<CloudPoint> cloud;
  for (int x = 0; x <= 100; ++x)
    for (int y = 0; y <= 100; ++y) {
      const auto east = 0.1F * static_cast<float>(x), north = 0.1F * static_cast<float>(y);
      cloud.push_back(at(east, north, 0.05F * east));
      if (x > 40 && x < 60) cloud.push_back(at(east, north, 4));  // the crown of a tree above the ground
    }
  const GroundRaster ground = ground_of(cloud, 0.25);
  for (int row = 2; row < ground.height.rows - 2; ++row)
    for (int column = 2; column < ground.height.cols - 2; ++column) {
      const Eigen::Vector3d middle = ground.middle(row, column);
      EXPECT_NEAR(middle.z(), 0.05 * middle.x(), 0.01);
    }
  EXPECT_THROW(ground_of({at(0, 0, 0), at(1e5, 1e5, 0)}, 0.01), UsageError);
}

TEST(GeoPlace, RotatesTheWorldByItsHeading) {
  const GeoPlace local{0.5, 10, 20, {}};
  EXPECT_THAT(local.transform(), testing::ElementsAre(10, 0.5, 0, 20, 0, -0.5));
  EXPECT_EQ(local.projection(), "");
  // With an eastward heading, world x is east and y is north, as without an origin.
  const GeoPlace east{0.5, 10, 20, parse_origin("49,8,90")};
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(east.transform()[k], local.transform()[k], 1e-12);
  // With a northward heading, x is north and y is west.
  const std::array<double, 6> north = GeoPlace{0.5, 10, 20, parse_origin("49,8,0")}.transform();
  EXPECT_NEAR(north[0], -20, 1e-12);
  EXPECT_NEAR(north[3], 10, 1e-12);
  EXPECT_NEAR(north[4], 0.5, 1e-12);
  for (const char* wrong : {"", "49", "49,8", "49,8,0,1", "91,8,0", "a,b,c", "49,8,"})
    EXPECT_THROW(parse_origin(wrong), UsageError) << wrong;
}

// Returns the records after the magic by opcode, without those within chunks.
std::vector<std::pair<int, std::string>> records(const std::string& file) {
  std::vector<std::pair<int, std::string>> out;
  for (std::size_t i = 8; i + 8 < file.size();) {
    std::uint64_t size = 0;
    std::memcpy(&size, file.data() + i + 1, 8);
    out.emplace_back(file[i], file.substr(i + 9, size));
    i += 9 + size;
  }
  return out;
}

TEST(McapWriter, WritesASummaryWithCountsAndIndices) {
  const TempFolder folder;
  McapWriter writer(folder.path / "a.mcap");
  const std::uint16_t a = writer.add_channel("/a", "x/msg/X", "int32 a\n"),
                      b = writer.add_channel("/b", "x/msg/X", "int32 a\n");
  const std::string large(std::size_t{3} << 20, 'x');
  for (int i = 0; i < 4; ++i) writer.write(i % 2 == 0 ? a : b, 1000 - i, large);
  writer.finish();
  const std::string file = read_file(folder.path / "a.mcap");
  EXPECT_EQ(file.substr(0, 8), file.substr(file.size() - 8));
  std::vector<int> order;
  for (const auto& [kind, content] : records(file)) order.push_back(kind);
  EXPECT_THAT(order, testing::ElementsAre(1, 6, 7, 7, 6, 7, 7, 0x0F, 3, 4, 4, 0x0B, 8, 8, 0x0E, 2));
  const std::string statistics = records(file)[11].second;
  std::uint64_t count = 0, first = 0, last = 0;
  std::memcpy(&count, statistics.data(), 8);
  std::memcpy(&first, statistics.data() + 26, 8);
  std::memcpy(&last, statistics.data() + 34, 8);
  EXPECT_EQ(count, 4U);
  EXPECT_EQ(first, 997U);
  EXPECT_EQ(last, 1000U);
}

TEST(RosMessages, AlignEachNumberToItsSize) {
  const std::string info = ros::camera_info({1'500'000'000, "camera"}, {640, 480, 500, 501, 320, 240, {}});
  std::int32_t seconds = 0;
  std::memcpy(&seconds, info.data() + 4, 4);
  EXPECT_EQ(seconds, 1);
  // The bytes are the header: 8 bytes of time, 4 + 7 of "camera", padded to 20; then height and width; 4 + 10 of "plumb_bob",
  // padded to 44; then the count with padding.
  double fx = 0;
  std::memcpy(&fx, info.data() + 4 + 48 + 5 * 8, 8);
  EXPECT_EQ(fx, 500);
  EXPECT_EQ(info.size(), 4 + 48 + 8 * (5 + 9 + 9 + 12) + 6 * 4 + 1);
}

TEST(Exports, RefuseOptionsOfOtherFormats) {
  ExportOptions options;
  OptionTable table;
  options.describe(table);
  for (const ExportFormat& format : export_formats())
    for (const std::string& name : format.options) EXPECT_NO_THROW(require_used({{name, {}}}, table, format)) << name;
  EXPECT_THAT([&] { require_used({{"--cell-m", {}}}, table, find_export_format("colmap")); },
              testing::ThrowsMessage<UsageError>(HasSubstr("export colmap has no option --cell-m, which is one of ortho")));
  for (const Option& option : table.options())
    EXPECT_TRUE(std::any_of(export_formats().begin(), export_formats().end(),
                            [&](const ExportFormat& format) { return format.uses(option.name()); }))
        << option.name() << " has an effect in no format";
}

TEST(Exports, ReportMissingFiles) {
  const TempFolder folder;
  Progress quiet(ProgressStyle::quiet);
  const auto message = [&] {
    return input_error([&] { export_result({folder.path / "out", folder.path / "to"}, find_export_format("ply"), {}, quiet); });
  };
  EXPECT_THAT(message(), HasSubstr("is not a folder"));
  folder.write("out/frames/a.png", "");
  EXPECT_THAT(message(), HasSubstr("is not a finished result of dvi run"));
  folder.write("out/sources.json", R"({"schema": "dvi-sources/1", "sources": []})");
  folder.write("out/report.json", "{}");
  EXPECT_THAT(message(), HasSubstr("has no poses and no map"));
  folder.write("out/map/poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  folder.write("out/map/times.txt", "");
  EXPECT_THAT(message(), HasSubstr("has 0 lines, but poses.txt has 1"));
  folder.write("out/map/times.txt", "0.5\n");
  EXPECT_THAT(message(), HasSubstr("earlier version"));
  folder.write("out/sources.json", R"({"cameras": [{}], "sources": []})");
  EXPECT_THAT(message(), AllOf(HasSubstr("sources.json"), HasSubstr("is not as written by dvi")));
  folder.write("out/sources.json", "{");
  EXPECT_THAT(message(), HasSubstr("is not as written by dvi"));
  EXPECT_FALSE(fs::exists(folder.path / "to"));
  EXPECT_THROW(find_export_format("obj"), UsageError);
}

}  // namespace
}  // namespace dvi::exports
