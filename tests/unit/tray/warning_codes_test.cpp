// docs/JOB_FOLDER.md lists every warning code that the program can give.
#include <gtest/gtest.h>

#include <cstdlib>
#include <regex>

#include "base/files.h"

namespace packmerger {
namespace {

TEST(WarningCodes, AreListedInTheDocs) {
  const char* told = std::getenv("PACKMERGER_SOURCE");
  const fs::path source = told == nullptr ? "." : told;
  const std::string docs = read_file(source / "docs/JOB_FOLDER.md", 1 << 20);
  const std::regex pushed(R"(warnings(\.|->)push_back\(\s*\{\s*"([a-z0-9_]+)\")");
  int codes = 0;
  for (const char* folder : {"src", "printers"})
    for (const auto& entry : fs::recursive_directory_iterator(source / folder)) {
      if (entry.path().extension() != ".cpp") continue;
      const std::string text = read_file(entry.path(), 1 << 20);
      for (std::sregex_iterator found(text.begin(), text.end(), pushed), end; found != end;
           ++found) {
        const std::string code = (*found)[2];
        EXPECT_NE(docs.find("| `" + code + "` |"), std::string::npos)
            << code << " in " << entry.path();
        ++codes;
      }
    }
  EXPECT_GT(codes, 3);
}

}  // namespace
}  // namespace packmerger
