#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "dvi/drive/drive.h"

namespace dvi {

struct ReadOptions {
  std::string camera;                ///< empty: the drive's first
  std::optional<FrameRange> frames;  ///< cut the drive to these (frames, and the sweeps near them in time)
  std::size_t cache_bytes = std::size_t{256} << 20;  ///< bound of decoded images, masks and scans kept together
};

/// One layout of recordings that dvi can read.
struct DriveFormat {
  std::string name;     ///< as `dvi formats` lists it
  std::string summary;  ///< one line: how it is recognised
  std::function<bool(const std::filesystem::path&)> recognise;
  std::function<Drive(const std::filesystem::path&, const ReadOptions&)> read;
};

/// All formats; a new reader is one file and one line here.
const std::vector<DriveFormat>& drive_formats();

/// Opens a drive of whatever format. InputError where the folder is none, or lacks what it needs.
Drive read_drive(const std::filesystem::path& path, const ReadOptions& options = {});

}  // namespace dvi
