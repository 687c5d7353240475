// Questions of the web server's connections to the loop, and its answers as HTTP tells them.
#pragma once

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "base/queue.h"
#include "daemon/orders/messages.h"
#include "http/message.h"

namespace packmerger {

// To the loop, which answers as it answers the local socket (api.h).
struct WebQuestion {
  std::variant<std::string, UploadedJob> ask;  // a request as JSON text
  std::promise<std::string> answer;

  // Either the loop begins to answer it, or whoever asked takes it back: false for the later of the
  // two. What was taken back is never done.
  bool begin() { return !settled_.exchange(true); }
  bool take_back() { return !settled_.exchange(true); }

 private:
  std::atomic<bool> settled_{false};
};
using WebQuestions = Queue<std::shared_ptr<WebQuestion>>;

// Thread-safe.
class LoopProxy {
 public:
  explicit LoopProxy(WebQuestions& questions,
                     std::chrono::milliseconds patience = std::chrono::seconds(20))
      : questions_(questions), patience_(patience) {}

  // The loop's result as JSON with status 200, or its error with the status that suits it. What the
  // loop does not begin within some seconds is taken back, and answered with 503.
  HttpReply ask(std::variant<std::string, UploadedJob> question) const;

  // The one way in for files, whichever door they came through: a job for the printer, and status
  // 201. 415 for what the name says is neither a model nor a program.
  HttpReply take(UploadedJob upload) const;

 private:
  WebQuestions& questions_;
  std::chrono::milliseconds patience_;
};

// What the loop's faults are in HTTP: 404, 409, 422 or 500.
int http_status_of(int fault);

// The answer to a file whose name says that it never becomes a job; nothing for others.
std::optional<HttpReply> unwelcome(const std::string& given_name);

}  // namespace packmerger
