#include "dvi/core/files.h"

#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>
#include <fstream>
#include <functional>
#include <ostream>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/core/error.h"
#include "dvi/testing/temp_folder.h"

namespace dvi {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

class Files : public testing::Test {
 protected:
  std::vector<std::string> names() const {
    std::vector<std::string> out;
    for (const auto& entry : fs::directory_iterator(folder)) out.push_back(entry.path().filename());
    return out;
  }
  const TempFolder temporary;
  const fs::path folder = temporary.path;
};

TEST_F(Files, RemovesTemporaryFilesOfKilledProcesses) {
  make_folder(folder / "deep");
  for (const fs::path& file : {folder / "video.mp4", folder / "deep/a.png"}) {
    write_file(file, "whole");
    std::ofstream(temporary_beside(file)) << "half";
  }
  for (const char* foreign : {".notes.part.txt", ".a.part7b.png", "a.part7.png"}) write_file(folder / foreign, "mine");
  remove_temporaries(folder);
  EXPECT_TRUE(fs::exists(temporary_beside(folder / "deep/a.png"))) << "one folder at a time";
  remove_temporaries(folder / "deep");
  EXPECT_TRUE(fs::exists(folder / "video.mp4") && fs::exists(folder / "deep/a.png"));
  EXPECT_EQ(std::distance(fs::recursive_directory_iterator(folder), {}), 6) << "files of others stay";
}

TEST_F(Files, ReadsBackWrittenFiles) {
  const std::string bytes("a\0b\r\n\xff", 6);
  write_file(folder / "x.bin", bytes);
  EXPECT_EQ(read_file(folder / "x.bin"), bytes);
  write_file(folder / "x.bin", "");
  EXPECT_EQ(read_file(folder / "x.bin"), "");
}

TEST_F(Files, ReadsLinesOfAnyLineEndWithoutAByteOrderMark) {
  for (const char* text : {"a b\nc\n", "a b\r\nc\r\n", "a b\rc\r",
                           "\xEF\xBB\xBF"
                           "a b\r\nc",
                           "a b\r\r\nc\r\r\n"}) {
    write_file(folder / "x.txt", text);
    EXPECT_THAT(read_lines(folder / "x.txt"), ElementsAre("a b", "c")) << text;
  }
}

TEST_F(Files, RefusesTextInUtf16) {
  using namespace std::string_literals;
  for (const std::string& text : {"\xFF\xFE\x31\x00"s, "\xFE\xFF\x00\x31"s, "1\0 \0"s, "\0001"s}) {
    write_file(folder / "x.txt", text);
    EXPECT_THAT([&] { read_lines(folder / "x.txt"); },
                ThrowsMessage<InputError>(AllOf(HasSubstr("x.txt: is UTF-16 text"), HasSubstr("save it as UTF-8"))));
  }
}

TEST_F(Files, ListsEndingsOfEitherCaseInNaturalOrder) {
  for (const char* name : {"frame10.PNG", "frame9.png", "frame1.Png", "frame2.tif", ".frame3.png"})
    write_file(folder / name, "");
  EXPECT_THAT(list_files(folder, {".png"}), ElementsAre(folder / "frame1.Png", folder / "frame9.png", folder / "frame10.PNG"));
}

TEST_F(Files, AcceptsOnlyEmptyAndNewFoldersAsEmpty) {
  require_empty(folder / "new", "case");
  make_folder(folder / "empty");
  require_empty(folder / "empty", "case");
  write_file(folder / "empty/.hidden", "");
  const auto refusal =
      ThrowsMessage<InputError>(AllOf(HasSubstr("is not an empty folder"), HasSubstr("new folder for the case")));
  EXPECT_THAT([&] { require_empty(folder / "empty", "case"); }, refusal);
  EXPECT_THAT([&] { require_empty(folder / "empty/.hidden", "case"); }, refusal);
}

TEST_F(Files, RemovesAllLineEnds) {
  write_file(folder / "x.txt", "a\r\n\nb c\nlast");
  EXPECT_THAT(read_lines(folder / "x.txt"), ElementsAre("a", "", "b c", "last"));
}

TEST_F(Files, ReportsUnreadableFiles) {
  EXPECT_THAT([&] { read_file(folder / "absent"); },
              ThrowsMessage<InputError>(AllOf(HasSubstr((folder / "absent").string()), HasSubstr("No such file"))));
  EXPECT_THAT([&] { read_file(folder); }, ThrowsMessage<InputError>(HasSubstr("is a folder")));
}

TEST_F(Files, ReadsOnlyRegularFilesOfBoundedSize) {
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_THAT([&] { read_file(folder / "pipe"); }, ThrowsMessage<InputError>(HasSubstr("pipe: is a pipe or a device")));
  EXPECT_THAT([] { read_file("/dev/zero"); }, ThrowsMessage<InputError>(HasSubstr("/dev/zero: is a pipe or a device")));
  write_file(folder / "x.bin", "12345");
  EXPECT_THAT([&] { read_file(folder / "x.bin", 4); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("x.bin: has 5 bytes"), HasSubstr("at most 4"))));
  fs::create_symlink("loop", folder / "loop");
  EXPECT_THAT([&] { read_file(folder / "loop"); }, ThrowsMessage<InputError>(HasSubstr("loop: cannot be read")));
  EXPECT_THAT([&] { read_file(folder / std::string(300, 'n')); }, ThrowsMessage<InputError>(HasSubstr("cannot be read")));
}

TEST_F(Files, RefusesSettingsWithLongLines) {
  write_file(folder / "a.toml", "a = 1\n" + std::string(10'000, 'b') + "\n");
  EXPECT_EQ(read_settings(folder / "a.toml").size(), 10'007U);
  write_file(folder / "a.toml", "a = 1\n" + std::string(10'001, 'b'));
  EXPECT_THAT([&] { read_settings(folder / "a.toml"); }, ThrowsMessage<InputError>(HasSubstr("a.toml:2: the line has 10001")));
  write_file(folder / "a.toml", std::string((1 << 20) + 1, '\n'));
  EXPECT_THAT([&] { read_settings(folder / "a.toml"); }, ThrowsMessage<InputError>(HasSubstr("at most 1048576")));
}

TEST_F(Files, KeepsTheOldFileIfWritingFails) {
  write_file(folder / "x.png", "old");
  EXPECT_THROW(write_beside(folder / "x.png",
                            [](const fs::path& part) {
                              EXPECT_EQ(part.extension(), ".png");
                              std::ofstream(part) << "half";
                              throw std::runtime_error("stop");
                            }),
               std::runtime_error);
  EXPECT_EQ(read_file(folder / "x.png"), "old");
  EXPECT_THAT(names(), ElementsAre("x.png"));
}

TEST_F(Files, ReportsAWriterThatMakesNoFile) {
  EXPECT_THROW(write_beside(folder / "x.png", [](const fs::path&) {}), InputError);
  EXPECT_THAT(names(), IsEmpty());
}

TEST_F(Files, ReportsAFullDiskAndLeavesNoFile) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto write_without_room = [&](const std::function<void(const fs::path&, const std::string&)>& write) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit small{4096, RLIM_INFINITY};
    setrlimit(RLIMIT_FSIZE, &small);
    bool refused = false;
    try {
      write(folder / "x.bin", std::string(1 << 20, 'x'));
    } catch (const InputError& e) {
      refused = std::string(e.what()).find((folder / "x.bin").string()) == 0;
    }
    std::_Exit(refused ? 0 : 1);
  };
  EXPECT_EXIT(write_without_room(write_file), testing::ExitedWithCode(0), "");
  const auto write_in_parts = [](const fs::path& path, const std::string& bytes) {
    write_stream(path, [&](std::ostream& out) { out << bytes << bytes; });
  };
  EXPECT_EXIT(write_without_room(write_in_parts), testing::ExitedWithCode(0), "");
  EXPECT_THAT(names(), IsEmpty());
}

TEST_F(Files, ReportsAMissingFolder) {
  EXPECT_THAT([&] { write_file(folder / "no" / "x", "y"); }, ThrowsMessage<InputError>(HasSubstr("No such file")));
}

TEST_F(Files, RefusesAFolderWithThePathOfAFile) {
  make_folder(folder / "a" / "b");
  make_folder(folder / "a" / "b");
  EXPECT_TRUE(fs::is_directory(folder / "a" / "b"));
  write_file(folder / "file", "x");
  EXPECT_THROW(make_folder(folder / "file"), InputError);
  EXPECT_THROW(make_folder(folder / "file" / "below"), InputError);
}

TEST_F(Files, ListsSortedFilesWithoutPartsAndOtherEndings) {
  for (const char* name : {"b.png", "a.jpg", "c.txt", ".b.part12.png", "a.png"}) write_file(folder / name, "x");
  fs::create_directory(folder / "folder.png");
  EXPECT_THAT(list_files(folder, {".png", ".jpg"}), ElementsAre(folder / "a.jpg", folder / "a.png", folder / "b.png"));
  EXPECT_THAT(list_files(folder / "absent", {".png"}), IsEmpty());
}

}  // namespace
}  // namespace dvi
