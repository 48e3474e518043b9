#include "dvi/core/options.h"

#include <cmath>

#include "dvi/core/error.h"
#include "parser.h"

namespace {

// A field of each kind.
struct Fields {
  bool flag = false;
  int count = 1, choice = 1;
  double ratio = 0.5, left = 1, right = 1;
  std::string word = "a", text;
  std::vector<std::string> list;

  dvi::OptionTable table() {
    dvi::OptionTable table;
    table.section("a");
    table.add("flag", flag, "A switch.");
    table.add("count", count, {0, 10}, "A number.");
    table.add("ratio", ratio, {0, 1}, "A real number.");
    table.section("b");
    table.add("shared", {&left, &right}, {0, 1}, "A number of two structs.");
    table.add_one_of("choice", choice, {1, 3, 5}, "One of three.");
    table.add("word", word, {"a", "b"}, "One of two words.");
    table.add("text", text, {}, "Any text.");
    table.add("list", list, "Texts.");
    return table;
  }
};

}  // namespace

// Reads options as a file, and each of its lines as an argument of --set. Accepted options are written and read back.
void dvi::fuzz::parse(const fs::path& folder, const std::string& bytes) {
  const fs::path file = put(folder / "dvi.toml", bytes);
  Fields set;
  OptionTable settable = set.table();
  for (const std::string& line : read_lines(file)) try {
      settable.set(line);
    } catch (const UsageError&) {  // answered
    }
  Fields loaded;
  OptionTable table = loaded.table();
  table.load_toml(file, {"ignored"});
  table.check();
  require(std::isfinite(loaded.ratio) && loaded.left == loaded.right, "values are within their ranges");
  Fields again;
  OptionTable written = again.table();
  written.load_toml(put(folder / "written.toml", table.dump_toml()));
  require(written.dump_toml() == table.dump_toml(), "options come back as they were written");
}
