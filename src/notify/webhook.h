// Tells one web address of every change, by HTTP POST (libcurl), on a thread of its own.
#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <thread>

#include "base/queue.h"
#include "notify/dead_letters.h"
#include "notify/notice.h"
#include "notify/standing.h"

namespace packmerger {

struct WebhookLimits {
  double answer_s = 30;             // for one try, connecting included
  double first_retry_s = 1;         // doubled after each try in vain, up to 64 times
  int tries = 8;                    // of one message that it got and did not take
  std::size_t most_waiting = 1000;  // the oldest go when there are more
};

// Messages arrive in their order, each at least once; what was tried in vain, refused for good (a
// status from 300 to 499 but for 408 and 429), too much to wait or left when this ends goes to the
// dead letters. A receiver that cannot be reached uses up no tries of a message. The pauses are the
// receiver's: whichever message comes next waits for them, until it takes one. Its Retry-After
// counts, up to an hour. Redirects are not followed.
//
// The headers: Content-Type application/json; X-PackMerger-Delivery, the same for every try of a
// message; with a secret X-PackMerger-Signature: sha256=HEX, the HMAC-SHA256 of the body.
class Webhook {
 public:
  // dead must outlive it.
  Webhook(WebhookSettings settings, DeadLetters& dead, TellLine tell, WebhookLimits limits = {});
  Webhook(const Webhook&) = delete;
  Webhook& operator=(const Webhook&) = delete;
  ~Webhook();  // delivers what waits, for two or three seconds at most

  void push(Notice notice) { queue_.push(std::move(notice)); }

  const WebhookSettings& settings() const { return settings_; }
  std::optional<Trouble> trouble() const { return standing_.trouble(); }  // from any thread

 private:
  struct Letter;
  struct Courier;
  void run();

  const WebhookSettings settings_;
  DeadLetters& dead_;
  const TellLine tell_;
  const WebhookLimits limits_;
  Standing standing_;
  std::atomic<double> ends_s_ = 1e18;  // no try lasts longer, on the steady clock
  Queue<Notice> queue_;
  std::thread thread_;
};

// An address as it may be shown: without what only the receiver is to know, which is user,
// password, path and query.
std::string webhook_place(const std::string& url);

// The value of X-PackMerger-Signature.
std::string webhook_signature(const std::string& secret, const std::string& body);

}  // namespace packmerger
