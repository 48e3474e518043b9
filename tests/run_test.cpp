#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "dvi/media/image_file.h"
#include "dvi/media/write_image.h"
#include "program.h"

namespace dvi {
namespace {

using testing::HasSubstr;
using testing::Not;

class Run : public ProgramTest {
 protected:
  nlohmann::json report(const std::string& out = "out") const {
    return nlohmann::json::parse(read_file(folder / out / "report.json"));
  }
};

/// Returns a report without its cost.
nlohmann::json timeless(nlohmann::json report) {
  report.erase("cost");
  return report;
}

TEST_F(Run, WritesAllDocumentedFiles) {
  small_drive();
  const Result result = dvi("run drive -o out --quiet");
  ASSERT_EQ(result.code, 0) << result.err;
  for (const char* file : {"sources.json", "map/poses.txt", "map/times.txt", "map/map.ply", "map/map.json", "video.mp4",
                           "compare.mp4", "contact.png", "report.json", "dvi.toml"})
    EXPECT_TRUE(fs::exists(folder / "out" / file)) << file;
  for (const fs::path& input : list_files(folder / "drive/images/front", {".png"})) {
    const std::string name = input.filename();
    const cv::Mat1b mask = media::read_png_gray(folder / "out/masks" / name, kSize);
    const cv::Mat1b kind = media::read_png_gray(folder / "out/kind" / name, kSize);
    const cv::Mat1b confidence = media::read_png_gray(folder / "out/confidence" / name, kSize);
    const cv::Mat_<cv::Vec3w> provenance = media::read_png_triples(folder / "out/provenance" / name, kSize);
    const cv::Mat_<cv::Vec3w> harmonization = media::read_png_triples(folder / "out/harmonization" / name, kSize);
    media::read_png_depth(folder / "out/depth" / name, kSize);
    const cv::Mat3b original = media::read_image(input, kSize), filled = media::read_image(folder / "out/frames" / name, kSize);
    const std::size_t sources = nlohmann::json::parse(read_file(folder / "out/sources.json"))["sources"].size();
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        const cv::Vec3w source = provenance(y, x);
        if (mask(y, x) == 0) {
          ASSERT_EQ(filled(y, x), original(y, x)) << "unmasked pixels are the input's";
          ASSERT_EQ(kind(y, x), 0);
          ASSERT_EQ(confidence(y, x), 255);
        } else {
          ASSERT_GE(kind(y, x), 1);
          ASSERT_LE(kind(y, x), 5);
        }
        ASSERT_EQ(source[0] > 0, kind(y, x) == 1 || kind(y, x) == 2);
        ASSERT_EQ(source[0] > 0, harmonization(y, x)[0] > 0);
        ASSERT_LE(source[0], sources);
        ASSERT_LE(source[1], (kSize.width - 1) * 16);
        ASSERT_LE(source[2], (kSize.height - 1) * 16);
      }
  }
}

TEST_F(Run, ReportIsConsistent) {
  small_drive();
  const Result result = dvi("run drive -o out --quiet --json");
  ASSERT_EQ(result.code, 0) << result.err;
  const nlohmann::json j = nlohmann::json::parse(result.out);
  EXPECT_EQ(j, report());
  EXPECT_EQ(j["frames"].size(), 6);
  std::size_t pixels = 0;
  for (const auto& frame : j["frames"]) {
    pixels += frame["hole"]["pixels"].get<std::size_t>();
    EXPECT_TRUE(frame["energy"].is_null()) << "nothing minimizes it by default";
  }
  const auto& hole = j["hole"];
  EXPECT_EQ(hole["pixels"].get<std::size_t>(), pixels);
  EXPECT_EQ(hole["copied"].get<std::size_t>() + hole["copied_elsewhere"].get<std::size_t>() +
                hole["interpolated"].get<std::size_t>() + hole["synthesized"].get<std::size_t>() +
                hole["empty"].get<std::size_t>(),
            pixels);
  EXPECT_GT(hole["share"]["copied"], 0);
}

TEST_F(Run, WritesTheSameBytesWithOneAndTwoThreads) {
  small_drive();
  small_drive("second", "--day 2");
  ASSERT_EQ(dvi("run drive second -o one --threads 1 --quiet").code, 0);
  ASSERT_EQ(dvi("run drive second -o two --threads 2 --quiet").code, 0);
  const auto one = contents(folder / "one"), two = contents(folder / "two");
  ASSERT_EQ(one.size(), two.size());
  for (const auto& [name, bytes] : one) EXPECT_TRUE(two.at(name) == bytes) << name;
}

TEST_F(Run, ContinuesAnInterruptedRun) {
  small_drive();
  ASSERT_EQ(dvi("run drive -o whole --quiet").code, 0);
  const auto whole = contents(folder / "whole");
  // The next call must write the same bytes for every time of the signal.
  int interrupted = 0;
  for (const char* delay : {"0.15", "0.4", "0.7", "1.0"}) {
    const Result killed =
        shell(std::string("timeout -s KILL ") + delay + " " + DVI_PROGRAM + " run drive -o out --threads 1 --quiet");
    interrupted += killed.code == 0 ? 0 : 1;
  }
  ASSERT_EQ(dvi("run drive -o out --quiet").code, 0);
  const auto resumed = contents(folder / "out");
  EXPECT_GT(interrupted, 0);
  for (const auto& [name, bytes] : whole) EXPECT_TRUE(resumed.at(name) == bytes) << name;
  EXPECT_EQ(resumed.size(), whole.size()) << "no part files are left";
}

TEST_F(Run, KeepsFinishedFramesAndMakesMissingOnes) {
  small_drive();
  ASSERT_EQ(dvi("run drive -o out --quiet").code, 0);
  const auto before = contents(folder / "out");
  const fs::path first = folder / "out/frames/000000.png", third = folder / "out/frames/000002.png";
  const auto time = fs::last_write_time(first);
  fs::remove(folder / "out/.dvi/frames/000002.json");
  fs::remove(third);
  const nlohmann::json earlier = timeless(report());
  const Result again = dvi("run drive -o out");
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(fs::last_write_time(first), time) << "a finished frame is not written again";
  EXPECT_TRUE(contents(folder / "out") == before);
  EXPECT_THAT(again.err, HasSubstr("alignment, exposure, ground, map, objects, poses of an earlier call are used"));
  for (const char* stage : {"read:", "odometry:", "carve:", "exposure:", "align:"})
    EXPECT_THAT(again.err, Not(HasSubstr(std::string("\n") + stage))) << "the stage is kept";
  EXPECT_EQ(timeless(report()), earlier) << "poses, map, warnings as on the first call";
  const Result whole = dvi("run drive -o out");
  EXPECT_THAT(whole.err, HasSubstr("nothing to do"));
  EXPECT_THAT(whole.err, Not(HasSubstr("odometry"))) << "this is determined first";
}

TEST_F(Run, DamagedFilesAreMadeAgain) {
  small_drive();
  ASSERT_EQ(dvi("run drive -o out --quiet").code, 0);
  const auto whole = contents(folder / "out");
  const auto damage = [&](const std::string& file, const std::function<void(const fs::path&)>& how) {
    how(folder / "out" / file);
    const Result again = dvi("run drive -o out --quiet");
    EXPECT_EQ(again.code, 0) << file << ": " << again.err;
    EXPECT_TRUE(contents(folder / "out") == whole) << file;
    EXPECT_TRUE(fs::exists(folder / "out/report.json")) << file;
  };
  const auto cut = [](const fs::path& file) { fs::resize_file(file, fs::file_size(file) / 2); };
  const auto empty = [](const fs::path& file) { fs::resize_file(file, 0); };
  const auto gone = [](const fs::path& file) { fs::remove(file); };
  const auto other = [](const fs::path& file) {
    std::string bytes = read_file(file);
    bytes[bytes.size() / 2] ^= 1;
    write_file(file, bytes);
  };
  damage("frames/000001.png", gone);
  damage("provenance/000003.png", cut);
  damage("depth/000004.png", other);
  damage("video.mp4", cut);
  damage("map/map.ply", other);
  damage("sources.json", gone);
  damage("report.json", gone);
  damage("dvi.toml", cut);
  damage("report.json", cut);
  damage(".dvi/frames/000002.json", empty);
  damage(".dvi/result.json", cut);
  damage(".dvi/job.json", empty);
  for (const std::string stage : {"poses", "map", "exposure", "alignment"}) {
    fs::remove(folder / "out/.dvi/frames/000001.json");
    damage(".dvi/stages/" + stage + ".bin", other);
    fs::remove(folder / "out/.dvi/frames/000001.json");
    damage(".dvi/stages/" + stage + ".json", gone);
  }
}

TEST_F(Run, DeletesOnlyItsOwnFiles) {
  small_drive();
  ASSERT_EQ(dvi("run drive -o out --quiet").code, 0);
  make_folder(folder / "elsewhere");
  const std::vector<fs::path> foreign{folder / "out/frames/holiday.png", folder / "out/.notes.part.txt",
                                      folder / "elsewhere/.a.part12.png"};
  for (const fs::path& file : foreign) write_file(file, "mine");
  fs::create_directory_symlink(folder / "elsewhere", folder / "out/photos");
  ASSERT_EQ(dvi("run drive -o out --quiet --frames 1:4").code, 0);
  EXPECT_FALSE(fs::exists(folder / "out/frames/000000.png")) << "no longer part of the result";
  for (const fs::path& file : foreign) EXPECT_EQ(read_file(file), "mine") << file;
}

TEST_F(Run, DoesNotWriteToItsInputs) {
  const fs::path drive = small_drive();
  fs::copy(drive / "masks/front", folder / "masks");
  const auto before = ::dvi::contents(folder / "drive");
  for (const char* arguments : {"-o drive", "-o .", "-o drive/out", "-o drive/images/front", "--masks masks -o masks",
                                "--masks masks -o masks/out", "-o masks/../drive"}) {
    const Result refused = dvi(std::string("run drive --force --quiet ") + arguments);
    EXPECT_EQ(refused.code, 3) << arguments;
    EXPECT_THAT(refused.err, HasSubstr("input of the run")) << arguments;
  }
  EXPECT_TRUE(::dvi::contents(folder / "drive") == before);
  EXPECT_EQ(list_files(folder / "masks", {".png"}).size(), 6U);
}

TEST_F(Run, TwoRunsInOneFolderDoNotMix) {
  small_drive();
  ASSERT_EQ(dvi("run drive -o alone --quiet").code, 0);
  const Result both =
      shell(std::string("{ ( ") + DVI_PROGRAM + " run drive -o out --quiet; echo first $? >>codes ) & ( " + DVI_PROGRAM +
            " run drive -o out --quiet --set stages.smooth=false; echo second $? >>codes ) & wait; }");
  const std::string codes = read_file(folder / "codes");
  const bool first = codes.find("first 0") != std::string::npos, second = codes.find("second 0") != std::string::npos;
  EXPECT_TRUE(first || second) << codes << both.err;
  if (!(first && second)) {
    // The other one may not have written its number yet.
    EXPECT_THAT(both.err,
                testing::AnyOf(HasSubstr("is being written by process"), HasSubstr("is being written by another process")));
  }
  ASSERT_EQ(dvi("run drive -o out --quiet").code, 0);
  EXPECT_TRUE(contents(folder / "out") == contents(folder / "alone"));
}

TEST_F(Run, AFolderOfARunThatHasJustBegunIsAccepted) {
  small_drive();
  make_folder(folder / "out/.dvi/frames");  // the first folder of a run
  EXPECT_EQ(dvi("run drive -o out --quiet").code, 0);
  EXPECT_TRUE(fs::exists(folder / "out/report.json"));
}

TEST_F(Run, DetectsAChangedScanOfTheSameSizeAndTime) {
  const fs::path drive = small_drive();
  ASSERT_EQ(dvi("run drive -o out --quiet").code, 0);
  const fs::path scan = list_files(drive / "lidar", {".ply", ".bin", ".pcd"}).front();
  const fs::file_time_type time = fs::last_write_time(scan);
  std::string bytes = read_file(scan);
  bytes[bytes.size() - 2] ^= 1;
  write_file(scan, bytes);
  fs::last_write_time(scan, time);
  const Result again = dvi("run drive -o out");
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_THAT(again.err, HasSubstr("6 of 6 frames"));
  EXPECT_THAT(again.err, HasSubstr("made again"));
}

TEST_F(Run, OtherOptionsMakeFramesAgain) {
  small_drive();
  ASSERT_EQ(dvi("run drive -o out --quiet").code, 0);
  const auto before = contents(folder / "out");
  ASSERT_EQ(dvi("run drive -o out --quiet --set harmonize.poisson=false --set stages.smooth=false --frames 1:4").code, 0);
  EXPECT_NE(read_file(folder / "out/frames/000002.png"), before.at("frames/000002.png"));
  EXPECT_FALSE(fs::exists(folder / "out/frames/000000.png")) << "frames that are no longer part of the result are removed";
  EXPECT_EQ(report()["frames"].size(), 4);
}

TEST_F(Run, OptionsOfTheFillKeepTheStagesBeforeIt) {
  small_drive();
  ASSERT_EQ(dvi("run drive -o out --quiet").code, 0);
  const Result fill = dvi("run drive -o out --frames 0:5 --set harmonize.poisson=false --set job.memory_mb=16");
  ASSERT_EQ(fill.code, 0) << fill.err;
  EXPECT_THAT(fill.err, HasSubstr("alignment, exposure, ground, map, objects, poses of an earlier call are used"));
  const Result stages = dvi("run drive -o out --set map.voxel_m=0.1");
  ASSERT_EQ(stages.code, 0) << stages.err;
  EXPECT_THAT(stages.err, Not(HasSubstr("of an earlier call")));
}

TEST_F(Run, RefusesFoldersOfOtherDrives) {
  small_drive();
  small_drive("other", "--seed 5");
  ASSERT_EQ(dvi("run drive -o out --quiet").code, 0);
  const auto before = contents(folder / "out");
  const Result refused = dvi("run other -o out --quiet");
  EXPECT_EQ(refused.code, 3);
  EXPECT_THAT(refused.err, HasSubstr("--force"));
  EXPECT_TRUE(contents(folder / "out") == before);
  ASSERT_EQ(dvi("run other -o out --force --quiet").code, 0);
  EXPECT_FALSE(contents(folder / "out") == before);

  make_folder(folder / "mine");
  write_file(folder / "mine/thesis.tex", "years of work");
  EXPECT_EQ(dvi("run drive -o mine --quiet").code, 3);
  EXPECT_EQ(read_file(folder / "mine/thesis.tex"), "years of work");
}

TEST_F(Run, ItsOptionsFileRepeatsIt) {
  small_drive();
  ASSERT_EQ(dvi("run drive -o out --quiet --set regularize.window=3 --frames 1:4").code, 0);
  const Result result = dvi("run --config out/dvi.toml -o again --quiet");
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_TRUE(contents(folder / "out") == contents(folder / "again"));
}

TEST_F(Run, SourceDrivesReduceTheUnobservedShare) {
  small_drive("one", "--truck");
  small_drive("two", "--truck --day 2");
  ASSERT_EQ(dvi("run one -o alone --quiet").code, 0);
  const Result both = dvi("run one two -o both --quiet");
  ASSERT_EQ(both.code, 0) << both.err;
  EXPECT_LT(report("both")["hole"]["share"]["unobserved"], report("alone")["hole"]["share"]["unobserved"]);
  EXPECT_GT(report("both")["hole"]["share"]["copied_elsewhere"], 0);
  EXPECT_EQ(report("both")["drives"].size(), 2);
}

TEST_F(Run, EveryStageCanBeSwitchedOff) {
  small_drive();
  const std::string off =
      "--set stages.align=false --set sample.occlusion_test=false --set stages.regularize=false "
      "--set harmonize.poisson=false --set stages.smooth=false --unobserved leave";
  const Result result = dvi("run drive -o out --quiet " + off);
  ASSERT_EQ(result.code, 0) << result.err;
  const auto share = report()["hole"]["share"];
  EXPECT_EQ(share["interpolated"], 0);
  EXPECT_EQ(share["empty"], share["unobserved"]);
  ASSERT_EQ(dvi("run drive -o paper --method paper --quiet").code, 0);
  for (const auto& frame : report("paper")["frames"]) EXPECT_LE(frame["energy"]["after"], frame["energy"]["before"]);
}

TEST_F(Run, UnobservedPixelsAreSynthesizedInterpolatedOrLeft) {
  small_drive("one", "--truck");
  const auto share = [&](const std::string& how) {
    const Result result = dvi("run one -o " + how + " --quiet --unobserved " + how);
    EXPECT_EQ(result.code, 0) << result.err;
    return report(how)["hole"]["share"];
  };
  const auto synthesized = share("synthesize"), interpolated = share("interpolate"), left = share("leave");
  EXPECT_GT(synthesized["synthesized"], 0.05);
  // Fragments of copies are synthesized, too.
  EXPECT_GE(synthesized["unobserved"], interpolated["unobserved"]);
  EXPECT_NEAR(synthesized["unobserved"].get<double>(), interpolated["unobserved"].get<double>(), 0.05);
  EXPECT_EQ(interpolated["interpolated"], interpolated["unobserved"]);
  EXPECT_EQ(left["empty"], left["unobserved"]);
  EXPECT_EQ(dvi("run one -o no --quiet --unobserved guess").code, 2);
}

TEST_F(Run, EmptyMasksLeaveTheDriveUnchanged) {
  const fs::path drive = small_drive();
  for (const fs::path& mask : list_files(drive / "masks/front", {".png"})) media::write_png(mask, cv::Mat1b(kSize, uchar{0}));
  const Result result = dvi("run drive -o out --quiet");
  ASSERT_EQ(result.code, 0) << result.err;
  for (const fs::path& input : list_files(drive / "images/front", {".png"})) {
    cv::Mat difference;
    cv::absdiff(media::read_image(input, kSize), media::read_image(folder / "out/frames" / input.filename(), kSize),
                difference);
    EXPECT_EQ(cv::norm(difference, cv::NORM_INF), 0);
  }
}

}  // namespace
}  // namespace dvi
