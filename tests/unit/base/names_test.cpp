#include "base/names.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

namespace packmerger {
namespace {

TEST(Names, WhatATerminalOrPageWouldObeyIsNotShown) {
  EXPECT_EQ(printable("bänd ☃ 熊 🐻.stl"), "bänd ☃ 熊 🐻.stl");
  EXPECT_EQ(printable("a\nb\x1B[2J\x7F"), "a?b?[2J?");
  EXPECT_EQ(printable("cat\u202Elts.exe"), "cat?lts.exe") << "turned round";
  EXPECT_EQ(printable("\u2066a\u2069\u200F\u061C"), "?a???");
  EXPECT_EQ(printable("a\u200Bb\uFEFFc\u2060"), "a?b?c?") << "without width";
  EXPECT_EQ(printable("a\u2028b\u2029"), "a?b?");
  EXPECT_EQ(printable("a\u009Bb\u0085", '_'), "a_b_") << "the second set of controls";
  EXPECT_EQ(printable("\U000E0041"), "?");
  EXPECT_EQ(printable_lines("a\n\tb\r\u202E"), "a\n\tb??");
}

TEST(Names, BytesThatAreNoTextAreNotShown) {
  EXPECT_EQ(printable("a\xFF\xC3"), "a??");
  EXPECT_EQ(printable("\xC0\xAF"), "??") << "a slash in two bytes";
  EXPECT_EQ(printable("\xED\xA0\x80"), "???") << "half a pair";
  EXPECT_EQ(printable("\xE2\x80z"), "??z");
}

TEST(Names, AreCutBetweenCharacters) {
  EXPECT_EQ(first_bytes("äö", 3), "ä");
  EXPECT_EQ(last_bytes("äö", 3), "ö");
  EXPECT_EQ(first_bytes("äö", 4), "äö");
  EXPECT_EQ(first_bytes("🐻", 3), "");
}

TEST(Names, EverySystemCanHold) {
  EXPECT_EQ(portable_name("bär (2).v3"), "bär (2).v3");
  for (const char* device : {"CON", "nul", "Com1", "LPT9.txt", "AUX .tar.gz", "COM\u00B2"})
    EXPECT_EQ(portable_name(device), std::string("_") + device);
  EXPECT_EQ(portable_name("CONE"), "CONE");
  EXPECT_EQ(portable_name("COM10"), "COM10");
  EXPECT_EQ(portable_name("ends. . "), "ends");
  EXPECT_EQ(portable_name("a<b>c:d\"e/f\\g|h?i*j"), "a_b_c_d_e_f_g_h_i_j");
  EXPECT_EQ(portable_name("a\u202Eb"), "a_b");
  EXPECT_EQ(portable_name("..."), "_");
  EXPECT_EQ(portable_name(std::string(149, 'x') + "ä"), std::string(149, 'x'));
}

TEST(Names, OnceSafeStaySafe) {
  EXPECT_TRUE(rc::check([](const std::string& bytes) {
    RC_ASSERT(printable(printable(bytes)) == printable(bytes));
    const std::string name = portable_name(bytes);
    RC_ASSERT(portable_name(name) == name);
    RC_ASSERT(!name.empty() && name.size() <= 151);
  }));
}

}  // namespace
}  // namespace packmerger
