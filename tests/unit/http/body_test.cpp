// What of an answer is compressed, and what a client that has it already is told.
#include <zlib.h>

#include "http/compress.h"
#include "unit/http/site.h"

namespace packmerger {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

std::string get_with(const std::string& target, const std::string& headers) {
  return "GET " + target + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n" + headers +
         "\r\n";
}

std::string unpacked(const std::string& bytes) {
  std::string out(1 << 22, '\0');
  z_stream stream{};
  EXPECT_EQ(inflateInit2(&stream, 16 + MAX_WBITS), Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
  out.resize(stream.total_out);
  inflateEnd(&stream);
  return out;
}

std::string body_of_reply(const std::string& reply) {
  return reply.substr(reply.find("\r\n\r\n") + 4);
}

std::string header_of(const std::string& reply, const std::string& name) {
  const std::size_t at = reply.find(name + ": ");
  if (at == std::string::npos) return {};
  const std::size_t begin = at + name.size() + 2;
  return reply.substr(begin, reply.find("\r\n", begin) - begin);
}

TEST(Compress, OnlyWhereTheClientTakesIt) {
  for (const auto& [header, expected] :
       {std::pair{"gzip", true}, std::pair{"br, GZIP;q=0.5", true}, std::pair{"deflate,gzip", true},
        std::pair{"gzip;q=0", false}, std::pair{"gzip; q=0.0", false}, std::pair{"br", false},
        std::pair{"", false}, std::pair{"xgzip", false}}) {
    HttpRequest request;
    request.headers.emplace_back("Accept-Encoding", header);
    EXPECT_EQ(takes_gzip(request), expected) << header;
  }
}

TEST(Body, TextsAreCompressedForThoseWhoTakeIt) {
  Site site;
  const std::string text(100000, 'x');
  write_file_whole(site.folder.path() / "there", text);
  const std::string plain = site.ask(get("/file"));
  EXPECT_THAT(plain, EndsWith("\r\n\r\n" + text));
  const std::string packed = site.ask(get_with("/file", "Accept-Encoding: gzip\r\n"));
  EXPECT_LT(packed.size(), 2000u);
  EXPECT_THAT(packed, HasSubstr("Content-Encoding: gzip"));
  EXPECT_THAT(packed, HasSubstr("Vary: Accept-Encoding"));
  EXPECT_EQ(unpacked(body_of_reply(packed)), text);
  EXPECT_THAT(site.ask(get_with("/", "Accept-Encoding: gzip\r\n")), EndsWith("\r\n\r\n{}"))
      << "a small one stays as it is";
}

TEST(Body, AFileIsNotSentAgainWhileItIsTheSame) {
  Site site;
  const fs::path file = site.folder.path() / "there";
  write_file_whole(file, std::string(5000, 'x'));
  for (const std::string encoding : {"", "Accept-Encoding: gzip\r\n"}) {
    const std::string first = site.ask(get_with("/kept", encoding));
    EXPECT_THAT(first, HasSubstr("Cache-Control: private, no-cache"));
    const std::string tag = header_of(first, "ETag");
    ASSERT_FALSE(tag.empty());
    const std::string known = encoding + "If-None-Match: \"other\", " + tag + "\r\n";
    const std::string again = site.ask(get_with("/kept", known));
    EXPECT_THAT(again, StartsWith("HTTP/1.1 304"));
    EXPECT_EQ(header_of(again, "ETag"), tag);
    EXPECT_EQ(body_of_reply(again), "");
    write_file_whole(file, std::string(5000, 'y'));
    EXPECT_THAT(site.ask(get_with("/kept", known)), StartsWith("HTTP/1.1 200"));
  }
}

TEST(Body, WhatIsNotSaidToBeKeptIsNotStored) {
  Site site;
  write_file_whole(site.folder.path() / "there", "x");
  for (const char* target : {"/", "/file"}) {
    const std::string reply = site.ask(get(target));
    EXPECT_THAT(reply, HasSubstr("Cache-Control: no-store")) << target;
    EXPECT_THAT(reply, Not(HasSubstr("ETag"))) << target;
  }
  EXPECT_THAT(site.ask(get("/immutable")), HasSubstr("immutable"));
}

}  // namespace
}  // namespace packmerger
