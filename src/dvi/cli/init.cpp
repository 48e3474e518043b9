#include <memory>

#include <fmt/format.h>

#include "dvi/cli/command.h"
#include "dvi/core/files.h"
#include "dvi/datasets/draft_config.h"

namespace dvi::cli {

void add_init(Program& program) {
  const auto folder = std::make_shared<std::string>();
  Command command = program.command("init", "A dvi.toml to fill in, for images and scans of your own");
  command.positional("FOLDER", *folder, "The folder with images/CAMERA and lidar/ or depth/");
  command.run([folder] {
    const datasets::DraftConfig draft = datasets::draft_config(*folder);
    const fs::path file = fs::path(*folder) / "dvi.toml";
    write_file(file, draft.text);
    fmt::print("{}\n", file.string());
    for (const std::string& open : draft.open) fmt::print("  {}\n", open);
    fmt::print("Then: dvi check {}\n", *folder);
  });
}

}  // namespace dvi::cli
