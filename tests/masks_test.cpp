#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "program.h"

namespace dvi {
namespace {

using testing::HasSubstr;

class MasksOfDrives : public ProgramTest {
 protected:
  // A drive of which nobody said what to remove.
  fs::path unlabelled(const std::string& name) const {
    const fs::path drive = small_drive(name, "", 12);
    fs::remove_all(drive / "masks");
    fs::remove(drive / "boxes.json");
    return drive;
  }
  nlohmann::json json(const fs::path& file) const { return nlohmann::json::parse(read_file(folder / file)); }
};

TEST_F(MasksOfDrives, ADriveWithoutMasksAndLabelsJustRuns) {
  unlabelled("drive");
  const Result check = dvi("check drive --quiet");
  EXPECT_EQ(check.code, 0) << check.err;
  EXPECT_THAT(check.out, HasSubstr("dvi run finds what moves"));
  const Result run = dvi("run drive -o out --poses given --quiet");
  ASSERT_EQ(run.code, 0) << run.err;
  const nlohmann::json report = json("out/report.json");
  EXPECT_GT(report.at("hole").at("pixels").get<std::size_t>(), 0U);
  EXPECT_EQ(dvi("audit out drive --quiet").code, 0);
}

TEST_F(MasksOfDrives, WhatMaskWritesRunTakes) {
  unlabelled("drive");
  const Result mask = dvi("mask drive -o masks --poses given --quiet");
  ASSERT_EQ(mask.code, 0) << mask.err;
  const nlohmann::json masks = json("masks/masks.json");
  EXPECT_EQ(masks.at("source"), "found");
  EXPECT_EQ(masks.at("frames").size(), 12U);
  ASSERT_FALSE(masks.at("tracks").empty());
  for (const nlohmann::json& track : masks.at("tracks")) EXPECT_TRUE(track.at("removed").get<bool>());
  ASSERT_EQ(dvi("run drive -o found --poses given --quiet").code, 0);
  ASSERT_EQ(dvi("run drive -o given --poses given --quiet --masks masks --set masks.shadows=false").code, 0);
  EXPECT_EQ(::dvi::contents(folder / "found/masks"), ::dvi::contents(folder / "given/masks"));
}

TEST_F(MasksOfDrives, LabelsSayWhatMovesAndOneFrameHasNothingThatDoes) {
  small_drive("labelled", "", 12);
  ASSERT_EQ(dvi("mask labelled -o masks --masks labels --poses given --remove moving --quiet").code, 0);
  const nlohmann::json masks = json("masks/masks.json");
  EXPECT_EQ(masks.at("source"), "labels");
  for (const nlohmann::json& track : masks.at("tracks")) EXPECT_EQ(track.at("moves"), track.at("removed"));
  unlabelled("drive");
  const Result one = dvi("mask drive -o one --poses given --frames 3");
  EXPECT_EQ(one.code, 0) << one.err;
  EXPECT_THAT(one.err, HasSubstr("nothing moves in it"));
}

TEST_F(MasksOfDrives, ABaselineNeedsMasks) {
  unlabelled("drive");
  const Result run = dvi("run drive -o out --method telea --quiet");
  EXPECT_EQ(run.code, 3);
  EXPECT_THAT(run.err, HasSubstr("dvi mask"));
  EXPECT_FALSE(fs::exists(folder / "out"));
}

}  // namespace
}  // namespace dvi
