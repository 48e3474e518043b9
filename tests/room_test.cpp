#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "dvi/core/files.h"
#include "program.h"

namespace dvi {
namespace {

using testing::HasSubstr;

class Room : public ProgramTest {
 protected:
  nlohmann::json scores(const std::string& drive, const std::string& options = "") const {
    const Result run = dvi("run " + drive + " -o out --quiet " + options);
    EXPECT_EQ(run.code, 0) << run.err;
    const Result eval = dvi("eval out --truth room/truth --json --quiet");
    EXPECT_EQ(eval.code, 0) << eval.err;
    return nlohmann::json::parse(eval.out);
  }
};

TEST_F(Room, ThePersonIsRemovedWithDefaultOptions) {
  small_drive("room", "--room", 20);
  const nlohmann::json all = scores("room").at("all");
  EXPECT_GT(all.at("psnr").get<double>(), 27);
  EXPECT_EQ(dvi("audit out room").code, 0);
  const nlohmann::json hole = nlohmann::json::parse(read_file(folder / "out/report.json")).at("hole");
  EXPECT_EQ(hole.at("interpolated"), 0) << "without the ground of a road there is noise texture";
}

TEST_F(Room, OptionsOfAStreetAreRefused) {
  const Result refused = dvi("synth -o room --room --truck");
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("--truck"));
  EXPECT_FALSE(fs::exists(folder / "room"));
}

}  // namespace
}  // namespace dvi
