// Tests of the small parts of core: errors, fingerprints, random numbers, threads, progress, interruption.
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/core/error.h"
#include "dvi/core/files.h"
#include "dvi/core/hash.h"
#include "dvi/core/interrupt.h"
#include "dvi/core/process_memory.h"
#include "dvi/core/progress.h"
#include "dvi/core/random.h"
#include "dvi/core/threads.h"
#include "dvi/testing/temp_folder.h"

namespace dvi {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(InputError, ReportsFileProblemAndRemedy) {
  EXPECT_STREQ(InputError("a/b.bin", "is empty", "copy it again").what(), "a/b.bin: is empty; copy it again");
  EXPECT_STREQ(InputError("a/b.bin", "is empty").what(), "a/b.bin: is empty");
}

std::string fingerprint(const std::vector<std::string>& parts) {
  Fingerprint f;
  for (const std::string& part : parts) f.add(part);
  return f.hex();
}

TEST(Fingerprint, DependsOnBytesBoundariesAndOrder) {
  const std::set<std::string> all = {fingerprint({}),          fingerprint({""}),       fingerprint({"ab", "c"}),
                                     fingerprint({"a", "bc"}), fingerprint({"abc"}),    fingerprint({"c", "ab"}),
                                     fingerprint({"", "abc"}), fingerprint({"abc", ""})};
  EXPECT_EQ(all.size(), 8U);
  EXPECT_EQ(fingerprint({"ab", "c"}), fingerprint({"ab", "c"}));
  EXPECT_EQ(fingerprint({"x"}).size(), 32U);
}

TEST(Printable, EscapesControlCharacters) {
  EXPECT_EQ(to_printable("a\x1b[2Jb\tc\nd\x7f"), "a\\x1b[2Jb\\x09c\nd\\x7f");
  EXPECT_EQ(to_printable("Stra\xc3\x9f"
                         "e"),
            "Stra\xc3\x9f"
            "e");
  EXPECT_EQ(to_printable(std::string(3000, 'a')), std::string(3000, 'a'));
  EXPECT_EQ(to_printable(std::string(5000, 'a')), std::string(3000, 'a') + " ... (5000 bytes in all)");
}

TEST(Fingerprint, OfAFileDependsOnItsContentOnly) {
  const TempFolder folder;
  const fs::path file = folder.path / "fingerprint.bin";
  write_file(file, std::string(3'000'000, 'a'));
  const std::string before = compute_file_hash(file);
  const fs::file_time_type time = fs::last_write_time(file);
  EXPECT_EQ(compute_file_hash(file), before);
  write_file(file, std::string(2'999'999, 'a') + "b");
  fs::last_write_time(file, time);
  EXPECT_NE(compute_file_hash(file), before) << "with the same size and time";
  fs::remove(file);
  EXPECT_THROW(compute_file_hash(file), InputError);
  EXPECT_THROW(compute_file_hash(folder.path), InputError);
  write_file(file, "a");
  fs::resize_file(file, std::uintmax_t{1} << 36);
  EXPECT_THAT(input_error([&] { compute_file_hash(file); }), testing::HasSubstr("of them were written"));
}

TEST(Random, IsSplitMix64) {  // reference values of the published generator for the seed 1234567
  Random random(1234567);
  EXPECT_EQ(random.next(), 6457827717110365317ULL);
  EXPECT_EQ(random.next(), 3203168211198807973ULL);
  EXPECT_EQ(random.next(), 9817491932198370423ULL);
}

TEST(Random, KeepsItsRangesAndMoments) {
  Random random(1);
  const int n = 20000;
  double sum = 0, normal_sum = 0, normal_squares = 0;
  std::vector<int> counts(7);
  for (int i = 0; i < n; ++i) {
    const double u = random.uniform(-2, 3);
    ASSERT_GE(u, -2);
    ASSERT_LT(u, 3);
    sum += u;
    ++counts.at(static_cast<std::size_t>(random.below(7)));
    const double x = random.normal();
    ASSERT_TRUE(std::isfinite(x));
    normal_sum += x;
    normal_squares += x * x;
  }
  EXPECT_NEAR(sum / n, 0.5, 0.05);
  EXPECT_NEAR(normal_sum / n, 0, 0.03);
  EXPECT_NEAR(normal_squares / n, 1, 0.05);
  EXPECT_GT(*std::min_element(counts.begin(), counts.end()), n / 7 - 300);
}

TEST(Threads, RunEachIndexOnceForAnyLimit) {
  for (const int limit : {1, 2, 0}) {
    const ThreadLimit threads(limit);
    EXPECT_TRUE(limit == 0 || thread_count() == limit);
    std::vector<std::atomic<int>> calls(1000);
    parallel_for(calls.size(), [&](std::size_t i) { ++calls[i]; });
    EXPECT_TRUE(std::all_of(calls.begin(), calls.end(), [](const auto& c) { return c == 1; }));
  }
  parallel_for(0, [](std::size_t) { FAIL(); });
}

TEST(Threads, RunBlocksInOrder) {
  const ThreadLimit three(3);
  using Blocks = std::vector<std::pair<std::size_t, std::size_t>>;
  const auto blocks_of = [](std::size_t count) {
    Blocks blocks;
    for_blocks(count, [&](std::size_t first, std::size_t last) { blocks.emplace_back(first, last); });
    return blocks;
  };
  EXPECT_EQ(blocks_of(0), Blocks{});
  EXPECT_EQ(blocks_of(6), (Blocks{{0, 3}, {3, 6}}));
  EXPECT_EQ(blocks_of(7), (Blocks{{0, 3}, {3, 6}, {6, 7}}));
}

TEST(Threads, BeginItemsInOrderAndDoNotWaitForSlowOnes) {
  const ThreadLimit three(3);
  std::vector<std::atomic<int>> calls(100);
  std::atomic<bool> ahead = false;
  std::atomic<std::size_t> begun = 0;
  parallel_in_order(calls.size(), [&](std::size_t i) {
    ahead = ahead || begun++ + 2 < i;  // the other threads may have taken an earlier item without having begun it
    if (i == 10)
      while (begun < 50) std::this_thread::yield();
    ++calls[i];
  });
  EXPECT_FALSE(ahead);
  EXPECT_TRUE(std::all_of(calls.begin(), calls.end(), [](const auto& c) { return c == 1; }));
}

TEST(Threads, PassItemsThroughAPipelineInOrderWhereAsked) {
  for (const int limit : {1, 2, 5}) {
    const ThreadLimit threads(limit);
    constexpr std::size_t kCount = 200;
    std::vector<std::atomic<int>> done(kCount);
    std::vector<std::size_t> order;
    std::atomic<int> begun = 0, finished = 0, most = 0;
    run_pipeline(kCount, {{PipelineStep::Order::any,
                           [&](std::size_t i) {
                             most = std::max<int>(most, ++begun - finished);
                             ++done[i];
                           }},
                          {PipelineStep::Order::ascending, [&](std::size_t i) { order.push_back(i); }},
                          {PipelineStep::Order::any, [&](std::size_t i) {
                             ++done[i];
                             ++finished;
                           }}});
    EXPECT_TRUE(std::all_of(done.begin(), done.end(), [](const auto& count) { return count == 2; }));
    ASSERT_EQ(order.size(), kCount);
    EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
    EXPECT_LE(most, 2 * limit + 1);
  }
  run_pipeline(0, {{PipelineStep::Order::any, [](std::size_t) { FAIL(); }}});
}

TEST(Threads, MakeInParallelAndUseInOrder) {
  const ThreadLimit three(3);
  std::vector<std::size_t> used;
  make_and_use(
      50, [](std::size_t i) { return std::make_unique<std::size_t>(i * i); },
      [&](std::size_t i, std::unique_ptr<std::size_t> square) {
        EXPECT_EQ(*square, i * i);
        used.push_back(i);
      });
  EXPECT_EQ(used.size(), 50U);
  EXPECT_TRUE(std::is_sorted(used.begin(), used.end()));
  const auto fail_at = [](std::size_t i) {
    if (i == 7) throw InputError("scan 7", "is broken");
    return i;
  };
  EXPECT_THROW(make_and_use(50, fail_at, [](std::size_t i, std::size_t) { EXPECT_LT(i, 7U); }), InputError);
}

TEST(Threads, CountTheTimeOfHelpersForTheTask) {
  const ThreadLimit three(3);
  const auto spend = [](double seconds) {
    for (const double begun = thread_cpu_seconds(); thread_cpu_seconds() < begun + seconds;) {
    }
  };
  const double begun = task_cpu_seconds();
  parallel_for(12, [&](std::size_t) { parallel_for(2, [&](std::size_t) { spend(0.005); }); });
  EXPECT_GE(task_cpu_seconds() - begun, 0.119);
  const double between = task_cpu_seconds();
  parallel_in_order(12, [&](std::size_t) { parallel_in_order(2, [&](std::size_t) { spend(0.005); }); });
  EXPECT_GE(task_cpu_seconds() - between, 0.119);
}

TEST(Threads, AreLimitedDuringTheLifeOfTheLimit) {
  const int before = thread_count();
  {
    const ThreadLimit one(1);
  }
  EXPECT_EQ(thread_count(), before);
}

TEST(Threads, PassExceptionsToTheCaller) {
  const auto body = [](std::size_t i) {
    if (i == 57) throw InputError("scan 57", "is broken");
  };
  EXPECT_THROW(parallel_for(100, body), InputError);
}

TEST(Progress, MeasuresStagesAndKeepsEachWarningOnce) {
  testing::internal::CaptureStderr();
  Progress progress(ProgressStyle::lines);
  progress.begin("map", 3);
  parallel_for(3, [&](std::size_t) { progress.tick()(); });
  progress.warn("frame 7 has no scan");
  progress.begin("depth", 0);  // ends map
  progress.warn("frame 7 has no scan");
  progress.end();
  progress.end();
  const std::string text = testing::internal::GetCapturedStderr();
  EXPECT_THAT(progress.warnings(), ElementsAre("frame 7 has no scan"));
  EXPECT_THAT(progress.times(),
              ElementsAre(testing::Field(&StageTime::stage, "map"), testing::Field(&StageTime::stage, "depth")));
  EXPECT_THAT(text, HasSubstr("warning: frame 7 has no scan\n"));
  EXPECT_THAT(text, HasSubstr("map: done"));
}

TEST(Progress, ReportsTheCurrentStageAndCanBeCanceled) {
  Progress progress(ProgressStyle::quiet);
  EXPECT_FALSE(progress.now());
  progress.begin("work", 3);
  progress.advance();
  ASSERT_TRUE(progress.now());
  EXPECT_EQ(progress.now()->stage, "work");
  EXPECT_EQ(progress.now()->done, 1U);
  progress.cancel();
  EXPECT_THROW(progress.advance(), Interrupted);
  EXPECT_THROW(progress.begin("more", 1), Interrupted);
  progress.end();
  EXPECT_FALSE(progress.now());
}

TEST(OwnBinary, IsTheFileOfTheRunningProgram) {
  EXPECT_EQ(read_file(find_own_binary()).substr(0, 4),
            "\x7f"
            "ELF");
  EXPECT_TRUE(fs::equivalent(find_own_binary(), "/proc/self/exe"));
}

TEST(Progress, PrintsNothingInQuietModeButKeepsWarnings) {
  testing::internal::CaptureStderr();
  Progress progress(ProgressStyle::quiet);
  progress.begin("map", 1);
  progress.advance();
  progress.warn("gap");
  progress.end();
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(progress.warnings().size(), 1U);
}

TEST(Progress, PrintsOneJsonObjectPerLine) {
  testing::internal::CaptureStderr();
  {
    Progress progress(ProgressStyle::json);
    progress.begin("map", 1);
    progress.warn("say \"x\"\n");
  }
  const std::string text = testing::internal::GetCapturedStderr();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3);
  EXPECT_THAT(text, HasSubstr(R"("message":"say \"x\"\n")"));
  EXPECT_THAT(text, HasSubstr("stage_end"));
}

TEST(Progress, ShowsABarForExcessUnitsAndInvalidText) {
  testing::internal::CaptureStderr();
  Progress progress(ProgressStyle::bar);
  progress.begin("map", 2);
  for (int i = 0; i < 5; ++i) progress.advance();
  progress.warn("\xff\xfe");
  progress.end();
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("5/2"));
}

TEST(Progress, PrintsJsonForNamesThatAreNotUtf8) {
  testing::internal::CaptureStderr();
  Progress progress(ProgressStyle::json);
  EXPECT_NO_THROW(progress.warn("frame \xff.png"));
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("frame "));
}

TEST(Interrupt, StopsTheNextUnitOfWork) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto work = [] {
    catch_interrupts();
    Progress progress(ProgressStyle::quiet);
    progress.begin("map", 2);
    progress.advance();
    std::raise(SIGTERM);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));  // ThreadSanitizer delivers signals at blocking calls only
    try {
      progress.advance();
    } catch (const Interrupted&) {
      std::_Exit(130);
    }
    std::_Exit(0);
  };
  EXPECT_EXIT(work(), testing::ExitedWithCode(130), "");
}

TEST(Interrupt, EndsBlockedReads) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto work = [] {
    catch_interrupts();
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) std::_Exit(1);
    const pthread_t reader = pthread_self();
    std::thread([reader] {
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
      pthread_kill(reader, SIGINT);
    }).detach();
    char byte = 0;
    const bool returned = read(ends[0], &byte, 1) == -1 && errno == EINTR;
    std::_Exit(returned ? 130 : 0);
  };
  EXPECT_EXIT(work(), testing::ExitedWithCode(130), "");
}

TEST(Usage, MeasuresCpuTime) {
  const double before = process_cpu_seconds(), thread_before = thread_cpu_seconds();
  volatile double x = 1;
  for (int i = 0; i < 3000000; ++i) x = x * 1.0000001;
  EXPECT_GT(process_cpu_seconds(), before);
  EXPECT_GT(thread_cpu_seconds(), thread_before);
}

TEST(Usage, MeasuresMemory) {
  const std::size_t before = resident_memory();
  const std::vector<char> block(std::size_t{64} << 20, 1);
  EXPECT_GT(resident_memory(), before + block.size() / 2);
  EXPECT_GE(peak_memory(), block.size());
}

}  // namespace
}  // namespace dvi
