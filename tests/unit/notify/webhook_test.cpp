#include "notify/webhook.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <mutex>

#include "base/files.h"
#include "http/server.h"
#include "notify/mqtt.h"

namespace packmerger {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(Webhook, SignsAsRfc4231SaysInItsSecondTest) {
  EXPECT_EQ(webhook_signature("Jefe", "what do ya want for nothing?"),
            "sha256=5bdcc146bf60754e6a042426089575c75a003f089d2739839dec58b964ec3843");
}

TEST(Mqtt, AddressesHaveTheUsualPort) {
  const auto address = [](const std::string& broker, bool tls) {
    MqttSettings settings;
    settings.broker = broker;
    settings.tls = tls;
    return mqtt_address(settings);
  };
  EXPECT_EQ(address("a.example", false), "tcp://a.example:1883");
  EXPECT_EQ(address("a.example", true), "ssl://a.example:8883");
  EXPECT_EQ(address("a.example:99", true), "ssl://a.example:99");
  EXPECT_EQ(address("[::1]", false), "tcp://[::1]:1883");
  EXPECT_EQ(address("[::1]:5", false), "tcp://[::1]:5");
}

// Answers with the statuses it is given, then with 200.
struct Receiver {
  std::mutex mutex;
  std::vector<int> statuses;
  std::vector<std::string> bodies;
  HttpServer server{"127.0.0.1", 0,
                    HttpHandler{[](const HttpRequest&) { return TakeText{1 << 20}; },
                                [this](HttpRequest& request) { return answer(request); }}};

  HttpReply answer(const HttpRequest& request) {
    const std::lock_guard lock(mutex);
    bodies.push_back(request.body);
    HttpReply reply;
    if (statuses.empty()) return reply;
    reply.status = statuses.front();
    statuses.erase(statuses.begin());
    return reply;
  }
  std::vector<std::string> got() {
    const std::lock_guard lock(mutex);
    return bodies;
  }
  std::string url() const { return "http://127.0.0.1:" + std::to_string(server.port()) + "/"; }
};

bool wait_for_bodies(Receiver& receiver, std::size_t count) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (std::chrono::steady_clock::now() < end) {
    if (receiver.got().size() >= count) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

constexpr WebhookLimits kFast = {
    .answer_s = 5, .first_retry_s = 0.01, .tries = 3, .most_waiting = 10};

TEST(Webhook, GivesUpAfterItsTriesAndGoesOn) {
  const TemporaryFolder folder;
  DeadLetters dead(folder.path() / "dead");
  Receiver receiver;
  receiver.statuses = {500, 500, 500};
  {
    Webhook webhook(
        {receiver.url(), ""}, dead, [](const std::string&) {}, kFast);
    webhook.push({"t", "1"});
    webhook.push({"t", "2"});
    EXPECT_TRUE(wait_for_bodies(receiver, 4));
  }
  EXPECT_THAT(receiver.got(), ElementsAre("1", "1", "1", "2"));
  EXPECT_THAT(read_file(folder.path() / "dead", 1 << 20), HasSubstr("HTTP 500"));
}

TEST(Webhook, ATroubleIsToldOnceAndAgainWhenItChangesOrEnds) {
  const TemporaryFolder folder;
  DeadLetters dead(folder.path() / "dead");
  Receiver receiver;
  receiver.statuses = {500, 500, 503, 503, 503};
  std::vector<std::string> told;  // by the webhook's thread alone
  {
    Webhook webhook({receiver.url(), ""}, dead,
                    [&](const std::string& line) { told.push_back(line); },
                    {.answer_s = 5, .first_retry_s = 0.01, .tries = 9, .most_waiting = 10});
    webhook.push({"t", "1"});
    EXPECT_TRUE(wait_for_bodies(receiver, 6));
  }
  EXPECT_THAT(
      told, ElementsAre(HasSubstr("HTTP 500"), HasSubstr("HTTP 503"), HasSubstr("answers again")));
}

TEST(Webhook, OnlyThePlaceOfAnAddressIsShown) {
  EXPECT_EQ(webhook_place("https://user:pass@host.example:8443/hook/T0KEN?key=1"),
            "https://host.example:8443");
  EXPECT_EQ(webhook_place("http://host.example?key=a@b"), "http://host.example");
  EXPECT_EQ(webhook_place("http://[::1]:80/a@b"), "http://[::1]:80");
  EXPECT_EQ(webhook_place("http://a\nb/"), "http://a?b");

  const TemporaryFolder folder;
  DeadLetters dead(folder.path() / "dead");
  fs::create_directory(folder.path() / "dead");  // so that nothing can be kept there
  Receiver receiver;
  receiver.statuses = {500, 400};
  std::vector<std::string> told;  // by the webhook's thread alone
  {
    Webhook webhook(
        {receiver.url() + "hook/T0KEN?key=K3Y", ""}, dead,
        [&](const std::string& line) { told.push_back(line); }, kFast);
    for (const char* body : {"1", "2"}) webhook.push({"t", body});
    EXPECT_TRUE(wait_for_bodies(receiver, 3));
  }
  const std::string place = "webhook http://127.0.0.1:" + std::to_string(receiver.server.port());
  EXPECT_THAT(told, ElementsAre(place + ": HTTP 500", place + ": HTTP 400",
                                HasSubstr(place + ": what cannot be delivered"),
                                place + ": answers again"));
}

// Pauses of 20, 40, 80, 160 and 320 ms: were they each message's own, three tries of five messages
// would take 5 · 60 ms.
TEST(Webhook, ThePausesAreTheReceiversAndNotEachMessages) {
  const TemporaryFolder folder;
  DeadLetters dead(folder.path() / "dead");
  Receiver receiver;
  receiver.statuses = std::vector<int>(15, 500);
  const auto begun = std::chrono::steady_clock::now();
  Webhook webhook({receiver.url(), ""}, dead, [](const std::string&) {},
                  {.answer_s = 5, .first_retry_s = 0.02, .tries = 3, .most_waiting = 10});
  for (int i = 0; i < 5; ++i) webhook.push({"t", std::to_string(i)});
  EXPECT_TRUE(wait_for_bodies(receiver, 6));
  EXPECT_GE(std::chrono::steady_clock::now() - begun, std::chrono::milliseconds(600));
  EXPECT_EQ(receiver.got().at(3), "1") << "the first one is given up";
}

TEST(Webhook, ItsTroubleIsSeenUntilItTakesAMessage) {
  const TemporaryFolder folder;
  DeadLetters dead(folder.path() / "dead");
  Receiver receiver;
  receiver.statuses = {500, 500};
  Webhook webhook({receiver.url(), ""}, dead, [](const std::string&) {},
                  {.answer_s = 5, .first_retry_s = 0.5, .tries = 9, .most_waiting = 10});
  EXPECT_FALSE(webhook.trouble());
  webhook.push({"t", "1"});
  std::optional<Trouble> seen;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (!(seen = webhook.trouble()) && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->what, "HTTP 500");
  EXPECT_GE(seen->next_s, seen->since_s + 0.5);
  EXPECT_TRUE(wait_for_bodies(receiver, 3));
  while (webhook.trouble() && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_FALSE(webhook.trouble());
}

TEST(Webhook, AReceiverThatCannotBeReachedUsesUpNoMessages) {
  const TemporaryFolder folder;
  DeadLetters dead(folder.path() / "dead");
  {
    Webhook webhook({"http://127.0.0.1:1/", ""}, dead, [](const std::string&) {},
                    {.answer_s = 5, .first_retry_s = 0.01, .tries = 2, .most_waiting = 10});
    webhook.push({"t", "1"});
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    const auto tries = [&] { return webhook.trouble().value_or(Trouble{}).tries; };
    while (tries() < 4 && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    EXPECT_GE(tries(), 4);
    EXPECT_FALSE(fs::exists(folder.path() / "dead")) << "it waits";
  }
  EXPECT_THAT(read_file(folder.path() / "dead", 1 << 20), HasSubstr("the daemon ended"));
}

TEST(Webhook, TheOldestGoWhenTooManyWait) {
  const TemporaryFolder folder;
  DeadLetters dead(folder.path() / "dead");
  {
    Webhook webhook({"http://127.0.0.1:1/", ""}, dead, [](const std::string&) {},
                    {.answer_s = 5, .first_retry_s = 1000, .tries = 3, .most_waiting = 10});
    for (int i = 0; i < 100; ++i) webhook.push({"t", std::to_string(i)});
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
  }
  const std::string text = read_file(folder.path() / "dead", 1 << 20);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 100) << "nothing is lost without a word";
  EXPECT_THAT(text, HasSubstr("too many messages waited"));
}

TEST(Webhook, EndsSoonAlthoughNobodyAnswers) {
  const TemporaryFolder folder;
  DeadLetters dead(folder.path() / "dead");
  const auto begun = std::chrono::steady_clock::now();
  {
    // a network that swallows what is sent there
    Webhook webhook({"http://192.0.2.1/", ""}, dead, [](const std::string&) {});
    webhook.push({"t", "1"});
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(25));
  EXPECT_THAT(read_file(folder.path() / "dead", 1 << 20), HasSubstr("\"message\":1"));
}

TEST(Webhook, WhatIsRefusedForGoodKeepsNoOtherWhenItEnds) {
  const TemporaryFolder folder;
  DeadLetters dead(folder.path() / "dead");
  Receiver receiver;
  receiver.statuses = {400, 400};
  {
    Webhook webhook({receiver.url(), ""}, dead, [](const std::string&) {});
    for (const char* body : {"1", "2", "3", "4"}) webhook.push({"t", body});
  }
  EXPECT_THAT(receiver.got(), ElementsAre("1", "2", "3", "4"));
  const std::string text = read_file(folder.path() / "dead", 1 << 20);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2);
  EXPECT_EQ(text.find("the daemon ended"), std::string::npos);
}

TEST(Webhook, DeliversWhatWaitsWhenItEnds) {
  const TemporaryFolder folder;
  DeadLetters dead(folder.path() / "dead");
  Receiver receiver;
  {
    Webhook webhook({receiver.url(), ""}, dead, [](const std::string&) {});
    for (const char* body : {"1", "2", "3"}) webhook.push({"t", body});
  }
  EXPECT_THAT(receiver.got(), ElementsAre("1", "2", "3"));
  EXPECT_FALSE(fs::exists(folder.path() / "dead"));
}

}  // namespace
}  // namespace packmerger
