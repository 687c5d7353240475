// The daemon's door for browsers and programs: HTTP in, questions to the loop, its answers out.
// docs/API.md lists the routes.
#pragma once

#include <memory>
#include <string>

#include "daemon/keys/key_ring.h"
#include "daemon/local/loop_proxy.h"
#include "daemon/settings/config.h"
#include "daemon/web/web_events.h"
#include "daemon/web/web_guard.h"
#include "http/server.h"

namespace packmerger {

// Where files lie while they come in.
std::filesystem::path uploads_folder(const DaemonConfig& config);

// Runs while it lives. Requests wait for the loop for some seconds at most.
class Web {
 public:
  // Where no key was made yet it listens on this machine alone, whatever the settings say. Throws
  // as HttpServer does.
  Web(const DaemonConfig& config, KeyRing& keys, WebQuestions& questions, WebEvents& events);
  Web(const Web&) = delete;
  Web& operator=(const Web&) = delete;
  ~Web();

  const WebConfig& config() const { return config_; }
  const std::string& address() const { return address_; }
  int port() const { return server_->port(); }

 private:
  BodyPlan plan(const HttpRequest& request);
  HttpReply answer(HttpRequest& request);
  HttpReply routed(HttpRequest& request);
  HttpReply upload(HttpRequest& request);
  HttpReply upload_rules() const;
  HttpReply file_of_job(const std::string& id, const std::string& name);
  HttpReply look(const HttpRequest& request);
  HttpReply events(const HttpRequest& request);
  HttpReply page(const HttpRequest& request) const;

  const WebConfig config_;  // as it was: the loop may read the settings again
  const std::filesystem::path uploads_;
  KeyRing& keys_;
  LoopProxy loop_;
  WebEvents& events_;
  WebGuard guard_;
  std::string address_;
  std::unique_ptr<HttpServer> server_;
};

}  // namespace packmerger
