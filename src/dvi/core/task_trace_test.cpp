#include "dvi/core/task_trace.h"

#include <gmock/gmock.h>

#include <regex>

#include "dvi/core/files.h"
#include "dvi/testing/temp_folder.h"

namespace dvi {
namespace {

TEST(TaskTrace, WritesNestedEventsInOrder) {
  const TempFolder folder;
  const fs::path file = folder.path / "trace";
  {
    TaskTrace trace(file.string());
    trace.stage("read");
    trace.begin_loop(1, 3, "ao");
    trace.begin_task(0, 1);
    trace.end_task();
    trace.end_loop();
  }
  const std::string events = std::regex_replace(read_file(file), std::regex("(^|\n)[0-9]+ "), "$1");
  EXPECT_EQ(events, "stage read\nloop 1 3 ao\ntask 0 1\nend\ndone\n");
}

TEST(TaskTrace, IsOffUnlessTheEnvironmentNamesAFile) { EXPECT_EQ(TaskTrace::of_process(), nullptr); }

}  // namespace
}  // namespace dvi
