#include "gcode/known_codes.h"

#include <gtest/gtest.h>

#include "gcode/gcode_motion.h"

namespace packmerger {
namespace {

bool followed(std::string_view text, GcodeRules rules = GcodeRules::kMarlin) {
  GcodeMotion motion(rules);
  motion.follow(GcodeLine("G28", rules));
  return !motion.follow(GcodeLine(text, rules)).doubt;
}

// What moves by itself, changes a scale, the origin or a limit, or starts other commands.
TEST(KnownCodes, AreNotJudgedWhereNobodyKnows) {
  for (const char* text :
       {"G5 X1 Y1", "G12",       "G26",     "G27",          "G30",          "G33",     "G34",
        "G38.2 Z0", "G42 I1",    "G53 X5",  "G54",          "G60",          "G61",     "G68",
        "G92.1",    "G425",      "G900",    "M92 X80",      "M92 Z400 E90", "M125",    "M121",
        "M149 F",   "M206 X10",  "M211 S0", "M218 T1 X5",   "M23 a.g",      "M24",     "M32 a.g",
        "M26 S0",   "M290 Z0.1", "M302 S0", "M303 E0 S200", "M350 X16",     "M401",    "M410",
        "M425",     "M428",      "M48",     "M500",         "M501",         "M502",    "M600",
        "M605 S2",  "M666 X1",   "M701",    "M808 L5",      "M808",         "M810 G1", "M851 Z1",
        "M999",     "M1234",     "M104.5"})
    EXPECT_FALSE(followed(text)) << text;
}

TEST(KnownCodes, OfEverySlicerAreFollowed) {
  for (const char* text : {"G4 P1",
                           "G21",
                           "G29",
                           "G80",
                           "G10",
                           "G11",
                           "M73 P5 R10",
                           "M82",
                           "M83",
                           "M84",
                           "M104 S200",
                           "M105",
                           "M106 S255",
                           "M107",
                           "M109 S200",
                           "M117 X5 is reached",
                           "M140 S60",
                           "M190 S60",
                           "M201 X500 Y500",
                           "M203 X200",
                           "M204 P500",
                           "M205 X8",
                           "M220 S100",
                           "M221 S95",
                           "M92 E93",
                           "M211",
                           "M211 S1",
                           "M300 S440 P50",
                           "M400",
                           "M412 S1",
                           "M420 S1",
                           "M486 S3",
                           "M862.3 P \"MK3S\"",
                           "M900 K0.05",
                           "M907 E538",
                           "T0"})
    EXPECT_TRUE(followed(text)) << text;
}

TEST(KnownCodes, OfAReplicatorAreItsOwn) {
  for (const char* text :
       {"G130 X20", "M132 X Y Z A B", "M133 T0", "M136", "M72 P1", "M116", "M101", "M108 R0"})
    EXPECT_TRUE(followed(text, GcodeRules::kGpx)) << text;
  for (const char* text :
       {"G10 P1 X5", "G54", "G29", "M131 X", "M322 Z5", "M108 R5", "M999", "G92.1", "M206 X1"})
    EXPECT_FALSE(followed(text, GcodeRules::kGpx)) << text;
  EXPECT_FALSE(followed("M132 X Y Z A B"));
}

}  // namespace
}  // namespace packmerger
