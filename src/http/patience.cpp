#include "http/patience.h"

#include <sys/socket.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <string_view>
#include <vector>

#include "base/time/clock.h"

namespace packmerger {
namespace {

constexpr std::chrono::milliseconds kLookEvery(250);

// Nothing else was sent yet but perhaps "100 Continue", so that this is what the client reads.
void end(HttpSender& sender) {
  constexpr std::string_view kLate =
      "HTTP/1.1 408 Request Timeout\r\nConnection: close\r\nContent-Length: 0\r\n\r\n";
  ::send(sender.socket, kLate.data(), kLate.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  ::shutdown(sender.socket, SHUT_RDWR);
  sender.awaits = HttpSender::Awaits::kNothing;
}

}  // namespace

Patience::Patience(PatienceLimits limits) : limits_(limits), watcher_([this] { watch(); }) {}

Patience::~Patience() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    changed_.notify_all();
  }
  watcher_.join();
}

HttpSender* Patience::begun(int socket, const std::string& peer) {
  const std::lock_guard lock(mutex_);
  HttpSender& sender = senders_.emplace_back();
  sender.socket = socket;
  sender.peer = peer;
  sender.since_s = steady_now_s();
  make_room();
  return &sender;
}

void Patience::make_room() {
  std::map<std::string_view, std::vector<HttpSender*>> waiting;
  std::size_t all = 0;
  for (HttpSender& sender : senders_)
    if (sender.awaits == HttpSender::Awaits::kHeaders) {
      waiting[sender.peer].push_back(&sender);
      ++all;
    }
  const auto most = std::max_element(
      waiting.begin(), waiting.end(),
      [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
  if (all <= limits_.waiting && most->second.size() <= limits_.waiting_of_a_peer) return;
  end(**std::min_element(
      most->second.begin(), most->second.end(),
      [](const HttpSender* a, const HttpSender* b) { return a->since_s < b->since_s; }));
}

void Patience::ended(HttpSender* sender) {
  const std::lock_guard lock(mutex_);
  std::erase_if(senders_, [&](const HttpSender& known) { return &known == sender; });
}

void Patience::awaits(HttpSender* sender, HttpSender::Awaits awaits) {
  const std::lock_guard lock(mutex_);
  sender->awaits = awaits;
  sender->since_s = steady_now_s();
  sender->bytes = 0;
}

void Patience::received(HttpSender* sender, std::size_t bytes) {
  const std::lock_guard lock(mutex_);
  sender->bytes += bytes;
}

bool Patience::is_late(const HttpSender& sender, double now) const {
  const double taken_s = now - sender.since_s;
  switch (sender.awaits) {
    case HttpSender::Awaits::kHeaders:
      return taken_s > limits_.headers_s;
    case HttpSender::Awaits::kBody:
      return taken_s > limits_.body_s && static_cast<double>(sender.bytes) <
                                             taken_s * static_cast<double>(limits_.body_bytes_s);
    case HttpSender::Awaits::kNothing:
      return false;
  }
  return false;
}

void Patience::watch() {
  std::unique_lock lock(mutex_);
  while (!ending_) {
    const double now = steady_now_s();
    for (HttpSender& sender : senders_)
      if (is_late(sender, now)) end(sender);
    changed_.wait_for(lock, kLookEvery, [&] { return ending_; });
  }
}

}  // namespace packmerger
