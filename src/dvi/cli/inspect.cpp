#include "dvi/report/inspect.h"

#include <memory>
#include <string>

#include <fmt/format.h>

#include "dvi/cli/command.h"

namespace dvi::cli {

void add_inspect(Program& program) {
  struct Arguments {
    std::string out, frame, folder;
    int x = 0, y = 0;
    Common common;
  };
  const auto a = std::make_shared<Arguments>();
  Command command = program.command("inspect", "Show the provenance of one pixel: where it comes from");
  command.positional("OUT", a->out, "A result of dvi run");
  command.positional("FRAME", a->frame, "The frame's name, or its number in the drive");
  command.positional("X", a->x, "Column, from 0");
  command.positional("Y", a->y, "Row, from 0");
  command.option("-o,--out", a->folder, "Folder for result.png and source.png, the surroundings of the pixel");
  a->common.add_to(command, true, false);
  command.run([a] {
    const report::PixelRecord record = report::read_pixel_record(a->out, a->frame, {a->x, a->y});
    if (!a->folder.empty()) report::write_crops(a->folder, a->out, record);
    fmt::print("{}\n", a->common.json ? report::to_json(record) : report::to_text(record));
  });
}

}  // namespace dvi::cli
