#include "dvi/core/folder_lock.h"

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/core/error.h"
#include "dvi/testing/temp_folder.h"

namespace dvi {
namespace {

using testing::HasSubstr;

class Lock : public testing::Test {
 protected:
  std::string refusal() const {
    try {
      const FolderLock lock(folder.path, file);
      return "";
    } catch (const InputError& e) {
      return e.what();
    }
  }
  const TempFolder folder;
  const fs::path file = folder.path / "lock";
};

TEST_F(Lock, IsSharedOrHeldAlone) {
  {
    const FolderLock one(folder.path, file, FolderLock::Hold::shared), two(folder.path, file, FolderLock::Hold::shared);
    EXPECT_THAT(refusal(), HasSubstr("is being written by another process"));
  }
  const FolderLock alone(folder.path, file);
  EXPECT_THROW(FolderLock(folder.path, file, FolderLock::Hold::shared), InputError);
}

TEST_F(Lock, ReportsTheProcessThatHoldsIt) {
  {
    const FolderLock lock(folder.path, file);
    EXPECT_THAT(refusal(), HasSubstr("process " + std::to_string(getpid()) + " on "));
    EXPECT_THAT(refusal(), HasSubstr(folder.path.string()));
  }
  EXPECT_EQ(refusal(), "") << "the lock is free again";
  EXPECT_EQ(read_file(file), "") << "the file does not depend on its holders";
}

TEST_F(Lock, IsReleasedWhenItsHolderIsKilled) {
  const pid_t child = fork();
  if (child == 0) {
    const FolderLock lock(folder.path, file);
    raise(SIGKILL);
  }
  ASSERT_EQ(waitpid(child, nullptr, 0), child);
  EXPECT_THAT(read_file(file), HasSubstr(std::to_string(child)));
  EXPECT_EQ(refusal(), "");
}

TEST_F(Lock, ReportsAFolderThatCannotBeWritten) {
  EXPECT_THROW(FolderLock(folder.path, folder.path / "missing/lock"), InputError);
  fs::create_symlink("/etc/hostname", folder.path / "link");
  EXPECT_THROW(FolderLock(folder.path, folder.path / "link"), InputError) << "links out of the folder are not followed";
}

}  // namespace
}  // namespace dvi
