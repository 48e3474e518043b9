#include "dvi/result/result_layout.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/frame_name.h"

namespace dvi::result {

const std::vector<std::string>& picture_folders() {
  static const std::vector<std::string> folders{"frames",       "masks",         "kind",       "provenance",
                                                "sources_used", "harmonization", "confidence", "depth"};
  return folders;
}

void require_camera_names(const fs::path& out, const std::vector<std::string>& cameras) {
  for (const std::string& camera : cameras) {
    const std::vector<std::string>& pictures = picture_folders();
    const bool is_used = camera == "map" || camera == "report" || camera.starts_with(".") ||
                         std::find(pictures.begin(), pictures.end(), camera) != pictures.end();
    if (is_used || camera.find('/') != std::string::npos)
      throw InputError(out, fmt::format("cannot have a folder for camera '{}' beside its other folders", camera),
                       "clean this camera in a run of its own: --camera " + camera);
  }
}

std::vector<std::string> list_pictures(const std::string& name) {
  std::vector<std::string> files;
  for (const std::string& folder : picture_folders()) files.push_back(picture_file(folder, name));
  return files;
}

std::vector<fs::path> list_own_folders(const fs::path& out, const std::vector<std::string>& cameras) {
  std::vector<fs::path> folders{out, out / ".dvi", out / ".dvi/frames", out / ".dvi/masks", out / ".dvi/report"};
  std::vector<fs::path> optional{out / "map",          out / "report",         out / "report/before",
                                 out / "report/truth", out / "report/sources", out / ".dvi/video"};
  for (const std::string& camera : cameras) {
    if (!camera.empty())
      for (const fs::path& folder : {out, out / ".dvi/frames", out / ".dvi/report"}) folders.push_back(folder / camera);
    for (const std::string& folder : picture_folders()) folders.push_back(out / camera / folder);
    if (!camera.empty()) optional.push_back(out / ".dvi/video" / camera);
    for (const char* folder : {"frames", "kind"}) optional.push_back(out / ".dvi/before_import" / camera / folder);
  }
  for (const fs::path& folder : optional)
    if (fs::exists(folder)) folders.push_back(folder);
  return folders;
}

std::vector<std::string> list_begun_frames(const fs::path& out) {
  std::vector<std::string> frames;
  const auto list = [&](const std::string& camera) {
    for (const fs::path& manifest : list_files(out / ".dvi/frames" / camera, {".json"}))
      frames.push_back(join_frame_name(camera, manifest.stem().string()));
  };
  list("");
  if (!fs::is_directory(out / ".dvi/frames")) return frames;
  std::set<std::string> cameras;
  for (const fs::directory_entry& entry : fs::directory_iterator(out / ".dvi/frames"))
    if (entry.is_directory()) cameras.insert(entry.path().filename().string());
  for (const std::string& camera : cameras) list(camera);
  return frames;
}

std::vector<std::string> list_other_files(const fs::path& out, const std::vector<std::string>& cameras) {
  std::vector<std::string> files{"sources.json", "objects.json", "objects.csv",    "map/poses.txt", "map/times.txt",
                                 "map/map.json", "map/map.ply",  "map/moving.ply", "map/map.png",   "map/above.json"};
  for (const std::string& camera : cameras)
    for (const char* file : {"video.mp4", "compare.mp4", "contact.png"}) files.push_back(join_frame_name(camera, file));
  for (const std::string& camera : cameras)
    if (!camera.empty())
      for (const char* file : {"poses.txt", "times.txt"}) files.push_back("map/" + camera + "/" + file);
  std::erase_if(files, [&](const std::string& file) { return !fs::exists(out / file); });
  return files;
}

fs::path frame_manifest(const fs::path& out, const std::string& name) { return out / ".dvi/frames" / (name + ".json"); }

fs::path result_manifest(const fs::path& out) { return out / ".dvi/result.json"; }

std::string file_before_import(const std::string& picture) { return ".dvi/before_import/" + picture; }

}  // namespace dvi::result
