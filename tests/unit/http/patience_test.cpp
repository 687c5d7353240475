// Clients that are too slow.
#include "unit/http/site.h"

namespace packmerger {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

// How long the server bears it, s; 20 s at most.
double endured_s(Client& client, const std::string& bytes_again) {
  const auto begun = std::chrono::steady_clock::now();
  const auto taken_s = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  };
  while (taken_s() < 20 && client.send(bytes_again))
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  return taken_s();
}

HttpLimits impatient() {
  HttpLimits limits;
  limits.patience = {.headers_s = 1, .body_s = 1, .body_bytes_s = 10000};
  return limits;
}

TEST(Patience, EndsHeadersThatComeByteByByte) {
  Site site(impatient());
  Client client(site.server->port());
  client.send("GET / HTTP/1.1\r\nHost: localhost\r\nX: ");
  EXPECT_LT(endured_s(client, "y"), 10);
  EXPECT_TRUE(site.seen.empty());
}

TEST(Patience, EndsRequestLinesThatComeByteByByte) {
  Site site(impatient());
  Client client(site.server->port());
  EXPECT_LT(endured_s(client, "G"), 10);
}

TEST(Patience, EndsBodiesThatComeByteByByte) {
  Site site(impatient());
  Client client(site.server->port());
  client.send("POST /put HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1000000\r\n\r\n");
  EXPECT_LT(endured_s(client, "y"), 10);
  EXPECT_TRUE(site.seen.empty());
}

TEST(Patience, SaysThatItWasTooSlow) {
  Site site(impatient());
  Client client(site.server->port());
  client.send("GET / HTTP/1.1\r\nHost: local");
  EXPECT_THAT(client.rest(), StartsWith("HTTP/1.1 408"));
}

TEST(Patience, BearsBodiesThatAreFastEnough) {
  Site site(impatient());
  Client client(site.server->port());
  client.send(
      "PUT /put HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n"
      "Content-Length: 240000\r\n\r\n");
  for (int i = 0; i < 24; ++i) {  // twice as fast as it must be, for longer than is borne
    ASSERT_TRUE(client.send(std::string(10000, 'y')));
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  EXPECT_THAT(client.rest(), StartsWith("HTTP/1.1 200"));
  ASSERT_EQ(site.contents.size(), 1u);
  EXPECT_EQ(site.contents[0].size(), 240000u);
}

TEST(Patience, BearsAnswersThatTakeLong) {
  Site site(impatient());
  Client client(site.server->port());
  client.send(get("/slow"));
  EXPECT_THAT(client.rest(), HasSubstr("at last"));
}

TEST(Patience, SlowConnectionsDoNotShutOutTheirAddress) {
  HttpLimits limits;
  limits.connections_of_a_peer = 40;
  limits.patience.waiting_of_a_peer = 4;
  Site site(limits);
  std::vector<std::unique_ptr<Client>> slow;
  for (int i = 0; i < 70; ++i) {
    slow.push_back(std::make_unique<Client>(site.server->port()));
    slow.back()->send("GET / HTTP/1.1\r\nHost: local");
    if (i % 10 == 0) {
      EXPECT_THAT(site.ask(get("/")), StartsWith("HTTP/1.1 200")) << i;
    }
  }
  EXPECT_THAT(site.ask(get("/")), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(slow.front()->rest(), StartsWith("HTTP/1.1 408"));
}

}  // namespace
}  // namespace packmerger
