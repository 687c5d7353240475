#include "base/remains.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

#include "base/error.h"
#include "base/files.h"
#include "base/process/end_at_once.h"
#include "base/process/process.h"

namespace packmerger {
namespace {

bool runs(const std::string& pid) {
  std::ifstream stat("/proc/" + pid + "/stat");
  const std::string text{std::istreambuf_iterator<char>(stat), {}};
  return !text.empty() && text.find(") Z") == std::string::npos;
}

TEST(Remains, GoWithTheProgramWhateverItIsDoing) {
  // No temporary folder, since the forked child would remove it with its own.
  const fs::path around = fs::path(testing::TempDir()) / ("remains-" + std::to_string(::getpid()));
  fs::create_directories(around);
  const fs::path pid_file = around / "pid";
  const auto end_in_the_middle = [&] {
    const TemporaryFolder folder = TemporaryFolder::beside(around / "job");
    ProcessSpec spec;
    spec.argv = {"sh", "-c", "trap '' TERM; echo $$ > " + pid_file.string() + "; sleep 600"};
    const ChildProcess child(spec);
    std::thread([&] {
      try {
        for (int i = 0;; ++i) write_file_whole(folder.path() / std::to_string(i), "busy");
      } catch (const Error&) {  // its folder vanished; it would end the program by a signal
        yield_to_an_end();
        throw;
      }
    }).detach();
    while (!fs::exists(pid_file) || fs::file_size(pid_file) == 0) std::this_thread::yield();
    end_without_remains(130);
  };
  EXPECT_EXIT(end_in_the_middle(), testing::ExitedWithCode(130), "");
  std::string pid;
  ASSERT_TRUE(std::getline(std::ifstream(pid_file), pid));
  for (int i = 0; i < 1000 && runs(pid); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_FALSE(runs(pid));
  for (const auto& entry : fs::directory_iterator(around)) EXPECT_EQ(entry.path(), pid_file);
  fs::remove_all(around);
}

TEST(Remains, AreForgottenWithWhatTheyWere) {
  const std::size_t folders = remains().folders.size();
  const std::size_t groups = remains().groups.size();
  {
    TemporaryFolder kept;
    const TemporaryFolder removed;
    const TemporaryFolder around;
    ProcessSpec spec;
    spec.argv = {"true"};
    const ChildProcess child(spec);
    EXPECT_EQ(remains().folders.size(), folders + 3);
    EXPECT_EQ(remains().groups.size(), groups + 1);
    kept.publish(around.path() / "kept");
    EXPECT_EQ(remains().folders.size(), folders + 2);
    spec.argv = {"/nonexistent/program"};
    EXPECT_ANY_THROW(ChildProcess{spec});
    EXPECT_EQ(remains().groups.size(), groups + 1);
  }
  EXPECT_EQ(remains().folders.size(), folders);
  EXPECT_EQ(remains().groups.size(), groups);
}

}  // namespace
}  // namespace packmerger
