#include <algorithm>
#include <functional>

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "dvi/core/hash.h"
#include "dvi/media/image_file.h"
#include "dvi/media/write_image.h"
#include "program.h"

namespace dvi {
namespace {

using testing::AllOf, testing::HasSubstr;

struct FrameBefore {
  cv::Mat3b color;
  cv::Mat1b kind;
};

/// A result with unobserved pixels behind a truck, and the frames of another program, which fills them with a flat color.
class ImportFillCommand : public ProgramTest {
 protected:
  using Json = nlohmann::json;

  ImportFillCommand() {
    small_drive("drive", "--truck", 3);
    EXPECT_EQ(dvi("run drive -o out --quiet").code, 0);
    for (const fs::path& file : list_files(folder / "out/frames", {".png"})) names.push_back(file.stem().string());
    write_fill("fill");
  }

  fs::path picture(const std::string& kind, const std::string& name) const { return folder / "out" / kind / (name + ".png"); }
  cv::Mat3b frame(const std::string& name) const { return media::read_image(picture("frames", name), kSize); }
  cv::Mat1b kind(const std::string& name) const { return media::read_png_gray(picture("kind", name), kSize); }

  /// Writes one image per frame of the result: the frame, filled, and passed through `change`; nothing for an empty image.
  void write_fill(
      const std::string& into, const std::function<cv::Mat(const cv::Mat3b&)>& change = [](const cv::Mat3b& i) { return i; },
      const std::function<std::string(std::size_t)>& rename = {}) const {
    make_folder(folder / into);
    for (std::size_t i = 0; i < names.size(); ++i) {
      cv::Mat3b image = frame(names[i]);
      image.setTo(cv::Scalar(90, 120, 150), kind(names[i]) >= 3);
      if (const cv::Mat changed = change(image); !changed.empty())
        media::write_png(folder / into / ((rename ? rename(i) : names[i]) + ".png"), changed);
    }
  }

  std::size_t count_unobserved() const {
    std::size_t count = 0;
    for (const std::string& name : names) count += static_cast<std::size_t>(cv::countNonZero(kind(name) >= 3));
    return count;
  }

  Json read_report() const { return Json::parse(read_file(folder / "out/report.json")); }

  void expect_refused(const std::string& fill, const std::string& message) const {
    const auto before = ::dvi::contents(folder / "out");
    const Result result = dvi("import-fill out " + fill + " --quiet");
    EXPECT_EQ(result.code, 3) << fill;
    EXPECT_THAT(result.err, HasSubstr(message));
    EXPECT_TRUE(before == ::dvi::contents(folder / "out")) << fill << " changed the result";
  }

  std::vector<std::string> names;
};

TEST_F(ImportFillCommand, ChangesOnlyUnobservedPixels) {
  std::map<std::string, std::string> before = contents(folder / "out");
  std::vector<FrameBefore> frames;
  for (const std::string& name : names) frames.push_back({frame(name), kind(name)});
  const std::size_t unobserved = count_unobserved();
  ASSERT_GT(unobserved, 1000U);

  const Result result = dvi("import-fill out fill --json --quiet");
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(Json::parse(result.out)["pixels"], unobserved);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const cv::Mat1b hole(frames[i].kind >= 3), kinds = kind(names[i]);
    EXPECT_EQ(cv::countNonZero((kinds == 6) != hole), 0);
    EXPECT_EQ(cv::countNonZero((kinds != frames[i].kind) & ~hole), 0);
    EXPECT_EQ(cv::norm(frame(names[i]), frames[i].color, cv::NORM_INF, ~hole), 0);
    for (const char* same : {"masks", "provenance", "sources_used", "harmonization", "confidence", "depth"})
      EXPECT_TRUE(before.at(std::string(same) + "/" + names[i] + ".png") == read_file(picture(same, names[i]))) << same;
  }
  const Json report = read_report();
  EXPECT_EQ(report["hole"]["imported"], unobserved);
  EXPECT_EQ(report["hole"]["synthesized"], 0);
  EXPECT_EQ(report["frames"][0]["external"]["xxh3"], compute_file_hash(folder / "fill" / (names[0] + ".png")));
  EXPECT_THAT(read_file(folder / "out/report/index.js"), HasSubstr("\"imported\""));
  EXPECT_NE(before.at("video.mp4"), read_file(folder / "out/video.mp4"));
}

TEST_F(ImportFillCommand, IsRecordedAndAudited) {
  ASSERT_EQ(dvi("import-fill out fill --quiet").code, 0);
  const Result audit = dvi("audit out drive --json --quiet");
  EXPECT_EQ(audit.code, 0) << audit.out << audit.err;
  EXPECT_EQ(Json::parse(audit.out)["imported_pixels"], count_unobserved());
  const Json evaluation = Json::parse(dvi("eval out --truth drive/truth --json --quiet").out);
  EXPECT_GT(evaluation["imported"]["pixels"], 0);

  std::vector<cv::Point> imported;
  cv::findNonZero(kind(names[1]) == 6, imported);
  const std::string at = names[1] + " " + std::to_string(imported[0].x) + " " + std::to_string(imported[0].y);
  const Result text = dvi("inspect out " + at);
  const std::string file = (folder / "fill" / (names[1] + ".png")).string();
  EXPECT_THAT(text.out,
              AllOf(HasSubstr("imported"), HasSubstr("external"), HasSubstr(file), HasSubstr(compute_file_hash(file))));
  EXPECT_EQ(Json::parse(dvi("inspect out " + at + " --json").out)["external"]["file"], file);
}

TEST_F(ImportFillCommand, IsReplacedByTheNextImportAndUndone) {
  const auto before = ::dvi::contents(folder / "out");
  ASSERT_EQ(dvi("import-fill out fill --quiet").code, 0);
  const auto once = ::dvi::contents(folder / "out");
  write_fill("other", [](const cv::Mat3b& image) {
    cv::Mat3b blurred;
    cv::GaussianBlur(image, blurred, {9, 9}, 0);
    return blurred;
  });
  ASSERT_EQ(dvi("import-fill out other --quiet").code, 0);
  EXPECT_FALSE(once == ::dvi::contents(folder / "out"));
  ASSERT_EQ(dvi("import-fill out fill --quiet --threads 1").code, 0);
  EXPECT_TRUE(once == ::dvi::contents(folder / "out"));
  const Result undone = dvi("import-fill out --undo --quiet");
  ASSERT_EQ(undone.code, 0) << undone.err;
  EXPECT_TRUE(before == ::dvi::contents(folder / "out"));
}

TEST_F(ImportFillCommand, TakesNamesOfLamaNumbersAndJpeg) {
  const std::size_t unobserved = count_unobserved();
  const auto pixels = [&](const std::string& fill) {
    const Result result = dvi("import-fill out " + fill + " --json --quiet");
    EXPECT_EQ(result.code, 0) << result.err;
    return Json::parse(result.out)["pixels"].get<std::size_t>();
  };
  const auto as_is = [](const cv::Mat3b& image) { return image; };
  write_fill("lama", as_is, [&](std::size_t i) { return names[i] + "_mask001"; });
  write_fill("numbers", as_is, [](std::size_t i) { return "ComfyUI_" + std::to_string(i + 9) + "_"; });  // 9, 10, 11
  make_folder(folder / "jpeg");
  for (const std::string& name : names)
    media::write_jpeg(folder / "jpeg" / (name + ".jpg"), media::read_image(folder / "fill" / (name + ".png"), kSize), 95);
  ASSERT_EQ(pixels("fill"), unobserved);
  const std::string expected = read_file(picture("frames", names[2]));
  EXPECT_EQ(pixels("lama"), unobserved);
  EXPECT_EQ(read_file(picture("frames", names[2])), expected);
  EXPECT_EQ(pixels("numbers"), unobserved);
  EXPECT_EQ(read_file(picture("frames", names[2])), expected);
  EXPECT_EQ(pixels("jpeg"), unobserved);
}

TEST_F(ImportFillCommand, NeedsNoImageOfAFrameWithoutUnobservedPixels) {
  // A result of masks that remove nothing in the second frame.
  media::write_png(folder / "drive/masks/front" / (names[1] + ".png"), cv::Mat1b(kSize, uchar{0}));
  fs::remove_all(folder / "out");
  ASSERT_EQ(dvi("run drive -o out --set objects.complete=false --quiet").code, 0);
  const Result holes = dvi("export holes out -o holes --layout pairs --json --quiet");
  ASSERT_EQ(holes.code, 0) << holes.err;
  EXPECT_FALSE(fs::exists(folder / "holes/pairs" / (names[1] + ".png")));
  EXPECT_TRUE(fs::exists(folder / "holes/pairs" / (names[0] + "_mask.png")));
  fs::remove(folder / "fill" / (names[1] + ".png"));
  EXPECT_EQ(dvi("import-fill out fill --quiet").code, 0);
  EXPECT_EQ(dvi("audit out drive --quiet").code, 0);
}

TEST_F(ImportFillCommand, RefusesUnsuitableImages) {
  const auto resized = [](const cv::Mat3b& image) {
    cv::Mat half;
    cv::resize(image, half, {}, 0.5, 0.5);
    return half;
  };
  const auto swapped = [](const cv::Mat3b& image) {
    cv::Mat rgb;
    cv::cvtColor(image, rgb, cv::COLOR_BGR2RGB);
    return rgb;
  };
  const auto gray = [](const cv::Mat3b& image) {
    cv::Mat one;
    cv::cvtColor(image, one, cv::COLOR_BGR2GRAY);
    return one;
  };
  const auto transparent = [](const cv::Mat3b& image) {
    cv::Mat four;
    cv::cvtColor(image, four, cv::COLOR_BGR2BGRA);
    return four;
  };
  const auto deep = [](const cv::Mat3b& image) {
    cv::Mat words;
    image.convertTo(words, CV_16U, 257);
    return words;
  };
  const auto flipped = [](const cv::Mat3b& image) {
    cv::Mat turned;
    cv::flip(image, turned, 0);
    return turned;
  };
  write_fill("resized", resized), expect_refused("resized", "is 120x68 pixels instead of 240x136");
  write_fill("swapped", swapped), expect_refused("swapped", "red and blue swapped");
  write_fill("gray", gray), expect_refused("gray", "1 channel of 8 bits instead of 3 of 8");
  write_fill("transparent", transparent), expect_refused("transparent", "4 channels of 8 bits");
  write_fill("deep", deep), expect_refused("deep", "3 channels of 16 bits");
  write_fill("flipped", flipped), expect_refused("flipped", "does not show its frame");
  expect_refused("out/frames", "the frames of the result itself");
  expect_refused("drive/masks", "has no PNG or JPEG images");
  expect_refused("nowhere", "is not a folder");

  write_fill("numbers", [](const cv::Mat3b& image) { return image; }, [](std::size_t i) { return std::to_string(i); });
  fs::remove(folder / "numbers/1.png");
  expect_refused("numbers", "has 2 images, but the result has 3 frames");
  fs::rename(folder / "numbers/0.png", folder / "numbers" / (names[1] + ".png"));
  expect_refused("numbers", "2.png: does not have the name of a frame, but other images have");
  const fs::path second = folder / "fill" / (names[1] + ".png");
  const std::string whole = read_file(second);
  write_file(second, whole.substr(0, whole.size() / 2));
  expect_refused("fill", "is not a complete PNG or JPEG");
  fs::remove(second);
  expect_refused("fill", "has no image of frame " + names[1]);
}

TEST_F(ImportFillCommand, RefusesFoldersThatAreNotAFinishedResult) {
  EXPECT_EQ(dvi("import-fill drive fill").code, 3);
  EXPECT_EQ(dvi("import-fill out").code, 2);
  EXPECT_EQ(dvi("import-fill out fill --undo").code, 2);
  cv::Mat3b changed = frame(names[0]);
  changed(0, 0)[0] ^= 1;
  media::write_png(picture("frames", names[0]), changed);
  expect_refused("fill", "differs from the image that the run wrote");
}

TEST_F(ImportFillCommand, IsKeptByARepeatedRun) {
  ASSERT_EQ(dvi("import-fill out fill --quiet").code, 0);
  const auto imported = contents(folder / "out");
  const Result again = dvi("run drive -o out");
  EXPECT_EQ(again.code, 0);
  EXPECT_THAT(again.err, AllOf(HasSubstr("nothing to do"), HasSubstr("hold the fill of another program")));
  EXPECT_THAT(again.out, HasSubstr("% imported"));
  EXPECT_TRUE(imported == contents(folder / "out"));
  fs::remove(folder / "out/video.mp4");
  ASSERT_EQ(dvi("run drive -o out --quiet").code, 0);
  EXPECT_TRUE(imported.at("video.mp4") == read_file(folder / "out/video.mp4"));
  EXPECT_GT(cv::countNonZero(kind(names[0]) == 6), 0);

  const Result other = dvi("run drive -o out --unobserved interpolate");
  EXPECT_EQ(other.code, 0);
  EXPECT_THAT(other.err, HasSubstr("the fill of another program in 3 of them is replaced"));
  EXPECT_EQ(cv::countNonZero(kind(names[0]) == 6), 0);
  EXPECT_TRUE(list_files(folder / "out/.dvi/before_import/frames", {".png"}).empty());
  EXPECT_FALSE(read_report()["hole"].contains("imported"));
}

TEST_F(ImportFillCommand, CanBeRepeatedAfterAnInterruption) {
  const auto of_run = ::dvi::contents(folder / "out");
  ASSERT_EQ(dvi("import-fill out fill --quiet").code, 0);
  const auto imported = ::dvi::contents(folder / "out");
  // The first frame is imported; of the second, the kinds are written but not the frame and the manifest.
  const auto interrupt = [&] {
    fs::remove_all(folder / "out");
    const std::string kept = ".dvi/before_import/", first = names[0], second = names[1];
    for (const auto& [file, bytes] : of_run) temporary.write("out/" + file, bytes);
    for (const std::string& file :
         {kept + "frames/" + first + ".png", kept + "kind/" + first + ".png", kept + "frames/" + second + ".png",
          kept + "kind/" + second + ".png", "frames/" + first + ".png", "kind/" + first + ".png", "kind/" + second + ".png",
          ".dvi/frames/" + first + ".json"})
      temporary.write("out/" + file, imported.at(file));
    Json manifest = Json::parse(of_run.at(".dvi/result.json"));
    manifest["fingerprint"] = "", manifest.erase("seal");
    manifest["seal"] = compute_hash(manifest.dump());
    write_file(folder / "out/.dvi/result.json", manifest.dump(1) + "\n");
  };
  interrupt();
  ASSERT_EQ(dvi("import-fill out fill --quiet").code, 0);
  EXPECT_TRUE(imported.at("frames/" + names[2] + ".png") == read_file(picture("frames", names[2])));
  EXPECT_TRUE(imported == ::dvi::contents(folder / "out"));
  interrupt();
  ASSERT_EQ(dvi("import-fill out --undo --quiet").code, 0);
  EXPECT_TRUE(of_run == ::dvi::contents(folder / "out"));
  interrupt();
  ASSERT_EQ(dvi("run drive -o out --quiet").code, 0);  // completes a result of both
  EXPECT_TRUE(imported.at("frames/" + names[0] + ".png") == read_file(picture("frames", names[0])));
  EXPECT_TRUE(of_run.at("frames/" + names[1] + ".png") == read_file(picture("frames", names[1])));
  EXPECT_EQ(dvi("audit out drive --quiet").code, 0);
}

TEST_F(ImportFillCommand, FailsTheAuditIfObservedPixelsChange) {
  ASSERT_EQ(dvi("import-fill out fill --quiet").code, 0);
  cv::Mat1b kinds = kind(names[0]);
  std::vector<cv::Point> observed;
  cv::findNonZero(kinds == 0, observed);
  const auto findings = [&] {
    const Result audit = dvi("audit out drive --json --quiet");
    EXPECT_EQ(audit.code, 3);
    return Json::parse(audit.out)["findings"]["imported"]["pixels"].get<int>();
  };
  kinds(observed[0]) = 6;
  media::write_png(picture("kind", names[0]), kinds);
  EXPECT_EQ(findings(), 1);
  kinds(observed[0]) = 0;
  media::write_png(picture("kind", names[0]), kinds);
  EXPECT_EQ(dvi("audit out drive --quiet").code, 0);
  fs::remove(folder / "out/.dvi/frames" / (names[0] + ".json"));  // the record of its file
  EXPECT_EQ(findings(), cv::countNonZero(kinds == 6));
}

TEST_F(ImportFillCommand, HasFramesMasksDepthAndCamerasForOtherPrograms) {
  const Result result = dvi("export holes out -o holes --grow-px 3 --json --quiet");
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(Json::parse(result.out)["counts"]["pixels"], count_unobserved());
  for (const std::string& name : names) {
    const cv::Mat1b hole(kind(name) >= 3), mask = media::read_png_gray(folder / "holes/masks" / (name + ".png"), kSize);
    EXPECT_EQ(cv::countNonZero(hole & ~mask), 0);
    cv::Mat1f distance;
    cv::distanceTransform(~hole, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
    EXPECT_EQ(cv::countNonZero((distance < 2.9F) & ~mask), 0);
    EXPECT_EQ(cv::countNonZero((distance > 3.5F) & mask), 0);
    EXPECT_EQ(read_file(folder / "holes/frames" / (name + ".png")), read_file(picture("frames", name)));
    EXPECT_EQ(read_file(folder / "holes/depth" / (name + ".png")), read_file(picture("depth", name)));
    const Json camera = Json::parse(read_file(folder / "holes/cameras" / (name + ".json")));
    EXPECT_EQ(camera["size"], (std::vector<int>{kSize.width, kSize.height}));
    EXPECT_EQ(camera["world_from_camera"].size(), 4U);
  }
}

TEST_F(ImportFillCommand, ReportsThatThereIsNothingToFill) {
  for (const std::string& name : names)
    media::write_png(folder / "drive/masks/front" / (name + ".png"), cv::Mat1b(kSize, uchar{0}));
  ASSERT_EQ(dvi("run drive -o clean --quiet").code, 0);
  const Result holes = dvi("export holes clean -o holes --quiet");
  EXPECT_EQ(holes.code, 3);
  EXPECT_THAT(holes.err, HasSubstr("has no unobserved pixels"));
  EXPECT_FALSE(fs::exists(folder / "holes"));
  const Result import = dvi("import-fill clean fill --quiet");
  EXPECT_EQ(import.code, 3);
  EXPECT_THAT(import.err, HasSubstr("has no unobserved pixels"));
}

}  // namespace
}  // namespace dvi
