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

  // The script finds the program by its name.
  const std::string path = "PATH=" + fs::path(DVI_PROGRAM).parent_path().string() + ":$PATH ";

  // What bash offers for these words, the last of which is being typed.
  std::string offered(const std::string& words) const {
    write_file(folder / "ask.bash", "source <(dvi completion bash)\nCOMP_WORDS=(" + words +
                                        ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_dvi\nprintf '%s\\n' \"${COMPREPLY[@]}\"\n");
    return shell(path + "bash ask.bash").out;
  }
};

TEST_F(CompletionTest, BashOffersCommandsOptionsAndFiles) {
  EXPECT_THAT(offered("dvi ''"), AllOf(HasSubstr("run\n"), HasSubstr("export\n"), Not(HasSubstr("--"))));
  EXPECT_EQ(offered("dvi exp"), "export\n");
  EXPECT_EQ(offered("dvi run drive.txt --fra"), "--frames\n");
  EXPECT_EQ(offered("dvi config du"), "dump\n");
  EXPECT_EQ(offered("dvi run dri"), "\n") << "bash then offers files";
}

TEST_F(CompletionTest, ScriptsAreValidInTheirShells) {
  for (const std::string name : {"zsh", "fish"}) {
    write_file(folder / "script", dvi("completion " + name).out);
    if (!has(name)) continue;
    const Result result = shell(name + " -n script");
    EXPECT_EQ(result.code, 0) << result.err;
  }
  if (has("fish")) {
    EXPECT_THAT(shell(path + "fish -c 'source script; complete -C \"dvi run --fra\"'").out, HasSubstr("--frames"));
  }
  EXPECT_EQ(dvi("completion tcsh").code, 2);
}

}  // namespace
}  // namespace dvi
