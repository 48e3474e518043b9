#include "dvi/pipeline/result_folder.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "dvi/core/error.h"
#include "dvi/depth/depth_map.h"
#include "dvi/io/write_image.h"

namespace dvi::pipeline {
namespace {

constexpr const char* kSchema = "dvi-result/1";

// KITTI's convention: metres x 256, 0 where there is none.
cv::Mat1w depth_image(const cv::Mat1f& z) {
  cv::Mat1w out(z.size(), ushort{0});
  for (int y = 0; y < z.rows; ++y)
    for (int x = 0; x < z.cols; ++x)
      if (depth::DepthMap::is_surface(z(y, x)) && z(y, x) < depth::DepthMap::kInfinity)
        out(y, x) = cv::saturate_cast<ushort>(z(y, x) * 256);
  return out;
}

}  // namespace

cv::Mat3b to_8bit(const harmonize::FilledFrame& frame) {
  cv::Mat3b out;
  frame.colour.convertTo(out, CV_8U);
  return out;
}

const std::vector<std::string>& ResultFolder::picture_folders() {
  static const std::vector<std::string> folders{"frames",       "masks",         "kind",       "provenance",
                                                "sources_used", "harmonisation", "confidence", "depth"};
  return folders;
}

ResultFolder::ResultFolder(const fs::path& out, const std::string& identity, const std::string& fingerprint, bool force)
    : out_(out), created_(!fs::exists(out)) {
  try {
    claim(identity, fingerprint, force);
  } catch (...) {
    std::error_code ignored;
    if (created_) fs::remove_all(out_, ignored);
    throw;
  }
}

void ResultFolder::claim(const std::string& identity, const std::string& fingerprint, bool force) {
  const fs::path job = out_ / ".dvi/job.json";
  bool same = false;
  if (fs::exists(job)) {
    const nlohmann::json old = nlohmann::json::parse(read_file(job), nullptr, false);
    const bool known = old.is_object() && old.value("schema", "") == kSchema;
    if (!force && (!known || old.value("identity", "") != identity))
      throw InputError(out_, "is the result of another drive", "choose another folder, or --force to replace it");
    same = known && old.value("identity", "") == identity && old.value("fingerprint", "") == fingerprint;
  } else if (fs::exists(out_) && (!fs::is_directory(out_) || !fs::is_empty(out_)) && !force) {
    throw InputError(out_, "exists and is no result of dvi", "choose another folder, or --force to write into it");
  }
  for (const std::string& folder : picture_folders()) make_folder(out_ / folder);
  remove_temporaries(out_);
  if (!same) {
    fs::remove_all(out_ / ".dvi/frames");
    fs::remove(out_ / "report.json");  // it tells of other frames, and marks a result as whole
  }
  make_folder(out_ / ".dvi/frames");
  write_file(job, nlohmann::json{{"schema", kSchema}, {"identity", identity}, {"fingerprint", fingerprint}}.dump(1) + "\n");
}

ResultFolder::~ResultFolder() {
  std::error_code ignored;  // a destructor cannot do more than try
  if (created_ && fs::is_empty(out_ / ".dvi/frames", ignored)) fs::remove_all(out_, ignored);
}

void ResultFolder::write_frame(const std::string& name, const harmonize::FilledFrame& frame,
                               const cv::Mat_<cv::Vec3w>& harmonisation, const std::string& record_json) {
  const std::string png = name + ".png";
  io::write_png(out_ / "masks" / png, frame.mask);
  io::write_png(out_ / "kind" / png, frame.kind);
  io::write_png(out_ / "provenance" / png, frame.provenance);
  io::write_png(out_ / "sources_used" / png, frame.used);
  io::write_png(out_ / "harmonisation" / png, harmonisation);
  io::write_png(out_ / "confidence" / png, frame.confidence);
  io::write_png(out_ / "depth" / png, depth_image(frame.depth));
  io::write_png(out_ / "frames" / png, to_8bit(frame));
  write_file(record(name), record_json);
}

void ResultFolder::remove_others(const std::vector<std::string>& names) {
  const auto is_ours = [&](const fs::path& file) {
    return std::find(names.begin(), names.end(), file.stem().string()) != names.end();
  };
  for (const std::string& folder : picture_folders())
    for (const fs::path& file : list_files(out_ / folder, {".png"}))
      if (!is_ours(file)) fs::remove(file);
  for (const fs::path& file : list_files(out_ / ".dvi/frames", {".json"}))
    if (!is_ours(file)) fs::remove(file);
}

}  // namespace dvi::pipeline
