#include "gcode/gcode_line.h"

#include <gtest/gtest.h>

#include <string>

namespace packmerger {
namespace {

GcodeLine marlin(std::string_view text) { return {text, GcodeRules::kMarlin}; }
GcodeLine gpx(std::string_view text) { return {text, GcodeRules::kGpx}; }

TEST(GcodeLine, TakesALineApart) {
  const GcodeLine line = gpx("N12 g1 X-1.5 Y .25 (a comment X99) E+2 F1200*71 ; more");
  EXPECT_TRUE(line.is('G', 1));
  EXPECT_EQ(line.value('X'), -1.5);
  EXPECT_EQ(line.value('Y'), 0.25);
  EXPECT_EQ(line.value('E'), 2);
  EXPECT_EQ(line.value('F'), 1200);
  EXPECT_FALSE(line.has('Z'));
  EXPECT_TRUE(line.readable());
  EXPECT_EQ(marlin("N7 G1X-1.5Y.25*33").value('Y'), 0.25);
}

TEST(GcodeLine, WordsAloneSubCodesAndText) {
  const GcodeLine home = marlin("G28 X Y");
  EXPECT_TRUE(home.has('X'));
  EXPECT_FALSE(home.value('X'));
  EXPECT_EQ(marlin("G92.1").sub_number(), 1);
  EXPECT_FALSE(marlin("G92.1").is('G', 92));
  EXPECT_TRUE(marlin("").is_empty());
  EXPECT_TRUE(marlin("; G1 X5").is_empty());
  EXPECT_EQ(marlin("T1").letter(), 'T');
  EXPECT_FALSE(marlin("G1 X5 #3").readable());
  EXPECT_FALSE(marlin("hello").readable());
  EXPECT_FALSE(marlin("G2 X5 I" + std::string(200, '9')).readable());
}

// Marlin reads words between brackets, gpx does not; most Marlins pass over small letters.
TEST(GcodeLine, WhatFirmwaresReadDifferentlyIsUnreadable) {
  EXPECT_TRUE(gpx("G1 X5 (Y9)").readable());
  EXPECT_FALSE(marlin("G1 X5 (Y9)").readable());
  EXPECT_TRUE(marlin("(**** start ****) ; G1").is_empty());
  EXPECT_FALSE(marlin("(a) G1 X5").readable());
  EXPECT_TRUE(gpx("g1 x5").readable());
  EXPECT_FALSE(marlin("g1 x5").readable());
}

}  // namespace
}  // namespace packmerger
