#include "daemon/keys/key_ring.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "base/error.h"
#include "base/files.h"

namespace packmerger {
namespace {

TEST(KeyRing, KnowsItsKeysAgain) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "keys.json";
  KeyRing keys(file);
  EXPECT_TRUE(keys.empty());
  const std::string mine = keys.add("my browser");
  const std::string other = keys.add("slicer");
  EXPECT_NE(mine, other);
  EXPECT_EQ(keys.find(mine)->name, "my browser");
  const KeyRing again(file);
  EXPECT_EQ(again.find(other)->name, "slicer");
  EXPECT_FALSE(again.find(other)->looks_only);
  EXPECT_EQ(again.list().size(), 2u);
}

TEST(KeyRing, KeepsNoKeysText) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "keys.json";
  const std::string key = KeyRing(file).add("me");
  EXPECT_EQ(read_file(file, 1 << 20).find(key), std::string::npos);
  EXPECT_EQ(read_file(file, 1 << 20).find(key.substr(3)), std::string::npos);
}

TEST(KeyRing, KeysAreLongAndNeverTheSame) {
  const TemporaryFolder folder;
  KeyRing keys(folder.path() / "keys.json");
  std::set<std::string> seen;
  for (int i = 0; i < 50; ++i) {
    const std::string key = keys.add(std::to_string(i));
    EXPECT_EQ(key.size(), 3u + 43u);  // 256 bits, six a letter
    EXPECT_TRUE(seen.insert(key).second);
  }
}

TEST(KeyRing, WrongAndRevokedKeysOpenNothing) {
  const TemporaryFolder folder;
  KeyRing keys(folder.path() / "keys.json");
  std::string key = keys.add("me");
  for (const std::string& wrong :
       {std::string(), key.substr(1), key + "x", key.substr(0, 45) + "~"})
    EXPECT_FALSE(keys.find(wrong)) << wrong;
  keys.revoke("me");
  EXPECT_FALSE(keys.find(key));
  EXPECT_THROW(keys.revoke("me"), Error);
}

TEST(KeyRing, ACodeMakesAKeyThatOnlyLooks) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "keys.json";
  KeyRing keys(file);
  const std::string code = keys.add_code(0);
  EXPECT_FALSE(keys.look("guess", 1));
  const std::optional<std::string> key = keys.look(code, 1);
  ASSERT_TRUE(key);
  EXPECT_TRUE(key->starts_with("pm_look_"));
  EXPECT_FALSE(keys.look(code, 1)) << "it was used";
  const KeyRing again(file);
  ASSERT_TRUE(again.find(*key));
  EXPECT_TRUE(again.find(*key)->looks_only);
  EXPECT_TRUE(again.empty()) << "nobody can change anything yet";
  keys.revoke(again.find(*key)->name);
  EXPECT_FALSE(keys.find(*key));
}

TEST(KeyRing, OldPagesMakeRoomForNewOnesAndKeysStay) {
  const TemporaryFolder folder;
  KeyRing keys(folder.path() / "keys.json");
  const std::string mine = keys.add("page 3");
  const std::string first = *keys.look(keys.add_code(0), 0);
  std::string last;
  for (int i = 0; i < 20; ++i) last = *keys.look(keys.add_code(0), 0);
  EXPECT_EQ(keys.list().size(), 21u);
  EXPECT_FALSE(keys.find(first));
  EXPECT_TRUE(keys.find(last));
  EXPECT_TRUE(keys.find(mine));
}

TEST(KeyRing, RefusesNamesThatAreTakenOrOdd) {
  const TemporaryFolder folder;
  KeyRing keys(folder.path() / "keys.json");
  keys.add("me");
  for (const std::string& name : {std::string("me"), std::string(), std::string("<b>"),
                                  std::string("a\nb"), std::string(65, 'a')})
    EXPECT_THROW(keys.add(name), Error) << name;
}

TEST(KeyRing, ADamagedListIsNotAnEmptyOne) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "keys.json";
  for (const char* text : {"", "{", "{}", "[1]", R"([{"name": "a"}])",
                           R"([{"name": 1, "sha256": "", "made_s": 0}])"}) {
    std::ofstream(file) << text;
    EXPECT_THROW(KeyRing{file}, Error) << text;
  }
}

}  // namespace
}  // namespace packmerger
