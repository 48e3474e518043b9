#include "dvi/core/frame_name.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace dvi {
namespace {

/// Lists the frames in the folder frames/ of one camera.
void list_frames_of(const fs::path& out, const std::string& camera, std::vector<std::string>& frames) {
  for (const fs::path& file : list_files(out / camera / "frames", {".png"}))
    frames.push_back(join_frame_name(camera, file.stem().string()));
}

}  // namespace

std::string join_frame_name(const std::string& camera, const std::string& image) {
  return camera.empty() ? image : camera + "/" + image;
}

std::string camera_of_frame(const std::string& frame) {
  const std::size_t slash = frame.find('/');
  return slash == std::string::npos ? "" : frame.substr(0, slash);
}

std::string image_of_frame(const std::string& frame) {
  const std::size_t slash = frame.find('/');
  return slash == std::string::npos ? frame : frame.substr(slash + 1);
}

std::string picture_file(const std::string& folder, const std::string& frame) {
  return join_frame_name(camera_of_frame(frame), folder + "/" + image_of_frame(frame) + ".png");
}

std::vector<std::string> list_cameras(const std::vector<std::string>& frames) {
  std::vector<std::string> cameras;
  for (const std::string& frame : frames)
    if (const std::string camera = camera_of_frame(frame); std::find(cameras.begin(), cameras.end(), camera) == cameras.end())
      cameras.push_back(camera);
  return cameras;
}

FrameImages::FrameImages(fs::path folder, const std::vector<std::string>& frames) : folder_(std::move(folder)) {
  const std::vector<std::string> cameras = list_cameras(frames);
  if (cameras.size() < 2 || list_files(folder_, {".png"}).empty()) return;
  const auto has_folder = [&](const std::string& camera) { return fs::is_directory(folder_ / camera); };
  if (std::count_if(cameras.begin(), cameras.end(), has_folder) + 1 == static_cast<std::ptrdiff_t>(cameras.size()))
    camera_beside_ = *std::find_if_not(cameras.begin(), cameras.end(), has_folder);
}

fs::path FrameImages::file(const std::string& frame) const {
  const bool is_beside = !camera_beside_.empty() && camera_of_frame(frame) == camera_beside_;
  return folder_ / ((is_beside ? image_of_frame(frame) : frame) + ".png");
}

std::vector<std::string> FrameImages::list() const {
  std::vector<std::string> frames;
  for (const fs::path& file : list_files(folder_, {".png"}))
    frames.push_back(join_frame_name(camera_beside_, file.stem().string()));
  if ((!frames.empty() && camera_beside_.empty()) || !fs::is_directory(folder_)) return frames;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_))
    if (entry.is_directory())
      for (const fs::path& file : list_files(entry.path(), {".png"}))
        frames.push_back(join_frame_name(entry.path().filename().string(), file.stem().string()));
  std::sort(frames.begin(), frames.end());
  return frames;
}

std::vector<std::string> list_frames(const fs::path& out) {
  std::vector<std::string> frames, cameras;
  list_frames_of(out, "", frames);
  if (!frames.empty() || !fs::is_directory(out)) return frames;
  for (const fs::directory_entry& entry : fs::directory_iterator(out))
    if (entry.is_directory() && fs::is_directory(entry.path() / "frames")) cameras.push_back(entry.path().filename().string());
  std::sort(cameras.begin(), cameras.end());
  for (const std::string& camera : cameras) list_frames_of(out, camera, frames);
  return frames;
}

}  // namespace dvi
