#include "daemon/web/web_guard.h"

#include <arpa/inet.h>
#include <strings.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/error.h"
#include "base/json_values.h"
#include "daemon/local/web_error.h"

namespace packmerger {
namespace {

constexpr int kMostWrong = 10;
constexpr double kForgotten_s = 60;  // after the last wrong one
constexpr std::size_t kMostPeers = 1024;

bool same(std::string_view a, std::string_view b) {
  return a.size() == b.size() && ::strncasecmp(a.data(), b.data(), a.size()) == 0;
}

// "name:80" → "name", "[::1]:80" → "::1".
std::string_view without_port(std::string_view host) {
  if (host.starts_with('[')) return host.substr(1, std::min(host.find(']'), host.size()) - 1);
  return host.substr(0, std::min(host.find(':'), host.size()));
}

bool is_address(const std::string& host) {
  std::array<unsigned char, sizeof(in6_addr)> bytes;
  return ::inet_pton(AF_INET, host.c_str(), bytes.data()) == 1 ||
         ::inet_pton(AF_INET6, host.c_str(), bytes.data()) == 1;
}

// A proxy on this machine speaks for clients elsewhere, and some say so.
bool is_local(const HttpRequest& request) {
  return request.is_loopback && request.header("X-Forwarded-For").empty() &&
         request.header("Forwarded").empty() && request.header("Via").empty();
}

}  // namespace

std::string machine_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

std::string_view key_of(const HttpRequest& request) {
  constexpr std::string_view kBearer = "Bearer ";
  if (const std::string_view key = request.header("X-Api-Key"); !key.empty()) return key;
  const std::string_view given = request.header("Authorization");
  return given.starts_with(kBearer) ? given.substr(kBearer.size()) : std::string_view();
}

WebGuard::WebGuard(std::vector<std::string> hosts, const KeyRing& keys, bool trusts_local)
    : hosts_(std::move(hosts)), keys_(keys), trusts_local_(trusts_local) {
  hosts_.push_back("localhost");
  if (const std::string own = machine_name(); !own.empty()) {
    hosts_.push_back(own);
    hosts_.push_back(own + ".local");
  }
}

bool WebGuard::knows_host(std::string_view host) const {
  const std::string name(without_port(host));
  return is_address(name) || std::any_of(hosts_.begin(), hosts_.end(),
                                         [&](const std::string& own) { return same(own, name); });
}

bool WebGuard::guesses(const std::string& peer, double now_s) {
  const std::lock_guard lock(mutex_);
  std::erase_if(tries_,
                [&](const auto& item) { return now_s - item.second.since_s > kForgotten_s; });
  if (tries_.size() >= kMostPeers && !tries_.contains(peer)) tries_.erase(tries_.begin());
  Tries& tries = tries_[peer];
  tries.since_s = now_s;
  return ++tries.wrong > kMostWrong;
}

// A right key is never refused, whatever else comes from its address: only a wrong one is slowed.
HttpReply WebGuard::wrong_key(const std::string& peer, double now_s) {
  if (!guesses(peer, now_s))
    return web_error(401, Fault::kUsage, "The key is wrong or was revoked",
                     "packmerger keys list shows which there are; keys add makes another.");
  HttpReply reply = web_error(429, Fault::kBusy, "Too many wrong keys came from this address",
                              "Use the right key: that one is taken at any time.");
  reply.headers.emplace_back("Retry-After", std::to_string(std::lround(kForgotten_s)));
  return reply;
}

void WebGuard::hold_back(const HttpReply& refusal) {
  constexpr int kMostHeldBack = 8;  // of the connections that there are
  if (refusal.status != 429) return;
  if (++held_back_ <= kMostHeldBack) std::this_thread::sleep_for(std::chrono::seconds(1));
  --held_back_;
}

std::optional<HttpReply> WebGuard::refused(const HttpRequest& request, Access access,
                                           double now_s) {
  const std::string_view host = request.header("Host");
  if (!knows_host(host))
    return web_error(403, Fault::kUsage, "The daemon does not go by that name",
                     "Use its address, or add the name to web.hosts in its settings.");
  const std::string_view origin = request.header("Origin");
  if (!origin.empty() && origin != "http://" + std::string(host) &&
      origin != "https://" + std::string(host))
    return web_error(403, Fault::kUsage, "Pages of other sites may not use the daemon",
                     "Open the daemon's own page.");
  if (access == Access::kOpen) return std::nullopt;
  const std::string_view key = key_of(request);
  if (key.empty()) {
    if (access == Access::kRead && trusts_local_ && is_local(request)) return std::nullopt;
    return web_error(401, Fault::kUsage, "This needs a key",
                     "Make one with packmerger keys add NAME, and send it as X-Api-Key; user and "
                     "password are not taken. packmerger keys link lets a browser look.");
  }
  const std::optional<WebKey> known = keys_.find(key);
  if (!known) return wrong_key(request.peer, now_s);
  if (access == Access::kChange && known->looks_only)
    return web_error(401, Fault::kUsage, "This page may look and change nothing",
                     "Make a key with packmerger keys add NAME.");
  return std::nullopt;
}

}  // namespace packmerger
