#include "notify/webhook.h"

#include <curl/curl.h>
#include <openssl/hmac.h>
#include <poll.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <deque>
#include <memory>
#include <random>
#include <utility>

#include "base/names.h"
#include "base/time/backoff.h"

namespace packmerger {
namespace {

constexpr double kFarewell_s = 2;
constexpr int kDoublings = 6;
constexpr double kLongestWish_s = 3600;     // of a receiver, by Retry-After
constexpr std::size_t kMostAnswer = 65536;  // bytes, of which nothing is kept

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string hex(const unsigned char* bytes, std::size_t count) {
  constexpr std::string_view kHex = "0123456789abcdef";
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += {kHex[bytes[i] >> 4], kHex[bytes[i] & 15]};
  return text;
}

std::string new_delivery() {
  std::random_device random;
  std::array<unsigned char, 16> bytes;
  for (unsigned char& byte : bytes) byte = static_cast<unsigned char>(random());
  return hex(bytes.data(), bytes.size());
}

std::size_t swallow(char*, std::size_t size, std::size_t count, void* taken) {
  auto& total = *static_cast<std::size_t*>(taken);
  total += size * count;
  return total > kMostAnswer ? 0 : size * count;
}

int is_to_end(void* ends_s, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
  return now_s() > *static_cast<const std::atomic<double>*>(ends_s) ? 1 : 0;
}

// Whether another try may help.
bool may_pass(long status) { return status == 408 || status == 429 || status >= 500; }

}  // namespace

std::string webhook_signature(const std::string& secret, const std::string& body) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> bytes;
  unsigned size = 0;
  HMAC(EVP_sha256(), secret.data(), static_cast<int>(secret.size()),
       reinterpret_cast<const unsigned char*>(body.data()), body.size(), bytes.data(), &size);
  return "sha256=" + hex(bytes.data(), size);
}

std::string webhook_place(const std::string& url) {
  const std::size_t begin = url.find("://") == std::string::npos ? 0 : url.find("://") + 3;
  const std::size_t end = std::min(url.find_first_of("/?#", begin), url.size());
  const std::size_t user = url.rfind('@', end);
  const std::size_t host = user != std::string::npos && user >= begin ? user + 1 : begin;
  return printable(url.substr(0, begin) + url.substr(host, end - host));
}

struct Webhook::Letter {
  std::string body;
  std::string delivery;
  int tries = 0;
};

// One connection, kept from message to message.
struct Webhook::Courier {
  std::unique_ptr<CURL, void (*)(CURL*)> curl{curl_easy_init(), curl_easy_cleanup};

  // Empty: it was taken. Otherwise why not, and whether to try again.
  struct Outcome {
    std::string why;
    std::string kind;  // without what differs from one attempt to the next
    bool again = false;
    bool is_got = false;  // the receiver had the message, or part of it
    double wish_s = 0;    // no earlier, it said
  };

  Outcome bring(const Letter& letter, const Webhook& hook) {
    if (curl == nullptr) return {"out of memory", "out of memory", true, false, 0};
    curl_slist* list = nullptr;
    const auto add = [&](const std::string& line) { list = curl_slist_append(list, line.c_str()); };
    add("Content-Type: application/json");
    add("X-PackMerger-Delivery: " + letter.delivery);
    add("Expect:");
    if (const std::string& secret = hook.settings_.secret; !secret.empty())
      add("X-PackMerger-Signature: " + webhook_signature(secret, letter.body));
    const std::unique_ptr<curl_slist, void (*)(curl_slist*)> headers(list, curl_slist_free_all);
    std::size_t taken = 0;
    std::array<char, CURL_ERROR_SIZE> trouble{};
    CURL* handle = curl.get();
    curl_easy_setopt(handle, CURLOPT_URL, hook.settings_.url.c_str());
    curl_easy_setopt(handle, CURLOPT_PROTOCOLS_STR, "http,https");
    curl_easy_setopt(handle, CURLOPT_USERAGENT, "PackMerger");
    curl_easy_setopt(handle, CURLOPT_HTTPHEADER, list);
    curl_easy_setopt(handle, CURLOPT_POSTFIELDSIZE_LARGE,
                     static_cast<curl_off_t>(letter.body.size()));
    curl_easy_setopt(handle, CURLOPT_POSTFIELDS, letter.body.c_str());
    curl_easy_setopt(handle, CURLOPT_FOLLOWLOCATION, 0L);
    curl_easy_setopt(handle, CURLOPT_TIMEOUT_MS, static_cast<long>(1000 * hook.limits_.answer_s));
    curl_easy_setopt(handle, CURLOPT_NOSIGNAL, 1L);
    curl_easy_setopt(handle, CURLOPT_ERRORBUFFER, trouble.data());
    curl_easy_setopt(handle, CURLOPT_WRITEFUNCTION, swallow);
    curl_easy_setopt(handle, CURLOPT_WRITEDATA, &taken);
    curl_easy_setopt(handle, CURLOPT_NOPROGRESS, 0L);
    curl_easy_setopt(handle, CURLOPT_XFERINFOFUNCTION, is_to_end);
    curl_easy_setopt(handle, CURLOPT_XFERINFODATA, &hook.ends_s_);
    const CURLcode code = curl_easy_perform(handle);
    curl_easy_setopt(handle, CURLOPT_ERRORBUFFER, nullptr);
    long status = 0;
    curl_easy_getinfo(handle, CURLINFO_RESPONSE_CODE, &status);
    const bool is_whole = code == CURLE_OK || code == CURLE_WRITE_ERROR;  // a long answer is one
    if (is_whole && status >= 200 && status < 300) return {};
    const std::string refused = "HTTP " + std::to_string(status);
    curl_off_t wish_s = 0;
    curl_easy_getinfo(handle, CURLINFO_RETRY_AFTER, &wish_s);
    if (is_whole)
      return {refused, refused, may_pass(status), true,
              std::min(static_cast<double>(wish_s), kLongestWish_s)};
    curl_off_t sent = 0;
    curl_easy_getinfo(handle, CURLINFO_SIZE_UPLOAD_T, &sent);
    const std::string kind = curl_easy_strerror(code);
    return {trouble[0] != 0 ? trouble.data() : kind, kind, true, sent > 0, 0};
  }
};

Webhook::Webhook(WebhookSettings settings, DeadLetters& dead, TellLine tell, WebhookLimits limits)
    : settings_(std::move(settings)), dead_(dead), tell_(std::move(tell)), limits_(limits) {
  curl_global_init(CURL_GLOBAL_DEFAULT);
  thread_ = std::thread([this] { run(); });
}

Webhook::~Webhook() {
  ends_s_ = now_s() + kFarewell_s;
  queue_.close();
  thread_.join();
  curl_global_cleanup();
}

void Webhook::run() {
  Courier courier;
  std::deque<Letter> waiting;
  double next_s = 0;
  int failures = 0;  // of the receiver, one after the other, whichever message it was
  std::string told;  // the kind of what was told last; empty: it takes messages
  bool told_lost = false;
  const auto tell = [&, place = webhook_place(settings_.url)](const std::string& what) {
    tell_("webhook " + place + ": " + what);
  };
  const auto give_up = [&](const std::string& why) {
    if (!dead_.keep(settings_.url, why, waiting.front().body) && !std::exchange(told_lost, true))
      tell("what cannot be delivered cannot be kept either");
    waiting.pop_front();
  };
  for (;;) {
    const bool ends = queue_.closed();
    while (std::optional<Notice> notice = queue_.try_pop())
      waiting.push_back({std::move(notice->body), new_delivery()});
    while (waiting.size() > limits_.most_waiting) give_up("too many messages waited");
    if (ends && (waiting.empty() || failures > 0 || now_s() > ends_s_)) break;
    const double wait_s = waiting.empty() ? 1e6 : next_s - now_s();
    if (wait_s > 0) {
      pollfd news{queue_.fd(), POLLIN, 0};
      ::poll(&news, 1, static_cast<int>(std::min(1000 * wait_s, 1e9)) + 1);
      continue;
    }
    Letter& letter = waiting.front();
    const Courier::Outcome outcome = courier.bring(letter, *this);
    if (outcome.why.empty()) {
      if (!std::exchange(told, {}).empty()) tell("answers again");
      failures = 0;
      standing_.works();
      waiting.pop_front();
      continue;
    }
    if (std::exchange(told, outcome.kind) != outcome.kind) tell(outcome.why);
    if (!outcome.again) failures = 0;  // it is there, and wants others
    const double pause_s =
        outcome.again
            ? std::max(backoff_s(limits_.first_retry_s, failures++, kDoublings), outcome.wish_s)
            : 0;
    next_s = now_s() + pause_s;
    standing_.failed(outcome.why, pause_s);
    if (outcome.is_got && (++letter.tries >= limits_.tries || !outcome.again)) give_up(outcome.why);
  }
  while (!waiting.empty()) give_up("the daemon ended");
}

}  // namespace packmerger
