#include "dvi/inputs/mask_sources.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "dvi/core/error.h"
#include "dvi/media/write_image.h"
#include "dvi/testing/temp_folder.h"

namespace dvi::inputs {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

constexpr const char* kBox = R"("class":"car","center":[9,0,0],"size":[4,2,2],"yaw":0)";

// A drive of three frames, with folders and files that may be sources of its masks.
class MaskSourcesOf : public testing::Test {
 protected:
  MaskSourcesOf() {
    drive.path = folder.path / "drive";
    drive.camera_name = "front";
    drive.camera = {8, 6, 4, 4, 4, 3, {}};
    for (int i = 0; i < 3; ++i) {
      const std::string name = std::to_string(i);
      drive.frames.push_back({i, name, i, drive.path / "images/front" / (name + ".png"), {}});
    }
    drive.scan_headers.resize(3);
    folder.write("first.json", label_file(R"([{"track":4,)"));
    folder.write("second.json", label_file(R"([{"track":4,)"));
  }

  static std::string label_file(const std::string& begin) {
    return R"({"version":1,"frames":{"0":)" + begin + kBox + R"(}],"2":)" + begin + kBox + "}]}}";
  }

  // Writes a mask of one painted column.
  void write_mask(const std::string& name, int column, bool inverted = false) {
    cv::Mat1b mask(6, 8, uchar{0});
    mask.col(column) = 255;
    const fs::path file = folder.path / name;
    make_folder(file.parent_path());
    media::write_png(file, inverted ? cv::Mat1b(~mask) : mask);
  }

  std::string path(const std::string& name) const { return (folder.path / name).string(); }

  MaskSources attach(const std::vector<std::string>& masks, MaskNeed need = MaskNeed::required) {
    choice.masks.clear();
    for (const std::string& text : masks) choice.masks.push_back(job::MasksFrom::parse(text));
    return attach_mask_sources(drive, choice, need);
  }

  std::vector<int> masked_columns(std::size_t frame) const {
    std::vector<int> out;
    for (int x = 0; x < 8; ++x)
      if ((*drive.masks[frame])(2, x) != 0) out.push_back(x);
    return out;
  }

  TempFolder folder;
  Drive drive;
  job::ReadChoice choice;
};

TEST_F(MaskSourcesOf, AutomaticIsTheFirstThatTheDriveHas) {
  EXPECT_EQ(attach({"auto"}), MaskSources{MaskSource::found});
  EXPECT_THAT(attach({"auto"}, MaskNeed::optional), IsEmpty());
  drive.labeled = true;
  EXPECT_EQ(attach({"auto"}), MaskSources{MaskSource::labels});
  EXPECT_EQ(attach({"auto", "found"}), (MaskSources{MaskSource::labels, MaskSource::found}));
  EXPECT_EQ(to_string(attach({"auto", "found", "auto"})), "labels, found");
}

TEST_F(MaskSourcesOf, ADetectorIsOneMoreSource) {
  choice.detector = "net.onnx";
  EXPECT_EQ(attach({"auto"}), (MaskSources{MaskSource::detected, MaskSource::found}));
  EXPECT_EQ(attach({"none"}), MaskSources{MaskSource::detected});
  drive.scan_headers.clear();
  EXPECT_EQ(attach({"auto"}), MaskSources{MaskSource::detected});
  EXPECT_THAT(drive.warnings, IsEmpty());
  choice.mask_files.classes = "car";
  EXPECT_EQ(attach({"auto"}), MaskSources{MaskSource::detected});
}

TEST_F(MaskSourcesOf, NoneAloneIsRefused) {
  EXPECT_THAT([&] { attach({"none"}); }, ThrowsMessage<UsageError>(HasSubstr("--masks none removes nothing")));
  EXPECT_THAT(attach({"none"}, MaskNeed::optional), IsEmpty());
}

TEST_F(MaskSourcesOf, MaskFoldersAreUnitedPerFrame) {
  write_mask("a/0.png", 1);
  write_mask("a/1.png", 1);
  write_mask("b/1.png", 6, true);
  EXPECT_EQ(attach({"white:" + path("a"), "black:" + path("b"), "white:" + path("a")}), MaskSources{MaskSource::files});
  EXPECT_THAT(masked_columns(0), ElementsAre(1));
  EXPECT_THAT(masked_columns(1), ElementsAre(1, 6));
  EXPECT_THAT(masked_columns(2), IsEmpty());
  EXPECT_THAT(drive.mask_files, ElementsAre(folder.path / "a/0.png", folder.path / "a/1.png", fs::path()));
  EXPECT_THAT(drive.other_files, testing::Contains(folder.path / "b/1.png")) << "an input of the run";
}

TEST_F(MaskSourcesOf, LabelsOfSeveralFilesHaveTracksOfTheirOwn) {
  EXPECT_EQ(attach({path("first.json"), path("second.json"), path("first.json")}), MaskSources{MaskSource::labels});
  ASSERT_EQ(drive.frames[0].labels.size(), 2U);
  EXPECT_EQ(drive.frames[0].labels[0].track, 4);
  EXPECT_EQ(drive.frames[0].labels[1].track, 9);
  EXPECT_EQ(drive.frames[2].labels[1].track, 9) << "the same in all frames";
  EXPECT_THAT(drive.frames[1].labels, IsEmpty());
  EXPECT_TRUE(drive.labeled_around);
}

TEST_F(MaskSourcesOf, ALabelFileReplacesTheLabelsOfTheDriveUnlessTheyAreNamed) {
  drive.labeled = true;
  Label van;
  van.track = 2;
  van.type = "van";
  drive.frames[1].labels = {van};
  Drive copy = drive;
  attach({path("first.json")});
  EXPECT_THAT(drive.frames[1].labels, IsEmpty());
  std::swap(drive, copy);
  attach({path("first.json"), "labels"});
  ASSERT_EQ(drive.frames[1].labels.size(), 1U);
  EXPECT_EQ(drive.frames[1].labels[0].track, 2);
  EXPECT_EQ(drive.frames[0].labels[0].track, 7);
  EXPECT_FALSE(drive.labeled_around);
}

TEST_F(MaskSourcesOf, RemoveAllAddsTheLabelsOfTheDriveToItsMaskFiles) {
  write_mask("a/0.png", 1);
  drive.labeled = true;
  EXPECT_EQ(attach({path("a")}), MaskSources{MaskSource::files});
  choice.remove = job::Remove::all;
  EXPECT_EQ(attach({path("a")}), (MaskSources{MaskSource::files, MaskSource::labels}));
}

TEST_F(MaskSourcesOf, ContradictionsAndMissingSourcesAreNamed) {
  write_mask("a/0.png", 1);
  const auto usage_error = [&](const std::vector<std::string>& masks, const char* text) {
    EXPECT_THAT([&] { attach(masks); }, ThrowsMessage<UsageError>(HasSubstr(text)));
  };
  usage_error({"white:" + path("a"), "black:" + path("a")}, "contradict each other");
  usage_error({"white:" + path("first.json")}, "only mask files have a polarity");
  EXPECT_THAT(input_error([&] { attach({"found", path("nowhere")}); }), HasSubstr("does not exist"));
  EXPECT_THAT(input_error([&] { attach({"found", "labels"}); }), HasSubstr("has no labels"));
  drive.scan_headers.clear();
  EXPECT_THAT(input_error([&] { attach({path("a"), "found"}); }), HasSubstr("has no scans"));
  EXPECT_THAT(input_error([&] { attach({"auto"}); }), HasSubstr("has neither masks nor labels"));
}

}  // namespace
}  // namespace dvi::inputs
