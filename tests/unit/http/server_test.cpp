#include "http/server.h"

#include <atomic>
#include <fstream>

#include "base/error.h"
#include "unit/http/site.h"

namespace packmerger {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string post(const std::string& target, const std::string& type, const std::string& body) {
  return "POST " + target +
         " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nContent-Type: " + type +
         "\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body;
}

std::string part(const std::string& disposition, const std::string& body) {
  return "--XX\r\nContent-Disposition: form-data; " + disposition + "\r\n\r\n" + body + "\r\n";
}

TEST(HttpServer, AnswersWithWhatTheHandlerSays) {
  Site site;
  const std::string reply = site.ask(get("/a%20b?x=1&y=%C3%BC"));
  EXPECT_THAT(reply, StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(reply, HasSubstr("X-Own: yes"));
  EXPECT_THAT(reply, HasSubstr("\r\n\r\n{}"));
  ASSERT_EQ(site.seen.size(), 1u);
  EXPECT_EQ(site.seen[0].path, "/a b");
  EXPECT_EQ(site.seen[0].query.at("y"), "\xC3\xBC");
  EXPECT_EQ(site.seen[0].header("hOST"), "localhost");
  EXPECT_TRUE(site.seen[0].is_loopback);
  EXPECT_EQ(site.seen[0].peer, "127.0.0.1");
}

TEST(HttpServer, RefusesPathsThatLeadElsewhere) {
  Site site;
  for (const char* target : {"/../etc/passwd", "/%2e%2e/etc/passwd", "/a%2f..%2fb", "//x", "/%00"})
    EXPECT_THAT(site.ask(get(target)), StartsWith("HTTP/1.1 400")) << target;
  EXPECT_TRUE(site.seen.empty());
}

TEST(HttpServer, RefusesBeforeTheBodyIsSent) {
  Site site;
  Client client(site.server->port());
  client.send(
      "POST /refused HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1000000\r\n"
      "Expect: 100-continue\r\n\r\n");
  EXPECT_THAT(client.read_until("no key"), StartsWith("HTTP/1.1 401"));
}

TEST(HttpServer, AsksForTheBodyThatIsAwaited) {
  Site site;
  Client client(site.server->port());
  client.send(
      "POST /text HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5\r\nConnection: close\r\n"
      "Expect: 100-continue\r\n\r\n");
  EXPECT_THAT(client.read_until("\r\n\r\n"), StartsWith("HTTP/1.1 100"));
  client.send("hello");
  EXPECT_THAT(client.rest(), HasSubstr("HTTP/1.1 200"));
  ASSERT_EQ(site.seen.size(), 1u);
  EXPECT_EQ(site.seen[0].body, "hello");
}

TEST(HttpServer, TakesNoMoreTextThanWasPlanned) {
  Site site;
  EXPECT_THAT(site.ask(post("/text", "text/plain", std::string(101, 'x'))),
              StartsWith("HTTP/1.1 413"));
  EXPECT_THAT(site.ask("POST /text HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n"
                       "Transfer-Encoding: chunked\r\n\r\n65\r\n" +
                       std::string(101, 'x') + "\r\n0\r\n\r\n"),
              StartsWith("HTTP/1.1 413"));
  EXPECT_TRUE(site.seen.empty());
}

TEST(HttpServer, FormsGoToTheDisk) {
  Site site;
  const std::string model(300000, 'm');
  const std::string body = part("name=\"print\"", "true") +
                           part("name=\"file\"; filename=\"../../a b.stl\"", model) + "--XX--\r\n";
  const std::string reply = site.ask(post("/form", "multipart/form-data; boundary=XX", body));
  EXPECT_THAT(reply, StartsWith("HTTP/1.1 200"));
  ASSERT_EQ(site.seen.size(), 1u);
  EXPECT_EQ(site.seen[0].form.at("print"), "true");
  ASSERT_EQ(site.seen[0].files.size(), 1u);
  const UploadedFile& file = site.seen[0].files[0];
  EXPECT_EQ(file.field, "file");
  EXPECT_EQ(file.name, "../../a b.stl");
  EXPECT_EQ(file.path.parent_path(), site.folder.path());
  EXPECT_EQ(file.bytes, model.size());
  EXPECT_EQ(site.contents[0], model);
  EXPECT_TRUE(fs::is_empty(site.folder.path())) << "nobody moved the upload away";
}

TEST(HttpServer, AWholeBodyIsAFile) {
  Site site;
  const std::string body(70000, 'g');
  site.ask(
      "PUT /put HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\nContent-Length: 70000\r\n\r\n" +
      body);
  ASSERT_EQ(site.contents.size(), 1u);
  EXPECT_EQ(site.contents[0], body);
}

TEST(HttpServer, RefusesUploadsThatAreTooLarge) {
  Site site;
  site.most_bytes = 1000;
  const std::string large =
      part("name=\"f\"; filename=\"a\"", std::string(2000, 'x')) + "--XX--\r\n";
  EXPECT_THAT(site.ask(post("/form", "multipart/form-data; boundary=XX", large)),
              StartsWith("HTTP/1.1 413"));
  EXPECT_THAT(site.ask("PUT /put HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n"
                       "Transfer-Encoding: chunked\r\n\r\n7d0\r\n" +
                       std::string(2000, 'x') + "\r\n0\r\n\r\n"),
              StartsWith("HTTP/1.1 413"));
  EXPECT_TRUE(site.seen.empty());
  EXPECT_TRUE(fs::is_empty(site.folder.path()));
}

TEST(HttpServer, RefusesUploadsThatTheDiskHasNoRoomFor) {
  HttpLimits limits;
  limits.spare_bytes = std::uint64_t{1} << 60;
  TemporaryFolder folder;
  bool answered = false;
  const HttpServer server("127.0.0.1", 0,
                          {[&](const HttpRequest&) {
                             return TakeUpload{folder.path(), 1 << 20, false};
                           },
                           [&](HttpRequest&) {
                             answered = true;
                             return HttpReply{};
                           }},
                          limits);
  Client client(server.port());
  client.send("PUT /put HTTP/1.1\r\nHost: x\r\nConnection: close\r\nContent-Length: 3\r\n\r\nabc");
  EXPECT_THAT(client.rest(), StartsWith("HTTP/1.1 507"));
  EXPECT_FALSE(answered);
}

TEST(HttpServer, BrokenFormsAreRefused) {
  Site site;
  std::string many;
  for (int i = 0; i < 40; ++i) many += part("name=\"f" + std::to_string(i) + "\"", "1");
  for (const std::string& body :
       {part("name=\"file\"; filename=\"cut short\"", "half of it"), many + "--XX--\r\n",
        part("name=\"long\"", std::string(10000, 'x')) + "--XX--\r\n"}) {
    const std::string reply = site.ask(post("/form", "multipart/form-data; boundary=XX", body));
    EXPECT_THAT(reply, StartsWith("HTTP/1.1 4")) << body.substr(0, 40);
  }
  EXPECT_TRUE(fs::is_empty(site.folder.path()));
}

TEST(HttpServer, SendsFilesButNoLinks) {
  Site site;
  std::ofstream(site.folder.path() / "there") << "content";
  fs::create_symlink("/etc/passwd", site.folder.path() / "link");
  EXPECT_THAT(site.ask(get("/file")), HasSubstr("\r\n\r\ncontent"));
  EXPECT_THAT(site.ask(get("/link")), StartsWith("HTTP/1.1 404"));
}

TEST(HttpServer, HeadersWithoutEndAreCutOff) {
  Site site;
  Client client(site.server->port());
  client.send("GET / HTTP/1.1\r\nHost: localhost\r\nX-Long: ");
  bool taken = true;
  for (int i = 0; i < 1000 && taken; ++i) taken = client.send(std::string(10000, 'a'));
  EXPECT_FALSE(taken);
  EXPECT_TRUE(site.seen.empty());
}

TEST(HttpServer, StreamsUntilNothingComes) {
  std::atomic<int> given = 0;
  const HttpServer server("127.0.0.1", 0,
                          {[](const HttpRequest&) { return TakeText{0}; },
                           [&](HttpRequest&) {
                             HttpReply reply;
                             reply.type = "text/event-stream";
                             reply.next = [&]() -> std::optional<std::string> {
                               if (++given > 3) return std::nullopt;
                               return "data: " + std::to_string(given) + "\n\n";
                             };
                             return reply;
                           }});
  Client client(server.port());
  client.send(get("/events"));
  const std::string reply = client.rest();
  for (const char* text : {"data: 1\n", "data: 2\n", "data: 3\n"})
    EXPECT_THAT(reply, HasSubstr(text));
}

TEST(HttpServer, SaysWhyItCannotListen) {
  const Site site;
  try {
    HttpServer("127.0.0.1", site.server->port(), {});
    FAIL() << "two servers on one port";
  } catch (const Error& error) {
    EXPECT_EQ(error.fault(), Fault::kBusy);
  }
  EXPECT_THROW(HttpServer("localhost", 0, {}), Error);
}

}  // namespace
}  // namespace packmerger
