#include "notify/dead_letters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/files.h"

namespace packmerger {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

TEST(DeadLetters, KeepOneObjectALine) {
  const TemporaryFolder folder;
  DeadLetters dead(folder.path() / "dead");
  EXPECT_TRUE(dead.keep("http://x/", "HTTP 500", R"({"a": 1})"));
  EXPECT_TRUE(dead.keep("http://x/", "gone", "no JSON \xff"));
  const std::string text = read_file(folder.path() / "dead", 1 << 20);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2);
  EXPECT_THAT(text, HasSubstr(R"("message":{"a":1})"));
  EXPECT_THAT(text, HasSubstr(R"("why":"HTTP 500")"));
}

TEST(DeadLetters, TakeTwoMebibytesAtMost) {
  const TemporaryFolder folder;
  DeadLetters dead(folder.path() / "dead");
  const std::string body = "\"" + std::string(100000, 'x') + "\"";
  for (int i = 0; i < 50; ++i) EXPECT_TRUE(dead.keep("http://x/", "gone", body));
  EXPECT_LE(fs::file_size(folder.path() / "dead"), 1U << 20);
  EXPECT_LE(fs::file_size(folder.path() / "dead.old"), 1U << 20);
  EXPECT_THAT(read_file(folder.path() / "dead", 1 << 20), EndsWith("\n"));
}

TEST(DeadLetters, TellWhereTheyCannotBeKept) {
  DeadLetters dead("/nonexistent/dead");
  EXPECT_FALSE(dead.keep("http://x/", "gone", "{}"));
}

}  // namespace
}  // namespace packmerger
