// The daemon's door for browsers and programs: HTTP in, questions to the loop, its answers out.
// docs/API.md lists the routes.
#pragma once

#include <future>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "base/queue.h"
#include "daemon/config.h"
#include "daemon/key_ring.h"
#include "daemon/messages.h"
#include "daemon/web_events.h"
#include "daemon/web_guard.h"
#include "http/server.h"

namespace packmerger {

// To the loop, which answers as it answers the local socket (api.h).
struct WebQuestion {
  std::variant<std::string, UploadedJob> ask;  // a request as JSON text
  std::promise<std::string> answer;
};
using WebQuestions = Queue<std::shared_ptr<WebQuestion>>;

// Runs while it lives. Requests wait for the loop for some seconds at most.
class Web {
 public:
  // Where no key was made yet it listens on this machine alone, whatever the settings say. Throws
  // as HttpServer does.
  Web(const DaemonConfig& config, const KeyRing& keys, WebQuestions& questions, WebEvents& events);
  Web(const Web&) = delete;
  Web& operator=(const Web&) = delete;
  ~Web();

  const std::string& address() const { return address_; }
  int port() const { return server_->port(); }

 private:
  BodyPlan plan(const HttpRequest& request);
  HttpReply answer(HttpRequest& request);
  HttpReply routed(HttpRequest& request);
  HttpReply ask(std::variant<std::string, UploadedJob> question);
  HttpReply upload(HttpRequest& request);
  HttpReply file_of_job(const std::string& id, const std::string& name);
  HttpReply events();
  HttpReply page(const HttpRequest& request) const;

  const DaemonConfig& config_;
  WebQuestions& questions_;
  WebEvents& events_;
  WebGuard guard_;
  std::string address_;
  std::unique_ptr<HttpServer> server_;
};

}  // namespace packmerger
