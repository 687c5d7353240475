#include "base/process/process.h"

#include <gtest/gtest.h>
#include <signal.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <thread>

#include "base/error.h"
#include "base/files.h"

namespace packmerger {
namespace {

ProcessSpec shell(const std::string& script) {
  ProcessSpec spec;
  spec.argv = {"/bin/sh", "-c", script};
  return spec;
}

TEST(Process, GivesOutputAndExitCode) {
  const ProcessResult result =
      run_process(shell("printf out; printf err >&2; exit 7"), 0, Progress());
  EXPECT_EQ(result.status.code, 7);
  EXPECT_EQ(result.status.signal, 0);
  EXPECT_EQ(result.out, "out");
  EXPECT_EQ(result.err, "err");
}

TEST(Process, TellsTheSignalThatEndedIt) {
  EXPECT_EQ(run_process(shell("kill -SEGV $$"), 0, Progress()).status.signal, SIGSEGV);
}

TEST(Process, APathIsSearchedAsAChildWouldBe) {
  EXPECT_TRUE(program_in_path("sh").value_or("").is_absolute());
  EXPECT_FALSE(program_in_path("no-such-program-anywhere"));
}

TEST(Process, MissingProgramIsAnError) {
  ProcessSpec spec;
  spec.argv = {"no-such-program-anywhere"};
  try {
    run_process(spec, 0, Progress());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.fault(), Fault::kUnavailable);
  }
}

TEST(Process, LinesOfStandardErrorComeAsTheyAreWritten) {
  std::vector<std::string> lines;
  run_process(shell("echo one >&2; echo two >&2; printf rest >&2"), 0, Progress(),
              [&](std::string_view line) { lines.emplace_back(line); });
  EXPECT_EQ(lines, (std::vector<std::string>{"one", "two"}));
}

TEST(Process, LongOutputIsDrainedAndBounded) {
  const ProcessResult result =
      run_process(shell("head -c 3000000 /dev/zero"), 0, Progress(), {}, 1000);
  EXPECT_TRUE(result.status.ok());
  EXPECT_EQ(result.out.size(), 1000u);
}

TEST(Process, TimeoutEndsGrandchildrenToo) {
  const TemporaryFolder folder;
  const std::string mark = (folder.path() / "alive").string();
  const ProcessResult result = run_process(shell("(trap '' TERM; sleep 6; touch " + mark +
                                                 ") & trap '' TERM; sleep 60 & wait; sleep 60"),
                                           0.3, Progress());
  EXPECT_TRUE(result.timed_out);
  std::this_thread::sleep_for(std::chrono::seconds(5));
  EXPECT_FALSE(fs::exists(mark)) << "a grandchild outlived its group";
}

TEST(Process, CancellingEndsIt) {
  std::atomic<bool> cancelled{false};
  std::thread canceller([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    cancelled = true;
  });
  try {
    run_process(shell("sleep 60"), 0, Progress({}, &cancelled));
    ADD_FAILURE() << "not cancelled";
  } catch (const Error& error) {
    EXPECT_EQ(error.fault(), Fault::kInterrupted);
  }
  canceller.join();
}

TEST(Process, EnvironmentAndMemoryLimit) {
  ProcessSpec spec = shell("printf \"$GREETING|$DISPLAY\"; ulimit -v >&2");
  spec.set_env["GREETING"] = "hello";
  spec.unset_env = {"DISPLAY"};
  spec.max_memory_bytes = std::uint64_t{1} << 30;
  const ProcessResult result = run_process(spec, 0, Progress());
  EXPECT_EQ(result.out, "hello|");
  EXPECT_EQ(result.err, "1048576\n");
}

TEST(Process, HelpersLieBesideTheProgramOrInLib) {
  const std::string helper = "packmerger-helper-of-a-test";
  const fs::path beside = program_folder() / helper;
  const fs::path installed = program_folder().parent_path() / "lib/packmerger" / helper;
  EXPECT_EQ(helper_program(helper), beside);
  fs::create_directories(installed.parent_path());
  std::ofstream(installed) << "";
  EXPECT_EQ(helper_program(helper), installed);
  std::ofstream(beside) << "";
  EXPECT_EQ(helper_program(helper), beside) << "a build's own helper goes before an installed one";
  fs::remove(beside);
  fs::remove_all(program_folder().parent_path() / "lib");
}

}  // namespace
}  // namespace packmerger
