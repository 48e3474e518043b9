#pragma once

#include <optional>
#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/drive/drive.h"

namespace dvi::datasets {

/// The endings of the image files that are read, in lower case.
extern const std::vector<std::string> kImageEndings;

/// Returns the key that relates the files of several sensors: the NAME itself, or a whole number without leading zeros, so that
/// 0.bin belongs to 000000.png.
std::string to_name_key(const std::string& name);

/// Throws InputError if two of the files have the same NAME, such as 000000.png and 000000.jpg, or the same number, such as
/// 0.png.
void require_one_file_per_name(const std::vector<fs::path>& files);

/// Describes the natural order of names that count frames, if it differs from the lexicographic order ("frame10" before
/// "frame2"). Returns nothing for whole numbers.
std::optional<std::string> describe_order(const std::vector<std::string>& names);

/// Describes the images and videos of a folder that are not read, by their endings: "8 files .tif". Returns nothing if there
/// are none.
std::optional<std::string> describe_unread_images(const fs::path& folder);

/// Adds a warning about images of a drive that are not read because of their endings.
void warn_of_unread_images(Drive& drive, const fs::path& folder);

/// Throws an InputError that states that `folder` holds no images, and which of its files are not read.
[[noreturn]] void fail_without_images(const fs::path& folder, const std::string& problem, const std::string& remedy);

}  // namespace dvi::datasets
