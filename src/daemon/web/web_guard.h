// Who may ask the daemon's web server for what: the checks that every request passes first.
#pragma once

#include <atomic>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "daemon/keys/key_ring.h"
#include "http/message.h"

namespace packmerger {

// What a request needs.
enum class Access {
  kOpen,    // nothing: the page itself, which tells nothing
  kRead,    // a key, unless it comes from this machine and that is trusted
  kChange,  // a key that may change something
};

// Thread-safe.
class WebGuard {
 public:
  // hosts: names by which the daemon is reached beside localhost, this machine's own name, and any
  // numeric address. A name that is none of these is how a foreign page would reach us (DNS
  // rebinding). trusts_local: whoever asks from this machine may read without a key, and so may
  // everybody behind a proxy there that does not say that it is one.
  WebGuard(std::vector<std::string> hosts, const KeyRing& keys, bool trusts_local);

  // The answer to a request that is refused: 403 (a foreign name or page), 401 (no key, or a wrong
  // one), 429 (a wrong key, and too many came from there). now_s: a clock that never goes back.
  std::optional<HttpReply> refused(const HttpRequest& request, Access access, double now_s);

  // Keeps whoever guesses keys waiting for a second.
  void hold_back(const HttpReply& refusal);

 private:
  struct Tries {
    int wrong = 0;
    double since_s = 0;
  };

  bool knows_host(std::string_view host) const;
  bool guesses(const std::string& peer, double now_s);
  HttpReply wrong_key(const std::string& peer, double now_s);

  std::vector<std::string> hosts_;
  const KeyRing& keys_;
  const bool trusts_local_;
  std::atomic<int> held_back_ = 0;
  std::mutex mutex_;  // guards tries_
  std::map<std::string, Tries> tries_;
};

// What this machine calls itself; empty where it has no name.
std::string machine_name();

// The key that comes with a request: X-Api-Key, or Authorization: Bearer. Empty where none does.
std::string_view key_of(const HttpRequest& request);

}  // namespace packmerger
