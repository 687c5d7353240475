#include "daemon/keys/look_codes.h"

#include <gtest/gtest.h>

namespace packmerger {
namespace {

TEST(LookCodes, AreTakenOnce) {
  LookCodes codes;
  const std::string code = codes.add(0);
  EXPECT_GE(code.size(), 22u) << "128 bits, six a letter";
  EXPECT_NE(code, codes.add(0));
  EXPECT_FALSE(codes.take("", 1));
  EXPECT_FALSE(codes.take(code + "x", 1));
  EXPECT_TRUE(codes.take(code, 1));
  EXPECT_FALSE(codes.take(code, 1));
}

TEST(LookCodes, GrowOld) {
  LookCodes codes;
  const std::string late = codes.add(0);
  const std::string in_time = codes.add(1);
  EXPECT_FALSE(codes.take(late, LookCodes::kGoodFor_s));
  EXPECT_TRUE(codes.take(in_time, LookCodes::kGoodFor_s));
}

TEST(LookCodes, TheOldestGoes) {
  LookCodes codes;
  const std::string first = codes.add(0);
  std::string last;
  for (int i = 0; i < 8; ++i) last = codes.add(1);
  EXPECT_FALSE(codes.take(first, 2));
  EXPECT_TRUE(codes.take(last, 2));
}

}  // namespace
}  // namespace packmerger
