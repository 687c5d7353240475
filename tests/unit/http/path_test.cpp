#include "http/path.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <sstream>

namespace packmerger {
namespace {

TEST(Path, IsDecodedSegmentBySegment) {
  EXPECT_EQ(decoded_path("/"), "/");
  EXPECT_EQ(decoded_path("/a/b"), "/a/b");
  EXPECT_EQ(decoded_path("/a/"), "/a/");
  EXPECT_EQ(decoded_path("/a%20b/%C3%BC.stl"), "/a b/\xC3\xBC.stl");
}

TEST(Path, WhatCouldLeadElsewhereIsNone) {
  for (const char* path :
       {"", "a", "//", "/a//b", "/.", "/..", "/a/../b", "/%2e%2e/b", "/a%2fb", "/a%5Cb", "/a\\b",
        "/%00", "/a%0d%0ab", "/%", "/%4", "/%zz", "/a/%2E%2e"})
    EXPECT_FALSE(decoded_path(path)) << path;
}

TEST(Path, NeverHoldsAWayUp) {
  EXPECT_TRUE(rc::check([] {
    const auto pieces =
        *rc::gen::container<std::vector<std::string>>(rc::gen::elementOf(std::vector<std::string>{
            "/", ".", "..", "%2e", "%2F", "a", "%", "\\", "%5c", "%00", "%25"}));
    std::string target = "/";
    for (const std::string& piece : pieces) target += piece;
    const std::optional<std::string> path = decoded_path(target);
    if (!path) return;
    RC_ASSERT(path->front() == '/');
    std::istringstream segments(path->substr(1));
    for (std::string segment; std::getline(segments, segment, '/');) {
      RC_ASSERT(segment != "." && segment != "..");
      RC_ASSERT(!segment.empty());
      RC_ASSERT(segment.find('\\') == std::string::npos);
    }
  }));
}

TEST(Path, WhatIsEncodedIsDecodedAgain) {
  EXPECT_EQ(percent_encoded("a b/\xC3\xBC.stl"), "a%20b%2F%C3%BC.stl");
  EXPECT_TRUE(rc::check([](const std::string& text) {
    const std::string encoded = percent_encoded(text);
    RC_ASSERT(encoded.find_first_of("/?#\" \r\n") == std::string::npos);
    const bool is_text = std::none_of(text.begin(), text.end(), [](char c) {
      return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
    });
    RC_ASSERT(percent_decoded(encoded) == (is_text ? std::optional(text) : std::nullopt));
  }));
}

TEST(Query, FirstOfANameCounts) {
  const auto query = decoded_query("a=1&b=%20x&a=2&c&=d&e=%zz&f=");
  const std::map<std::string, std::string> expected = {
      {"a", "1"}, {"b", " x"}, {"c", ""}, {"f", ""}};
  EXPECT_EQ(query, expected);
  EXPECT_TRUE(decoded_query("").empty());
}

}  // namespace
}  // namespace packmerger
