#include "daemon/intake/watch_folder.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "base/error.h"
#include "base/files.h"
#include "daemon/intake/whole_file.h"

namespace packmerger {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

std::string binary_stl(std::uint32_t triangles) {
  std::string bytes(80, 'h');
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(triangles >> shift);
  return bytes + std::string(50 * std::size_t{triangles}, '\1');
}

void write(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

TEST(WholeFile, KnowsTheEndOfEveryFormat) {
  const TemporaryFolder folder;
  const auto check = [&](const std::string& name, const std::string& bytes) {
    write(folder.path() / name, bytes);
    return file_is_whole(folder.path() / name);
  };
  const std::string stl = binary_stl(20);
  EXPECT_EQ(check("a.stl", stl), Whole::kYes);
  EXPECT_EQ(check("a.STL", stl), Whole::kYes);
  for (const std::size_t length :
       {std::size_t{0}, std::size_t{1}, std::size_t{80}, std::size_t{84}, stl.size() - 1})
    EXPECT_EQ(check("a.stl", stl.substr(0, length)), Whole::kNo) << length;
  std::string named = stl;
  named.replace(0, 5, "solid");
  EXPECT_EQ(check("a.stl", named), Whole::kYes);
  EXPECT_EQ(check("a.stl", named.substr(0, 500)), Whole::kNo);
  EXPECT_EQ(check("a.stl", "solid x\nfacet\nendfacet\nendsolid x\n \n"), Whole::kYes);
  EXPECT_EQ(check("a.stl", "solid x\nfacet\nendfacet\n"), Whole::kNo);
  EXPECT_EQ(check("a.stl", "solid x\nendsolid x\nsolid y\nfacet"), Whole::kNo);
  const std::string end = std::string("PK\5\6", 4) + std::string(18, '\0');
  EXPECT_EQ(check("a.3mf", end), Whole::kYes);
  std::string commented = end;
  commented[20] = 3;
  EXPECT_EQ(check("a.3mf", commented + "abc"), Whole::kYes);
  EXPECT_EQ(check("a.3mf", commented + "ab"), Whole::kNo);
  EXPECT_EQ(check("a.3mf", "PK\3\4rest of a file"), Whole::kNo);
  EXPECT_EQ(check("a.obj", "v 0 0 0\n"), Whole::kUnknown);
  EXPECT_EQ(check("a.obj", ""), Whole::kNo);
  EXPECT_EQ(file_is_whole(folder.path() / "none.stl"), Whole::kNo);
}

TEST(WholeFile, SeesAnOpenWriter) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "a.stl";
  write(path, "x");
  EXPECT_FALSE(is_being_written(path));
  const int fd = ::open(path.c_str(), O_WRONLY);
  EXPECT_TRUE(is_being_written(path));
  ::close(fd);
  EXPECT_FALSE(is_being_written(path));
}

TEST(WatchFolder, TemporaryNames) {
  for (const char* name :
       {".x.stl", "~x.stl", "x.stl.part", "x.tmp", "x.crdownload", "x.filepart", ""})
    EXPECT_TRUE(is_temporary_name(name)) << name;
  for (const char* name : {"x.stl", "x.partition", "part", "tmp"})
    EXPECT_FALSE(is_temporary_name(name)) << name;
}

// Time is the test's own: each look() is told what time it is.
class WatchFolderTest : public testing::Test {
 protected:
  WatchFolderTest() {
    rules_.rescan_s = 5;
    rules_.still_s = 1;
    rules_.give_up_s = 60;
    watch_ = std::make_unique<WatchFolder>(path(), rules_);
    look();
  }

  fs::path path(const std::string& name = {}) const {
    return name.empty() ? folder_.path() / "drop" : folder_.path() / "drop" / name;
  }

  // The names that are ripe `seconds` later.
  std::vector<std::string> look(double seconds = 0) {
    now_s_ += seconds;
    WatchFolder::Found found = watch_->look(now_s_);
    for (auto& each : found.ignored) ignored_.push_back(each);
    std::vector<std::string> names;
    for (const fs::path& file : found.whole) names.push_back(file.filename().string());
    return names;
  }

  TemporaryFolder folder_;
  WatchConfig rules_;
  std::unique_ptr<WatchFolder> watch_;
  std::vector<WatchFolder::Ignored> ignored_;
  double now_s_ = 100;
};

TEST_F(WatchFolderTest, WrittenAtOnce) {
  write(path("a.stl"), binary_stl(3));
  EXPECT_THAT(look(), IsEmpty()) << "not still yet";
  EXPECT_THAT(look(0.5), IsEmpty());
  EXPECT_THAT(look(0.6), ElementsAre("a.stl"));
  EXPECT_THAT(look(0.3), ElementsAre("a.stl")) << "until it is taken";
  fs::remove(path("a.stl"));
  EXPECT_THAT(look(5), IsEmpty());
}

TEST_F(WatchFolderTest, CopiedSlowly) {
  const std::string bytes = binary_stl(100);
  std::ofstream file(path("a.stl"), std::ios::binary);
  for (std::size_t at = 0; at < bytes.size(); at += 1000) {
    file << bytes.substr(at, 1000) << std::flush;
    EXPECT_THAT(look(2), IsEmpty()) << at;
  }
  EXPECT_THAT(look(2), IsEmpty()) << "its writer still has it open";
  file.close();
  EXPECT_THAT(look(0.5), ElementsAre("a.stl"));
}

TEST_F(WatchFolderTest, RenamedFromATemporaryName) {
  write(path("a.stl.part"), binary_stl(3));
  EXPECT_THAT(look(10), IsEmpty());
  fs::rename(path("a.stl.part"), path("a.stl"));
  look();
  EXPECT_THAT(look(1.1), ElementsAre("a.stl"));
}

TEST_F(WatchFolderTest, MovedInFromElsewhere) {
  write(folder_.path() / "a.stl", binary_stl(3));
  fs::rename(folder_.path() / "a.stl", path("a.stl"));
  look();
  EXPECT_THAT(look(1.1), ElementsAre("a.stl"));
}

TEST_F(WatchFolderTest, HardLinked) {
  write(folder_.path() / "a.stl", binary_stl(3));
  fs::create_hard_link(folder_.path() / "a.stl", path("a.stl"));
  look();
  EXPECT_THAT(look(1.1), ElementsAre("a.stl"));
}

TEST_F(WatchFolderTest, ThereBeforeTheStart) {
  write(path("b.stl"), binary_stl(3));
  watch_ = std::make_unique<WatchFolder>(path(), rules_);
  look();
  EXPECT_THAT(look(1.1), ElementsAre("b.stl"));
}

TEST_F(WatchFolderTest, TruncatedAndRewritten) {
  write(path("a.stl"), binary_stl(3));
  look(0.5);
  write(path("a.stl"), binary_stl(50).substr(0, 500));
  EXPECT_THAT(look(2), IsEmpty());
  EXPECT_THAT(look(2), IsEmpty()) << "cut short";
  write(path("a.stl"), binary_stl(50));
  EXPECT_THAT(look(), IsEmpty());
  EXPECT_THAT(look(1.1), ElementsAre("a.stl"));
}

TEST_F(WatchFolderTest, PreallocatedAndFilled) {
  write(path("a.3mf"), "PK\3\4");
  fs::resize_file(path("a.3mf"), 100000);
  look();
  EXPECT_THAT(look(20), IsEmpty());
}

TEST_F(WatchFolderTest, CutShortForEver) {
  write(path("a.stl"), binary_stl(50).substr(0, 500));
  look();
  EXPECT_THAT(look(59), IsEmpty());
  EXPECT_THAT(look(1.1), ElementsAre("a.stl")) << "taken, so that its failure can be told";
}

TEST_F(WatchFolderTest, AFormatWithoutAnEndWaitsForItsWriter) {
  write(path("closed.obj"), "v 0 0 0\n");
  look();
  EXPECT_THAT(look(1.1), ElementsAre("closed.obj"));
}

TEST_F(WatchFolderTest, AProgramThatGrowsIsNotWhole) {
  std::ofstream file(path("a.gcode"));
  for (int i = 0; i < 20; ++i) {
    file << "G1 X" << i << "\n" << std::flush;
    EXPECT_THAT(look(2), IsEmpty()) << i;
  }
  file.close();
  EXPECT_THAT(look(0.5), IsEmpty());
  EXPECT_THAT(look(1.1), ElementsAre("a.gcode"));
}

TEST_F(WatchFolderTest, SettingsComeBeforeOrAfterTheirModel) {
  write(path("a.stl.toml"), "scale = 2\n");
  look();
  EXPECT_THAT(look(10), IsEmpty()) << "they are no model";
  write(path("a.stl"), binary_stl(3));
  look();
  EXPECT_THAT(look(1.1), ElementsAre("a.stl"));

  write(path("b.stl"), binary_stl(3));
  look();
  look(0.8);
  write(path("b.stl.toml"), "scale = 2\n");
  EXPECT_THAT(look(0.3), ElementsAre("a.stl")) << "b waits for its settings to be whole";
  EXPECT_THAT(look(1.1), ElementsAre("a.stl", "b.stl"));
  EXPECT_THAT(ignored_, IsEmpty());
}

TEST_F(WatchFolderTest, AModelWaitsForTheWriterOfItsSettings) {
  write(path("a.stl"), binary_stl(3));
  std::ofstream settings(path("a.stl.toml"));
  settings << "scale = " << std::flush;
  look();
  EXPECT_THAT(look(2), IsEmpty());
  EXPECT_THAT(look(2), IsEmpty());
  settings << "2\n";
  settings.close();
  look();
  EXPECT_THAT(look(1.1), ElementsAre("a.stl"));
}

TEST_F(WatchFolderTest, SettingsByThemselvesAreToldOnce) {
  write(path("a.toml"), "scale = 2\n");
  look();
  EXPECT_THAT(look(50), IsEmpty());
  EXPECT_THAT(ignored_, IsEmpty());
  look(20);
  look(20);
  ASSERT_THAT(ignored_, SizeIs(1));
  EXPECT_THAT(ignored_[0].reason, testing::HasSubstr("and a, which it is named after"));
}

TEST_F(WatchFolderTest, NoticedByReadingAgainWithoutAnyEvent) {
  watch_ = std::make_unique<WatchFolder>(path(), rules_);
  look();
  fs::remove_all(path());
  fs::create_directory(path());
  write(path("a.stl"), binary_stl(3));  // in a folder that is not the watched one any more
  look(5.1);
  EXPECT_THAT(look(1.1), ElementsAre("a.stl"));
  write(path("b.stl"), binary_stl(3));
  pollfd waiting{watch_->fd(), POLLIN, 0};
  EXPECT_EQ(::poll(&waiting, 1, 1000), 1) << "the new folder is watched";
}

TEST_F(WatchFolderTest, ManyAtOnceOldestFirst) {
  for (int i = 0; i < 2000; ++i) write(path("m" + std::to_string(i) + ".stl"), binary_stl(1));
  fs::last_write_time(path("m777.stl"), fs::file_time_type::clock::now() - std::chrono::hours(1));
  look();
  const std::vector<std::string> names = look(1.1);
  EXPECT_THAT(names, SizeIs(2000));
  EXPECT_EQ(names.front(), "m777.stl");
}

TEST_F(WatchFolderTest, WhatWasWholeMayNotBeAnyMore) {
  const auto is_still = [&](const char* name) {
    return watch_->is_still_whole(path(name), now_s_);
  };
  for (const char* name :
       {"same.stl", "rewritten.stl", "open.stl", "gone.stl", "settings.stl", "late.stl"})
    write(path(name), binary_stl(3));
  write(path("settings.stl.toml"), "scale = 2\n");
  look();
  ASSERT_THAT(look(1.1), SizeIs(6));
  for (const char* name : {"same.stl", "rewritten.stl", "settings.stl"})
    EXPECT_TRUE(is_still(name));
  now_s_ += 5;
  write(path("rewritten.stl"), binary_stl(2));
  const std::ofstream writer(path("open.stl"), std::ios::app);
  fs::remove(path("gone.stl"));
  write(path("settings.stl.toml"), "scale = 30\n");
  write(path("late.stl.toml"), "scale = 2\n");
  EXPECT_TRUE(is_still("same.stl"));
  for (const char* name :
       {"rewritten.stl", "open.stl", "gone.stl", "settings.stl", "late.stl", "never.stl"})
    EXPECT_FALSE(is_still(name)) << name;
}

TEST_F(WatchFolderTest, IgnoresWhatIsNoFileAndSaysSoOnce) {
  fs::create_symlink("/etc/passwd", path("link.stl"));
  fs::create_symlink("nowhere", path("dangling.stl"));
  fs::create_directory(path("folder"));
  fs::create_directory(path("done"));
  fs::create_directory(path("failed"));
  ASSERT_EQ(::mkfifo(path("pipe.stl").c_str(), 0600), 0);
  look();
  EXPECT_THAT(look(100), IsEmpty());
  look(100);
  EXPECT_THAT(ignored_, SizeIs(4));
}

TEST_F(WatchFolderTest, DeletedWhileWaiting) {
  write(path("a.stl"), binary_stl(3));
  look();
  fs::remove(path("a.stl"));
  EXPECT_THAT(look(2), IsEmpty());
}

TEST_F(WatchFolderTest, RefusedUntilItIsTimeOrItChanged) {
  write(path("a.stl"), binary_stl(3));
  look();
  EXPECT_THAT(look(1.1), SizeIs(1));
  watch_->refuse(path("a.stl"), now_s_, 30);
  EXPECT_THAT(look(20), IsEmpty());
  EXPECT_THAT(look(11), SizeIs(1));
  watch_->refuse(path("a.stl"), now_s_, 30);
  EXPECT_THAT(look(50), IsEmpty()) << "twice as long the second time";
  EXPECT_THAT(look(11), SizeIs(1));
  watch_->refuse(path("a.stl"), now_s_, 30);
  write(path("a.stl"), binary_stl(4));
  look();
  EXPECT_THAT(look(1.1), SizeIs(1));
}

TEST(WatchFolder, AFolderThatCannotBeMadeIsAnError) {
  const TemporaryFolder folder;
  write(folder.path() / "file", "");
  EXPECT_THROW(WatchFolder(folder.path() / "file/drop", {}), Error);
}

}  // namespace
}  // namespace packmerger
