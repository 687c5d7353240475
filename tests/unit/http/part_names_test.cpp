#include "http/part_names.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

namespace packmerger {
namespace {

constexpr const char* kType = "multipart/form-data; boundary=B";

std::string form(const std::string& name, const std::string& content,
                 const std::string& line_end = "\r\n") {
  return "--B" + line_end + "Content-Disposition: form-data; name=\"file\"; filename=\"" + name +
         "\"" + line_end + line_end + content + "\r\n--B--\r\n";
}

std::string passed(const std::string& body, const char* type = kType) {
  return PartNames(type).pass(body);
}

TEST(PartNames, AQuoteBehindABackslashDoesNotEndTheName) {
  EXPECT_EQ(passed(form(R"(a \"b\".stl)", "x")), form("a %22b%22.stl", "x"));
  EXPECT_EQ(passed(form(R"(a\\)", "x")), form(R"(a\\)", "x"))
      << "an escaped backslash, and the end";
  EXPECT_EQ(passed(form(R"(C:\dir\a.stl)", "x")), form(R"(C:\dir\a.stl)", "x"));
  EXPECT_EQ(passed(form(R"(a\"b)", R"(x\"y)", "\n")), form("a%22b", R"(x\"y)", "\n"));
  EXPECT_EQ(name_of_part("a %22b%22.stl"), R"(a "b".stl)");
  EXPECT_EQ(name_of_part("%2522%22"), R"(%2522")");
  EXPECT_EQ(name_of_part("a%2fb%0d%2"), "a%2fb%0d%2") << "nothing else is decoded";
}

TEST(PartNames, TheBoundaryIsFoundHoweverItIsWritten) {
  const std::string body = form(R"(\")", "x");
  for (const char* type : {"multipart/form-data; boundary=\"B\"", "a/b;BOUNDARY=B"})
    EXPECT_EQ(passed(body, type), form("%22", "x")) << type;
  for (const char* type : {"", "multipart/form-data",
                           "multipart/form-data; boundary=", "multipart/form-data; boundary=C"})
    EXPECT_EQ(passed(body, type), body) << type;
}

TEST(PartNames, ContentIsNeverChangedWhereverItIsCut) {
  const auto hostile =
      rc::gen::container<std::string>(rc::gen::elementOf(std::string("\r\n-B\\\"%2x")));
  EXPECT_TRUE(rc::check([&] {
    const std::string content = *hostile;
    RC_PRE(("\r\n" + content + "\r\n--B").find("\r\n--B") == content.size() + 2);
    const std::string body = form(R"(\"n\")", content) + form("m", content);
    const std::string whole = form("%22n%22", content) + form("m", content);
    PartNames names(kType);
    std::string to;
    for (std::size_t at = 0; at < body.size();) {
      const std::size_t count = *rc::gen::inRange<std::size_t>(1, 9);
      to += names.pass(std::string_view(body).substr(at, count));
      at += count;
    }
    RC_ASSERT(to == whole);
  }));
}

TEST(PartNames, NonsenseNeverGrowsBeyondThreeBytesForTwo) {
  EXPECT_TRUE(rc::check([](const std::string& bytes) {
    for (const std::string& start : {std::string(), std::string("--B\r\n")})
      RC_ASSERT(passed(start + bytes).size() <= (start.size() + bytes.size()) * 3 / 2 + 1);
  }));
}

}  // namespace
}  // namespace packmerger
