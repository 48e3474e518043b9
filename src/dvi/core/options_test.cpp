#include "dvi/core/options.h"

#include <array>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/core/error.h"
#include "dvi/testing/temp_folder.h"

namespace dvi {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StrEq;
using testing::ThrowsMessage;

enum class Color { red, green };
constexpr auto names_of(Color) { return std::array{std::pair{Color::red, "red"}, std::pair{Color::green, "green"}}; }

struct Percent {
  int value = 0;
  static Percent parse(const std::string& text) {
    if (text.empty() || text.back() != '%') throw std::invalid_argument("must end in %");
    return {std::stoi(text)};
  }
};
std::string to_string(const Percent& p) { return std::to_string(p.value) + "%"; }

struct Settings {
  bool enabled = true;
  int window = 5;
  double alpha = 0.1;
  std::string source = "auto";
  std::string note;
  std::vector<std::string> paths;
  int side = 3;
  double low = 2, twin = 2;
  std::optional<double> near, near_twin;
  Color color = Color::red;
  Percent share = {};

  void describe(OptionTable& table) {
    table.section("first");
    table.add("enabled", enabled, "Whether.");
    table.add("window", window, {1, 11}, "How wide.");
    table.section("second");
    table.add("alpha", alpha, {-10, 1e6}, "How much.");
    table.add("source", source, {"auto", "labels"}, "From where.");
    table.add("note", note, {}, "Anything.");
    table.add("paths", paths, "Where.");
    table.section("third");
    table.developer();
    table.add_one_of("side", side, {0, 3, 5}, "How large.");
    table.add("low", {&low, &twin}, {0, 20}, "From where on.");
    table.add_automatic("near", {&near, &near_twin}, {0, 20}, "How near.");
    table.add("color", color, "Which.");
    table.add("share", share, "What part.");
    table.section("first");
    table.add("late", late, {0, 9}, "Of the first section.");
  }
  void check() const { check_ranges(*this); }
  int late = 1;
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

TEST_F(Options, SetAcceptsAllTypes) {
  for (const char* assignment : {"first.enabled=false", "first.window=7", "second.alpha=-2.5e-3", "second.source=labels"})
    table.set(assignment);
  EXPECT_FALSE(settings.enabled);
  EXPECT_EQ(settings.window, 7);
  EXPECT_EQ(settings.alpha, -2.5e-3);
  EXPECT_EQ(settings.source, "labels");
}

TEST_F(Options, StringsNeedNoQuotesAndMayContainEqualsSigns) {
  table.set("second.note=a = \"b\"");
  EXPECT_EQ(settings.note, "a = \"b\"");
}

TEST_F(Options, RealsMayBeWholeNumbers) {
  table.set("second.alpha=3");
  EXPECT_EQ(settings.alpha, 3.0);
  load("[second]\nalpha = 4");
  EXPECT_EQ(settings.alpha, 4.0);
}

TEST_F(Options, AreReadBackExactlyFromTheDump) {
  settings.enabled = false, settings.window = 3, settings.alpha = 0.1 + 0.2, settings.source = "labels";
  settings.note = "say \"x\" \\ \n\t#";
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

TEST_F(Options, NumbersMayBeAutomatic) {
  EXPECT_THAT(table.dump_toml(), HasSubstr("# How near. [auto | 0 .. 20]\nnear = 'auto'\n"));
  table.set("third.near=0.5");
  EXPECT_EQ(settings.near, 0.5);
  EXPECT_EQ(settings.near_twin, 0.5);
  table.set("third.near=auto");
  EXPECT_FALSE(settings.near || settings.near_twin);
  load("[third]\nnear = 0");
  EXPECT_EQ(settings.near, 0);
  load("[third]\nnear = \"auto\"");
  EXPECT_FALSE(settings.near);
  EXPECT_THROW(table.set("third.near=21"), UsageError);
  EXPECT_THROW(table.set("third.near=none"), UsageError);
  EXPECT_THROW(load("[third]\nnear = \"none\""), UsageError);
}

TEST_F(Options, MayBeListsOfStrings) {
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

// File names can hold any byte, but TOML requires UTF-8.
TEST_F(Options, StringsThatAreNotUtf8AreReadBackExactly) {
  const std::string latin =
                        "/tmp/Stra\xDF"
                        "e 100%",
                    plain =
                        "/tmp/Stra\xC3\x9F"
                        "e 100%20";
  settings.note = latin, settings.paths = {latin, plain};
  const std::string text = table.dump_toml();
  EXPECT_THAT(text, AllOf(HasSubstr("file:/tmp/Stra%DFe%20100%25"), HasSubstr(plain), Not(HasSubstr("\xDF"))));
  settings = {};
  load(text);
  EXPECT_EQ(settings.note, latin);
  EXPECT_THAT(settings.paths, ElementsAre(latin, plain));
  load("[second]\nnote = \"file:///tmp/a%20b%\"");
  EXPECT_EQ(settings.note, "/tmp/a b%");
}

TEST_F(Options, ListsAreGivenAsOneItemOrAsToml) {
  table.set("second.paths=[\"a\", 'b']");
  EXPECT_THAT(settings.paths, ElementsAre("a", "b"));
  table.assign({"second.paths", std::vector<std::string>{"[c", "d"}});
  EXPECT_THAT(settings.paths, ElementsAre("[c", "d"));
  EXPECT_THAT([this] { table.set("second.paths=[1]"); }, ThrowsMessage<UsageError>(HasSubstr("must be a list of strings")));
  EXPECT_THAT([this] { table.set("second.paths=[a"); }, ThrowsMessage<UsageError>(HasSubstr("must be a list of strings")));
  EXPECT_THAT([this] { table.set("first.window=[3]"); }, ThrowsMessage<UsageError>(HasSubstr("must be a number")));
}

TEST_F(Options, ShortFormsAreFlagsAndKeywords) {
  table.flags(true);
  int frame_gap = 3;
  table.add("frame_gap", frame_gap, {1, 9}, "How far.");
  std::vector<std::string> topics;
  table.add("topics", topics, "Which.").flag = "--topic";
  table.flags(false);
  bool last = false;
  table.add("last", last, "Whether.");
  EXPECT_EQ(table.find("--frame-gap").name(), "first.frame_gap");
  EXPECT_EQ(table.find_keyword("topics").flag, "--topic");
  table.assign({"--frame-gap", "4"});
  EXPECT_EQ(frame_gap, 4);
  EXPECT_THAT([this] { table.assign({"--frame-gap", "10"}); },
              ThrowsMessage<UsageError>(StrEq("--frame-gap 10: must be within 1 .. 9")));
  EXPECT_THAT([this] { table.find_keyword("frame_gab"); },
              ThrowsMessage<UsageError>(StrEq("there is no option 'frame_gab' (did you mean 'frame_gap'?)")));
  EXPECT_THAT([this] { table.find_keyword("confg", {"config"}); },
              ThrowsMessage<UsageError>(HasSubstr("did you mean 'config'?")));
  EXPECT_THROW(table.find_keyword("last"), UsageError) << "it has no short form";
  EXPECT_THROW(table.find(""), UsageError);
}

TEST_F(Options, MarkdownHasARowPerOption) {
  const std::string text = table.dump_markdown([](const Option& option) { return option.key == "source"; });
  EXPECT_THAT(text, testing::EndsWith("|\n| `second.source` |  | `auto` | From where. [auto \\| labels] |\n"));
}

TEST_F(Options, WholeValuedRealsReadBackAsReals) {
  settings.alpha = 1e6;
  load(table.dump_toml());
  EXPECT_EQ(settings.alpha, 1e6);
}

TEST_F(Options, DecimalsMayBeginOrEndWithAPoint) {
  for (const auto& [text, value] : {std::pair(".5", 0.5), {"-.25", -0.25}, {"2.", 2.0}, {"+1.5", 1.5}}) {
    table.set(std::string("second.alpha=") + text);
    EXPECT_EQ(settings.alpha, value) << text;
  }
  for (const char* text : {".", "-.", "1.5.2", ".5x", "0x.8"})
    EXPECT_THROW(table.set(std::string("second.alpha=") + text), UsageError) << text;
}

TEST_F(Options, InvalidAssignmentsReportOptionAndReason) {
  const auto message = [this](const char* assignment) -> std::string {
    try {
      table.set(assignment);
    } catch (const UsageError& e) {
      return e.what();
    }
    return "accepted";
  };
  EXPECT_THAT(message("first.window=12"),
              AllOf(HasSubstr("first.window"), HasSubstr("option first.window = 12: must be within 1 .. 11")));
  EXPECT_THAT(message("first.window=0"), HasSubstr("within"));
  EXPECT_THAT(message("first.window=2.5"), HasSubstr("whole number"));
  EXPECT_THAT(message("first.window=wide"), HasSubstr("must be a number"));
  EXPECT_THAT(message("first.window="), HasSubstr("must be a number"));
  EXPECT_THAT(message("first.window=true"), HasSubstr("must be a number"));
  EXPECT_THAT(message("first.window=99999999999999999999"), HasSubstr("must be a number"));
  EXPECT_THAT(message("first.window=3\nx=4"), HasSubstr("must be one value"));
  EXPECT_THAT(message("second.alpha=nan"), HasSubstr("within"));
  EXPECT_THAT(message("second.alpha=inf"), HasSubstr("within"));
  EXPECT_THAT(message("first.enabled=1"), HasSubstr("true or false"));
  EXPECT_THAT(message("first.enabled=yes"), HasSubstr("true or false"));
  EXPECT_THAT(message("second.source=moon"), HasSubstr("second.source = 'moon': must be one of auto, labels"));
  EXPECT_THAT(message("first.widow=3"), AllOf(HasSubstr("first.widow"), HasSubstr("config dump --all")));
  EXPECT_THAT(message("first.window"), HasSubstr("section.key=value"));
  EXPECT_THAT(message("third.side=4"), HasSubstr("option third.side = 4: must be one of 0, 3, 5"));
  EXPECT_THAT(message("third.color=blue"), HasSubstr("option third.color = 'blue': must be one of red, green"));
  EXPECT_THAT(message("third.share=9"), HasSubstr("option third.share = '9': must end in %"));
  EXPECT_EQ(settings.window, 5) << "a refused value is not stored";
  EXPECT_EQ(settings.alpha, 0.1);
}

TEST_F(Options, EnumsAndOtherTypesAreWrittenAsText) {
  for (const char* assignment : {"third.color=green", "third.share=40%", "third.side=0", "third.low=3"}) table.set(assignment);
  EXPECT_EQ(settings.color, Color::green);
  EXPECT_EQ(settings.share.value, 40);
  EXPECT_EQ(settings.side, 0);
  EXPECT_EQ(settings.low, 3);
  EXPECT_EQ(settings.twin, 3) << "one option may be shared by several structs";
  const std::string text = table.dump_toml();
  EXPECT_THAT(text, AllOf(HasSubstr("# Which. [red | green]\ncolor = 'green'"), HasSubstr("share = '40%'")));
  load(text);
  EXPECT_EQ(table.dump_toml(), text);
}

TEST_F(Options, DumpHasTheWantedOptionsInOneTablePerSection) {
  const std::string users = table.dump_toml([](const Option& option) { return option.audience == Audience::user; });
  EXPECT_THAT(users, Not(HasSubstr("[third]")));
  EXPECT_THAT(users, HasSubstr("late"));
  EXPECT_EQ(users.find("[first]"), users.rfind("[first]"));
  EXPECT_THAT(table.dump_toml(), HasSubstr("[third]"));
}

TEST_F(Options, UnknownNamesAreRefusedWithASuggestion) {
  EXPECT_THAT([this] { table.set("first.windw=3"); },
              ThrowsMessage<UsageError>(HasSubstr("there is no option 'first.windw' (did you mean 'first.window'?)")));
  EXPECT_THAT([this] { table.set("zzz.q=3"); },
              ThrowsMessage<UsageError>(StrEq("there is no option 'zzz.q'; `dvi config dump --all` lists all options")));
}

TEST(OptionRanges, AreCheckedForStructsFilledByCode) {
  Settings bad;
  EXPECT_NO_THROW(bad.check());
  bad.side = 4;
  EXPECT_THAT([&] { bad.check(); }, ThrowsMessage<UsageError>(StrEq("option third.side = 4: must be one of 0, 3, 5")));
  bad.side = 3, bad.twin = 30;
  EXPECT_NO_THROW(bad.check());
  bad.low = 30;
  EXPECT_THAT([&] { bad.check(); }, ThrowsMessage<UsageError>(StrEq("option third.low = 30.0: must be within 0 .. 20")));
}

TEST_F(Options, TomlMayHaveOtherTables) {
  load("[drive]\nversion = 1\n[first]\nwindow = 9\n");
  EXPECT_EQ(settings.window, 9);
}

TEST_F(Options, InvalidTomlIsReportedWithTheFile) {
  const auto loading = [this](const std::string& toml) { return [this, toml] { load(toml); }; };
  EXPECT_THAT(loading("[first]\nwindow = = 3"), ThrowsMessage<UsageError>(HasSubstr(file.string() + ":2")));
  EXPECT_THAT(loading("[first]\nwindow = [3]"), ThrowsMessage<UsageError>(HasSubstr(file.string())));
  EXPECT_THAT(loading("[first]\nwindow = 12"), ThrowsMessage<UsageError>(HasSubstr("first.window")));
  EXPECT_THAT(loading("[first]\nwindow = 12"), ThrowsMessage<UsageError>(HasSubstr(file.string())));
  EXPECT_THAT(loading("[first]\nwidow = 3"), ThrowsMessage<UsageError>(HasSubstr(file.string())));
  EXPECT_THAT(loading("window = 3"), ThrowsMessage<UsageError>(HasSubstr("outside any table")));
  std::string deep = "[first]\na";
  for (int i = 0; i < 200'000; ++i) deep += ".a";
  EXPECT_THAT(loading(deep + " = 1\n"), ThrowsMessage<UsageError>(HasSubstr(file.string() + ":2: the line has")));
  EXPECT_THAT([this] { table.load_toml("/nowhere/x.toml"); }, ThrowsMessage<UsageError>(HasSubstr("/nowhere/x.toml")));
}

}  // namespace
}  // namespace dvi
