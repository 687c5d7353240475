#include "base/time/read_duration.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "base/time/duration.h"

namespace packmerger {
namespace {

TEST(Duration, AsPeopleWriteIt) {
  for (const auto& [text, seconds] :
       {std::pair{"6h23m", 22980.0}, std::pair{"6 h 23 min 10 s", 22990.0},
        std::pair{"1d 2h", 93600.0}, std::pair{"1.5h", 5400.0}, std::pair{"383min", 22980.0},
        std::pair{"90s", 90.0}, std::pair{"6:23:10", 22990.0}, std::pair{"6:23", 22980.0},
        std::pair{"100:00", 360000.0}, std::pair{" 2 days ", 172800.0}, std::pair{"0h5m", 300.0}}) {
    EXPECT_TRUE(read_duration(text)) << text;
    EXPECT_DOUBLE_EQ(read_duration(text).value_or(0), seconds) << text;
  }
}

TEST(Duration, WhatIsNone) {
  for (const char* text : {"",         " ",
                           "6",        "23",
                           "6.23.0",   "6h23",
                           "23m6h",    "6h6h",
                           "-6h",      "6:60",
                           "6:23:60",  "6:",
                           ":23",      "1:2:3:4",
                           "h",        "6 fortnights",
                           "1e3s",     "nan",
                           "inf",      "0s",
                           "0:00",     "6,5h",
                           "1..5h",    ".5h",
                           "6h 23m x", "99999999999d",
                           "6.5:30"})
    EXPECT_FALSE(read_duration(text)) << text;
}

TEST(Duration, ReadsWhatDurationTextWrites) {
  EXPECT_TRUE(rc::check([] {
    const int seconds = *rc::gen::inRange(1, 10'000'000);
    RC_ASSERT(read_duration(duration_text(seconds)) == std::optional<double>(seconds));
  }));
}

}  // namespace
}  // namespace packmerger
