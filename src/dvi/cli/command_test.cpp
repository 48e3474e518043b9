#include "dvi/cli/command.h"

#include <stdexcept>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
  EXPECT_EQ(run([] { throw InputError("a.png", "is no image", "replace it"); }).err.find("dvi: a.png: is no image"), 0);
  EXPECT_EQ(run([] { throw Interrupted(); }).err, "dvi: interrupted; nothing is kept, the same command starts again\n");
  EXPECT_THAT(run([] { throw UsageError("--frames"); }).out, IsEmpty());
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
}

TEST(Program, CompletionKnowsItsWords) {
  Program program;
  int number = 0;
  bool flag = false;
  Command run = program.command("run", "Does it: now");
  run.option("-n,--number", number, "A number's doc");
  run.flag("--fast", flag, "Faster");
  const CommandWords words = program.words();
  ASSERT_EQ(words.commands.size(), 1U);
  EXPECT_EQ(words.commands[0].name, "run");
  for (const char* shell : {"bash", "zsh", "fish"}) EXPECT_THAT(completion_script(words, shell), HasSubstr("number"));
  EXPECT_THAT(completion_script(words, "fish"), HasSubstr("-l number -r -d 'A number s doc'\n"));
  EXPECT_THAT(completion_script(words, "fish"), HasSubstr("-l fast -d 'Faster'\n"));
  EXPECT_THROW(completion_script(words, "tcsh"), UsageError);
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
  std::optional<std::string> frames, masks;
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
  EXPECT_FALSE(masks);
  EXPECT_THAT(set, ElementsAre("k=1", "l=2"));
  EXPECT_EQ(camera, "front");
  EXPECT_EQ(threads, 7);
  EXPECT_TRUE(quiet);
  EXPECT_FALSE(json);
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

TEST(Command, TablesBecomeOptionsOfTheirOwn) {
  int frames = 5, seed = 1;
  double drift = 0.5;
  bool rain = false;
  OptionTable table;
  table.section("street");
  table.add("frames", frames, {1, 100}, "How many.");
  table.add("exposure_drift", drift, {0, 1}, "Of the camera.");
  table.add("rain", rain, "Whether.");
  table.add("seed", seed, {0, 100}, "Of the table.");
  Program program;
  Command command = program.command("work", "For tests");
  int own_seed = 0;
  command.option("--seed", own_seed, "");
  command.options(table);
  command.run([] {});
  EXPECT_EQ(call(program, {"work", "--frames", "8", "--exposure-drift", "0.25", "--rain", "--seed", "9"}).code, 0);
  EXPECT_EQ(frames, 8);
  EXPECT_EQ(drift, 0.25);
  EXPECT_TRUE(rain);
  EXPECT_EQ(own_seed, 9) << "what was there by its own name stays";
  EXPECT_EQ(seed, 1);
  EXPECT_EQ(call(program, {"work", "--frames", "1000"}).code, 2) << "out of range";
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
