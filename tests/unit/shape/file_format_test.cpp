// The table of formats, and what is held to it: the readers, the words of refusals, the documents.
#include "model/files/file_format.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include "base/error.h"
#include "base/files.h"
#include "shape/read/read_model.h"

namespace packmerger {
namespace {

TEST(FileFormats, EveryModelsEndingHasAReader) {
  for (const FileFormat& format : file_formats()) {
    if (is_program(format.kind)) continue;
    try {
      read_model_bytes("nonsense", format.ending, {});
      FAIL() << format.ending << " was read";
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find("format is not known"), std::string::npos)
          << format.ending;
    }
  }
  EXPECT_THROW(read_model_bytes("nonsense", ".step", {}), Error);
}

TEST(FileFormats, AreKnownByTheirLongestEnding) {
  std::set<std::string_view> endings;
  for (const FileFormat& format : file_formats()) {
    EXPECT_TRUE(endings.insert(format.ending).second) << format.ending << " is there twice";
    EXPECT_EQ(format_of_name("a" + std::string(format.ending)), &format);
  }
  EXPECT_EQ(kind_of_file("plate.GCODE.3MF"), FileKind::kSliced);
  EXPECT_EQ(format_of_name("plate.gcode.stl")->name, "STL");
}

TEST(FileFormats, AreNamedOnce) {
  EXPECT_EQ(model_format_names(" or "), "STL, OBJ, PLY, OFF or 3MF");
  EXPECT_EQ(program_format_names(), "G-code, x3g");
}

// The table of docs/DAEMON: a row's cells are the format, its endings, what it is taken as, and its
// end.
TEST(FileFormats, StandInTheDocuments) {
  const char* source = std::getenv("PACKMERGER_SOURCE");
  if (source == nullptr) GTEST_SKIP() << "PACKMERGER_SOURCE is not set; run it with ctest";
  std::istringstream page(read_file(fs::path(source) / "docs/DAEMON.md", 1 << 20));
  std::set<std::string> told;
  for (std::string line; std::getline(page, line);) {
    std::smatch row;
    if (!std::regex_match(line, row, std::regex(R"(\| (\S+) \| (`\..+`) \| (.*) \| (.*) \|)")))
      continue;
    const std::string endings = row[2];
    const std::regex one("`([^`]+)`");
    for (std::sregex_iterator it(endings.begin(), endings.end(), one), end; it != end; ++it) {
      const FileFormat* format = format_of_name((*it)[1].str());
      ASSERT_NE(format, nullptr) << line;
      EXPECT_EQ(format->ending, (*it)[1].str());
      EXPECT_EQ(format->name, row[1].str());
      EXPECT_EQ(format->kind == FileKind::kModel, row[3] == "model") << line;
      EXPECT_EQ(format->end == FileEnd::kNotTold, row[4] == "its writer closed it") << line;
      told.emplace(format->ending);
    }
  }
  EXPECT_EQ(told.size(), file_formats().size());
}

}  // namespace
}  // namespace packmerger
