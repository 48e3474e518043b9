#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "program.h"

namespace dvi {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class CompletionTest : public ProgramTest {
 protected:
  bool has(const std::string& shell_name) const { return shell("command -v " + shell_name).code == 0; }

  /// Returns the completions that bash offers for the last of these words.
  std::string complete(const std::string& words) const {
    write_file(folder / "ask.bash", "source <(" DVI_PROGRAM " completion bash)\nCOMP_WORDS=(" + words +
                                        ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_dvi\nprintf '%s\\n' \"${COMPREPLY[@]}\"\n");
    return shell("bash ask.bash").out;
  }
};

TEST_F(CompletionTest, BashOffersCommandsOptionsAndFiles) {
  write_file(folder / "drive.txt", "");
  EXPECT_THAT(complete("dvi ''"), AllOf(HasSubstr("run\n"), HasSubstr("export\n"), Not(HasSubstr("drive.txt"))));
  EXPECT_EQ(complete("dvi exp"), "export\n");
  EXPECT_EQ(complete("dvi run drive.txt --fra"), "--frames\n");
  EXPECT_EQ(complete("dvi config du"), "dump\n");
  EXPECT_THAT(complete("dvi run dri"), HasSubstr("drive.txt\n"));
}

TEST_F(CompletionTest, ScriptsAreValidInTheirShells) {
  for (const std::string name : {"zsh", "fish"}) {
    write_file(folder / "script", dvi("completion " + name).out);
    if (!has(name)) continue;
    const Result result = shell(name + " -n script");
    EXPECT_EQ(result.code, 0) << result.err;
  }
  if (has("fish")) {
    EXPECT_THAT(shell("fish -c 'source script; complete -C \"dvi run --fra\"'").out, HasSubstr("--frames"));
  }
  EXPECT_EQ(dvi("completion tcsh").code, 2);
}

}  // namespace
}  // namespace dvi
