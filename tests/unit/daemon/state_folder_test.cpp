// Who may look into the state folder, whatever the umask, and what becomes of an earlier version's.
#include "daemon/state_folder.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "base/error.h"
#include "base/files.h"
#include "daemon/keys/key_ring.h"

namespace packmerger {
namespace {

constexpr auto kMask = fs::perms::mask;
constexpr auto kOwner = fs::perms::owner_all;

class StateFolder : public ::testing::TestWithParam<mode_t> {
 protected:
  StateFolder() : umask_(::umask(GetParam())) {}
  ~StateFolder() override { ::umask(umask_); }

  fs::perms mode(const fs::path& path) const { return fs::status(path).permissions() & kMask; }

  const mode_t umask_;
  const TemporaryFolder holder_;
  const fs::path state_ = holder_.path() / "deep/state";
};

TEST_P(StateFolder, ANewOneIsItsOwners) {
  EXPECT_TRUE(furnish_state_folder(state_).empty());
  EXPECT_EQ(mode(state_), kOwner);
  EXPECT_EQ(mode(state_ / "jobs"), kOwner);
  KeyRing(state_ / "keys.json").add("me");
  EXPECT_EQ(mode(state_ / "keys.json"), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_TRUE(furnish_state_folder(state_).empty()) << "a second start finds nothing to tell";
}

TEST_P(StateFolder, ItMayBeNamedWithASlash) {
  EXPECT_TRUE(furnish_state_folder(state_ / "").empty());
  EXPECT_EQ(mode(state_), kOwner);
}

TEST_P(StateFolder, AnEarlierOneIsClosedAndTold) {
  fs::create_directories(state_ / "jobs/1");
  write_file_whole(state_ / "keys.json", "[]");
  for (const fs::path& path : {state_, state_ / "jobs"}) ::chmod(path.c_str(), 0755);
  ::chmod((state_ / "keys.json").c_str(), 0644);
  EXPECT_EQ(furnish_state_folder(state_).size(), 3u);
  EXPECT_EQ(mode(state_ / "jobs"), fs::perms(0750));
  EXPECT_EQ(mode(state_ / "keys.json"), fs::perms(0600));
  EXPECT_EQ(mode(state_), fs::perms(0755)) << "others may drop models below it";
  EXPECT_EQ(furnish_state_folder(state_).size(), 1u);
}

TEST_P(StateFolder, TheGroupOfAServiceMayLookIn) {
  fs::create_directories(state_);
  ::chmod(state_.c_str(), 0750);
  EXPECT_TRUE(furnish_state_folder(state_).empty());
  EXPECT_EQ(mode(state_ / "jobs"), fs::perms(0750 & ~GetParam()));
}

TEST_P(StateFolder, AFileInItsPlaceIsTold) {
  fs::create_directories(state_.parent_path());
  write_file_whole(state_, "");
  EXPECT_THROW(furnish_state_folder(state_), Error);
}

INSTANTIATE_TEST_SUITE_P(Umasks, StateFolder, ::testing::Values(0, 022, 027, 077));

}  // namespace
}  // namespace packmerger
