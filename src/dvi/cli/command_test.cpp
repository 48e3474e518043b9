#include "dvi/cli/command.h"

#include <stdexcept>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "dvi/cli/completion.h"
#include "dvi/core/error.h"
#include "dvi/core/interrupt.h"
#include "dvi/core/nearest_word.h"

namespace dvi::cli {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

struct Outcome {
  int code = -1;
  std::string out, err;
};

Outcome call(Program& program, std::vector<std::string> words) {
  words.insert(words.begin(), "dvi");
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int code = program.main(static_cast<int>(arguments.size()), arguments.data());
  return {code, testing::internal::GetCapturedStdout(), testing::internal::GetCapturedStderr()};
}

// A program whose one command "work" does this.
Outcome run(const std::function<void()>& action) {
  Program program;
  program.command("work", "For tests").run(action);
  return call(program, {"work"});
}

TEST(Program, ExitCodesTellWhoseFaultItIs) {
  EXPECT_EQ(run([] {}).code, 0);
  EXPECT_EQ(run([] { throw std::logic_error("index"); }).code, 1);
  EXPECT_EQ(run([] { throw UsageError("--frames"); }).code, 2);
  EXPECT_EQ(run([] { throw InputError("a.png", "is no image"); }).code, 3);
  EXPECT_EQ(run([] { throw Interrupted(); }).code, 130);
}

TEST(Program, EachFailureIsOneMessageOnStderr) {
  EXPECT_THAT(run([] { throw std::logic_error("index"); }).err, AllOf(StartsWith("dvi: index\n"), HasSubstr("please report")));
  EXPECT_EQ(run([] { throw InputError("a.png", "is not an image", "replace it"); }).err.find("dvi: a.png: is not an image"), 0);
  EXPECT_EQ(run([] { throw Interrupted(); }).err, "dvi: interrupted; nothing is kept, the same command starts again\n");
  EXPECT_THAT(run([] { throw UsageError("--frames"); }).out, IsEmpty());
}

TEST(Program, TooLittleMemoryIsNotABug) {
  for (const std::function<void()>& action : {std::function<void()>([] { throw std::bad_alloc(); }), std::function<void()>([] {
                                                CV_Error(cv::Error::StsNoMem, "Failed to allocate");
                                              })}) {
    const Outcome outcome = run(action);
    EXPECT_EQ(outcome.code, 3);
    EXPECT_THAT(outcome.err, StartsWith("dvi: there is not enough memory; use fewer threads"));
  }
  EXPECT_EQ(run([] { CV_Error(cv::Error::StsBadArg, "size"); }).code, 1);
}

TEST(Program, AnInterruptedCommandSaysWhatIsKept) {
  Program program;
  program.command("work", "For tests").run([] { throw Interrupted(); }, [] { return "3 frames are kept"; });
  const Outcome outcome = call(program, {"work"});
  EXPECT_EQ(outcome.code, 130);
  EXPECT_EQ(outcome.err, "dvi: interrupted; 3 frames are kept\n");
}

TEST(Program, WrongCommandLinesPointToTheHelp) {
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{{}, {"fly"}, {"work", "--fast"}}) {
    Program program;
    bool worked = false;
    program.command("work", "For tests").run([&] { worked = true; });
    const Outcome outcome = call(program, words);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, AllOf(StartsWith("dvi: "), HasSubstr("--help")));
    EXPECT_FALSE(worked);
  }
  Program program;
  program.command("work", "Does what tests want");
  const Outcome help = call(program, {"--help"});
  EXPECT_EQ(help.code, 0);
  EXPECT_THAT(help.out, HasSubstr("Does what tests want"));
}

// A program with commands "run" (option --frames, required -o) and "config dump".
Outcome call_typed(const std::vector<std::string>& words) {
  Program program;
  std::string out, frames;
  Command run = program.command("run", "Does the work");
  run.option("--frames", frames, "");
  run.option("-o,--out", out, "", true);
  program.command("config", "The options").subcommand("dump", "Prints them").run([] {});
  return call(program, words);
}

TEST(Program, TypingErrorsAreAnsweredWithWhatWasMeant) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"rnu"}, "dvi: there is no command 'rnu'; did you mean run?\n"},
      {{"rnu", "drive", "-o", "x"}, "dvi: there is no command 'rnu'; did you mean run?\n"},
      {{"config", "dmup"}, "dvi: there is no command 'config dmup'; did you mean config dump?\n"},
      {{"fly"}, "dvi: there is no command 'fly'\n"},
      {{"run", "--frmes", "3"}, "dvi: run has no option --frmes; did you mean --frames?\n"},
      {{"run", "--frmes=3"}, "dvi: run has no option --frmes; did you mean --frames?\n"},
      {{"run", "-o", "x", "--color"}, "dvi: run has no option --color\n"},
      {{"--frames", "run"}, "dvi: dvi without a command has no option --frames\n"}};
  for (const auto& [words, message] : cases) {
    const Outcome outcome = call_typed(words);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, AllOf(StartsWith(message), HasSubstr("--help")));
    EXPECT_THAT(outcome.out, IsEmpty());
  }
}

TEST(Program, HelpGroupsCommandsAndEndsInExamples) {
  Program program;
  program.group("Clean");
  Command run = program.command("run", "Does the work");
  run.examples({"dvi run DRIVE", "dvi run OTHER"});
  program.group("Look");
  program.command("check", "Looks");
  EXPECT_THAT(call(program, {"--help"}).out, testing::ContainsRegex("Clean:\n +run .*\n\nLook:\n +check "));
  EXPECT_THAT(call(program, {"run", "--help"}).out, HasSubstr("Examples:\n  dvi run DRIVE\n  dvi run OTHER"));
  EXPECT_THAT(call(program, {"check", "--help"}).out, testing::Not(HasSubstr("Examples"))) << "of other commands";
}

TEST(Program, CompletionOffersWhatMayFollow) {
  Program program;
  int number = 0;
  bool flag = false;
  Command run = program.command("run", "Does it: now");
  run.option("-n,--number", number, "A number. Any");
  run.flag("--fast", flag, "Faster");
  program.command("config", "The options").subcommand("dump", "Prints them");
  const auto offered = [&](const std::vector<std::string>& typed) {
    std::vector<std::string> words;
    for (const Word& word : complete(program.words(), typed)) words.push_back(word.text + " " + word.summary);
    return words;
  };
  EXPECT_THAT(offered({""}), ElementsAre("run Does it", "config The options"));
  EXPECT_THAT(offered({"r"}), ElementsAre("run Does it"));
  EXPECT_THAT(offered({"config", ""}), ElementsAre("dump Prints them"));
  EXPECT_THAT(offered({"run", "drive", "--n"}), ElementsAre("--number A number"));
  EXPECT_THAT(offered({"run", "--fast", "--f"}), ElementsAre("--fast Faster"));
  EXPECT_THAT(offered({"run", ""}), IsEmpty());
  EXPECT_THAT(offered({"fly", "--number"}), IsEmpty());
}

TEST(Program, WithoutACommandItsHelpIsShown) {
  const Outcome bare = call_typed({}), config = call_typed({"config"});
  EXPECT_EQ(bare.code, 2);
  EXPECT_EQ(config.code, 2);
  EXPECT_THAT(bare.err, AllOf(StartsWith("dvi: a command is missing: dvi COMMAND\n"), HasSubstr("Does the work")));
  EXPECT_THAT(config.err, AllOf(StartsWith("dvi: a command is missing: dvi config COMMAND\n"), HasSubstr("Prints them")));
}

TEST(Nearest, IsTheWordWithTheFewestTypingErrors) {
  const std::vector<std::string> words = {"run", "map", "eval", "forecast", "formats"};
  EXPECT_EQ(nearest_word("rnu", words), "run");
  EXPECT_EQ(nearest_word("mapp", words), "map");
  EXPECT_EQ(nearest_word("forcast", words), "forecast");
  EXPECT_EQ(nearest_word("format", words), "formats");
  EXPECT_EQ(nearest_word("evl", words), "eval");
  EXPECT_EQ(nearest_word("xyz", words), "");
  EXPECT_EQ(nearest_word("", words), "");
  EXPECT_EQ(nearest_word("run", {}), "");
}

TEST(Command, FillsItsFieldsAndLeavesTheOthers) {
  Program program;
  Command command = program.command("work", "For tests");
  std::string drive, camera = "front", out;
  std::string frames, masks;
  std::vector<std::string> sources, set;
  int threads = 7;
  bool quiet = false, json = false;
  command.positional("DRIVE", drive, "");
  command.positional("SOURCE", sources, "");
  command.option("-o,--out", out, "", true);
  command.option("--camera", camera, "");
  command.option("--frames", frames, "");
  command.option("--masks", masks, "");
  command.option("--set", set, "");
  command.option("--threads", threads, "");
  command.flag("--quiet", quiet, "");
  command.flag("--json", json, "");
  command.run([] {});
  const Outcome outcome =
      call(program, {"work", "a", "b", "c", "-o", "x", "--set", "k=1", "--frames=3:4", "--set", "l=2", "--quiet"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(drive, "a");
  EXPECT_THAT(sources, ElementsAre("b", "c"));
  EXPECT_EQ(out, "x");
  EXPECT_EQ(frames, "3:4");
  EXPECT_EQ(masks, "");
  EXPECT_THAT(set, ElementsAre("k=1", "l=2"));
  EXPECT_EQ(camera, "front");
  EXPECT_EQ(threads, 7);
  EXPECT_TRUE(quiet);
  EXPECT_FALSE(json);
}

TEST(Command, NumbersAndArgumentsAreChecked) {
  const auto error = [](const std::vector<std::string>& words) {
    Program program;
    std::string drive;
    int threads = 0;
    Command command = program.command("work", "For tests");
    command.positional("DRIVE", drive, "");
    command.option("--threads", threads, "", 0);
    command.run([] {});
    const Outcome outcome = call(program, words);
    EXPECT_EQ(outcome.code, words.size() > 2 ? 2 : 0);
    return outcome.err;
  };
  EXPECT_EQ(error({"work", "a"}), "");
  EXPECT_THAT(error({"work", "a", "--threads", "two"}), HasSubstr("--threads: 'two' is not a whole number"));
  EXPECT_THAT(error({"work", "a", "--threads", "-5"}), HasSubstr("--threads: -5 is less than 0"));
  EXPECT_THAT(error({"work", "a", "b"}), HasSubstr("work: 'b' is one argument too many"));
}

TEST(Command, RequiredOptionsAreAskedFor) {
  Program program;
  Command command = program.command("work", "For tests");
  std::string out;
  int threads = 0;
  command.option("-o,--out", out, "", true);
  command.option("--threads", threads, "");
  EXPECT_THAT(call(program, {"work"}).err, HasSubstr("--out"));
  EXPECT_EQ(call(program, {"work", "-o", "x", "--threads", "many"}).code, 2);
}

TEST(Command, OptionsOfATableWithAFlagAreItsOwn) {
  int frames = 5;
  double drift = 0.5;
  bool rain = false;
  std::vector<std::string> topics;
  std::string name = "front", config;
  OptionTable table;
  table.section("street");
  table.add("hidden", name, {}, "Without a flag.");
  table.flags(true);
  table.add("frames", frames, {1, 100}, "How many.");
  table.add("exposure_drift", drift, {0, 1}, "Of the camera.");
  table.add("rain", rain, "Whether.");
  table.add("topics", topics, "Which.").flag = "--topic";
  table.add("name", name, {}, "Whose.");
  Program program;
  std::vector<Assignment> given, few;
  Command command = program.command("work", "For tests");
  command.options(table, given);
  command.option_file(config, given);
  command.run([&] {
    for (const Assignment& assignment : given) table.assign(assignment);
  });
  program.command("part", "For tests").options(table, few, {"street.frames"});
  EXPECT_EQ(call(program, {"work", "--frames", "8", "--exposure-drift", "0.25", "--rain", "--topic", "a", "--topic=b"}).code,
            0);
  EXPECT_EQ(frames, 8);
  EXPECT_EQ(drift, 0.25);
  EXPECT_TRUE(rain);
  EXPECT_THAT(topics, ElementsAre("a", "b"));
  EXPECT_EQ(call(program, {"work", "--set", "street.frames=9", "--config", "a.toml"}).code, 0);
  EXPECT_EQ(frames, 9);
  EXPECT_EQ(config, "a.toml");
  EXPECT_EQ(call(program, {"work", "--frames", "1000"}).code, 2) << "out of range";
  EXPECT_EQ(call(program, {"work", "--set", "x"}).err, "dvi: --set x: must be section.key=value\n");
  EXPECT_EQ(call(program, {"work", "--hidden", "x"}).code, 2);
  EXPECT_EQ(call(program, {"part", "--rain"}).code, 2);
  EXPECT_THAT(call(program, {"work", "--help"}).out, testing::ContainsRegex("--name TEXT.*front.* Whose."));
}

TEST(Common, StyleOfProgress) {
  Common common;
  EXPECT_EQ(common.style(), ProgressStyle::automatic);
  common.json_log = true;
  EXPECT_EQ(common.style(), ProgressStyle::json);
  common.quiet = true;
  EXPECT_EQ(common.style(), ProgressStyle::quiet);
}

}  // namespace
}  // namespace dvi::cli
