#include "dvi/exports/scene_files.h"

#include "dvi/core/error.h"
#include "dvi/core/threads.h"
#include "dvi/media/write_image.h"

namespace dvi::exports {

void copy_picture(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::copy_file(from, to, error);
  if (error) throw InputError(to, "cannot be written from " + from.string() + " (" + error.message() + ")", "free space");
}

void make_folders_of_cameras(const Result& result, const fs::path& folder) {
  make_folder(folder);
  for (const ResultFrame& frame : result.frames()) make_folder(folder / camera_of_frame(frame.name));
}

void write_images_and_masks(const Result& result, const fs::path& folder, const std::string& mask_ending, Progress& progress) {
  make_folders_of_cameras(result, folder / "images");
  make_folders_of_cameras(result, folder / "masks");
  parallel_for(result.frames().size(), [&](std::size_t i) {
    const std::string& name = result.frames()[i].name;
    copy_picture(result.picture("frames", i), folder / "images" / (name + ".png"));
    media::write_png(folder / "masks" / (name + mask_ending), result.evidence(i));
    progress.advance();
  });
}

}  // namespace dvi::exports
