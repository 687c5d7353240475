#include "base/nearest.h"

#include <gtest/gtest.h>

namespace packmerger {
namespace {

TEST(Nearest, IsTheWordThatWasMistyped) {
  const std::vector<std::string> verbs = {"prepare", "compare", "send", "jobs"};
  EXPECT_EQ(nearest("prepre", verbs), "prepare");
  EXPECT_EQ(nearest("COMPARE", verbs), "compare");
  EXPECT_EQ(nearest("sned", verbs), "send") << "two swapped";
  EXPECT_EQ(nearest("job", verbs), "jobs");
  EXPECT_EQ(nearest("print", verbs), std::nullopt);
  EXPECT_EQ(nearest("", verbs), std::nullopt);
  EXPECT_EQ(nearest("x", {}), std::nullopt);
  EXPECT_EQ(nearest(std::string(100000, 'x'), verbs), std::nullopt);
  EXPECT_EQ(did_you_mean("sned", verbs), "Did you mean \"send\"? ");
  EXPECT_EQ(did_you_mean("print", verbs), "");
}

}  // namespace
}  // namespace packmerger
