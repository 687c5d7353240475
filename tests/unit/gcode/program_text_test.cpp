#include "gcode/program_text.h"

#include <gtest/gtest.h>

#include "base/error.h"

namespace packmerger {
namespace {

using namespace std::string_literals;

std::string refusal(std::string bytes) {
  try {
    program_text(std::move(bytes));
  } catch (const Error& error) {
    EXPECT_EQ(error.fault(), Fault::kBadInput);
    EXPECT_FALSE(error.hint().empty());
    return error.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return "";
}

TEST(ProgramText, IsKeptButForItsMarkAndItsLineEnds) {
  EXPECT_EQ(program_text("G28\r\nM84\r\n"), "G28\r\nM84\r\n");
  EXPECT_EQ(program_text("\xEF\xBB\xBF; a\nG28\n"), "; a\nG28\n");
  EXPECT_EQ(program_text("G28\rM84\r"), "G28\nM84\n");
  EXPECT_EQ(program_text("; gr\xfc\xdf dich\nG28"), "; gr\xfc\xdf dich\nG28");  // Latin-1
  EXPECT_EQ(program_text(""), "");
}

TEST(ProgramText, OtherFilesAreNamed) {
  for (const auto& [bytes, words] : std::vector<std::pair<std::string, const char*>>{
           {"GCDE\1\0"s, "bgcode"},
           {"\x1f\x8b\x08\0"s, "gzip"},
           {"BZh91AY", "bzip2"},
           {"\xFD"s + "7zXZ", "xz"},
           {"\xFF\xFEG\0"s, "UTF-16"},
           {"\xFE\xFF\0G"s, "UTF-16"},
           {"G\0002\0008\0\n\0M\0008\0004\0"s, "UTF-16"},
           {"PK\3\4", "damaged"},
           {"\x99\0\0\0\0a\0"s, "binary data"},
           {"<html>", "web page"}})
    EXPECT_NE(refusal(bytes).find(words), std::string::npos) << words << ": " << refusal(bytes);
}

TEST(ProgramText, NoArchiveHoldsNoPlates) {
  EXPECT_TRUE(sliced_plates("G28\n").empty());
  EXPECT_TRUE(sliced_plates("").empty());
}

}  // namespace
}  // namespace packmerger
