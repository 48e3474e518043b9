#include "dvi/core/options.h"

#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/core/error.h"
#include "dvi/core/test_folder.h"

namespace dvi {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

struct Settings {
  bool enabled = true;
  int window = 5;
  double alpha = 0.1;
  std::string source = "auto";
  std::string note;
  std::vector<std::string> paths;

  void describe(OptionTable& table) {
    table.section("first");
    table.add("enabled", enabled, "Whether.");
    table.add("window", window, {1, 11}, "How wide.");
    table.section("second");
    table.add("alpha", alpha, {-10, 1e6}, "How much.");
    table.add("source", source, {"auto", "labels"}, "From where.");
    table.add("note", note, {}, "Anything.");
    table.add("paths", paths, "Where.");
  }
};

class Options : public testing::Test {
 protected:
  Options() { settings.describe(table); }
  void load(const std::string& toml) {
    write_file(file, toml);
    table.load_toml(file, {"drive"});
  }
  Settings settings;
  OptionTable table;
  const TempFolder temporary;
  const fs::path file = temporary.path / "options.toml";
};

TEST_F(Options, SetTakesEveryType) {
  for (const char* assignment : {"first.enabled=false", "first.window=7", "second.alpha=-2.5e-3", "second.source=labels"})
    table.set(assignment);
  EXPECT_FALSE(settings.enabled);
  EXPECT_EQ(settings.window, 7);
  EXPECT_EQ(settings.alpha, -2.5e-3);
  EXPECT_EQ(settings.source, "labels");
}

TEST_F(Options, StringsNeedNoQuotesAndMayHoldEqualsSigns) {
  table.set("second.note=a = \"b\"");
  EXPECT_EQ(settings.note, "a = \"b\"");
}

TEST_F(Options, WholeNumbersServeAsReals) {
  table.set("second.alpha=3");
  EXPECT_EQ(settings.alpha, 3.0);
  load("[second]\nalpha = 4");
  EXPECT_EQ(settings.alpha, 4.0);
}

TEST_F(Options, DumpReadsBackExactly) {
  settings = {false, 3, 0.1 + 0.2, "labels", "say \"x\" \\ \n\t#", {}};
  const std::string text = table.dump_toml();
  EXPECT_THAT(text,
              AllOf(HasSubstr("[first]"), HasSubstr("# How wide. [1 .. 11]"), HasSubstr("# From where. [auto | labels]")));
  settings = {};
  load(text);
  EXPECT_FALSE(settings.enabled);
  EXPECT_EQ(settings.window, 3);
  EXPECT_EQ(settings.alpha, 0.1 + 0.2);
  EXPECT_EQ(settings.source, "labels");
  EXPECT_EQ(settings.note, "say \"x\" \\ \n\t#");
  EXPECT_EQ(table.dump_toml(), text);
}

TEST_F(Options, ListsOfStrings) {
  table.set("second.paths=one path");
  EXPECT_THAT(settings.paths, ElementsAre("one path"));
  settings.paths = {"a", "b \"c\""};
  const std::string text = table.dump_toml();
  settings.paths.clear();
  load(text);
  EXPECT_THAT(settings.paths, ElementsAre("a", "b \"c\""));
  EXPECT_THROW(load("[second]\npaths = [1]"), UsageError);
  EXPECT_THROW(load("[second]\npaths = \"a\""), UsageError);
}

TEST_F(Options, WholeValuedRealsReadBackAsReals) {
  settings.alpha = 1e6;
  load(table.dump_toml());
  EXPECT_EQ(settings.alpha, 1e6);
}

TEST_F(Options, BadAssignmentsNameTheOptionAndTheReason) {
  const auto message = [this](const char* assignment) -> std::string {
    try {
      table.set(assignment);
    } catch (const UsageError& e) {
      return e.what();
    }
    return "accepted";
  };
  EXPECT_THAT(message("first.window=12"), AllOf(HasSubstr("first.window"), HasSubstr("12 is outside 1 .. 11")));
  EXPECT_THAT(message("first.window=0"), HasSubstr("outside"));
  EXPECT_THAT(message("first.window=2.5"), HasSubstr("whole number"));
  EXPECT_THAT(message("first.window=wide"), HasSubstr("a number is wanted"));
  EXPECT_THAT(message("first.window="), HasSubstr("a number is wanted"));
  EXPECT_THAT(message("first.window=true"), HasSubstr("a number is wanted"));
  EXPECT_THAT(message("first.window=99999999999999999999"), HasSubstr("a number is wanted"));
  EXPECT_THAT(message("first.window=3\nx=4"), HasSubstr("one value is wanted"));
  EXPECT_THAT(message("second.alpha=nan"), HasSubstr("outside"));
  EXPECT_THAT(message("second.alpha=inf"), HasSubstr("outside"));
  EXPECT_THAT(message("first.enabled=1"), HasSubstr("true or false"));
  EXPECT_THAT(message("first.enabled=yes"), HasSubstr("true or false"));
  EXPECT_THAT(message("second.source=moon"), AllOf(HasSubstr("'moon' is none of auto, labels")));
  EXPECT_THAT(message("first.widow=3"), AllOf(HasSubstr("first.widow"), HasSubstr("config dump")));
  EXPECT_THAT(message("first.window"), HasSubstr("section.key=value"));
  EXPECT_EQ(settings.window, 5) << "a refused value must not stay";
  EXPECT_EQ(settings.alpha, 0.1);
}

TEST_F(Options, TomlLeavesForeignTablesAlone) {
  load("[drive]\nversion = 1\n[first]\nwindow = 9\n");
  EXPECT_EQ(settings.window, 9);
}

TEST_F(Options, BadTomlNamesTheFile) {
  const auto loading = [this](const std::string& toml) { return [this, toml] { load(toml); }; };
  EXPECT_THAT(loading("[first]\nwindow = = 3"), ThrowsMessage<UsageError>(HasSubstr(file.string() + ":2")));
  EXPECT_THAT(loading("[first]\nwindow = [3]"), ThrowsMessage<UsageError>(HasSubstr(file.string())));
  EXPECT_THAT(loading("[first]\nwindow = 12"), ThrowsMessage<UsageError>(HasSubstr("first.window")));
  EXPECT_THAT(loading("[first]\nwindow = 12"), ThrowsMessage<UsageError>(HasSubstr(file.string())));
  EXPECT_THAT(loading("[first]\nwidow = 3"), ThrowsMessage<UsageError>(HasSubstr(file.string())));
  EXPECT_THAT(loading("window = 3"), ThrowsMessage<UsageError>(HasSubstr("outside any table")));
  EXPECT_THAT([this] { table.load_toml("/nowhere/x.toml"); }, ThrowsMessage<UsageError>(HasSubstr("/nowhere/x.toml")));
}

}  // namespace
}  // namespace dvi
