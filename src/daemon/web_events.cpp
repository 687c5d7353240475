#include "daemon/web_events.h"

#include <chrono>

namespace packmerger {
namespace {

constexpr int kMostStreams = 24;
constexpr std::chrono::seconds kQuiet(10);

}  // namespace

void WebEvents::publish(std::string state) {
  const std::lock_guard lock(mutex_);
  if (state == state_) return;
  state_ = std::move(state);
  ++version_;
  changed_.notify_all();
}

bool WebEvents::watched() const {
  const std::lock_guard lock(mutex_);
  return streams_ > 0;
}

void WebEvents::end_streams() {
  const std::lock_guard lock(mutex_);
  ++round_;
  changed_.notify_all();
}

void WebEvents::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_all();
}

std::optional<std::string> WebEvents::next(std::uint64_t& seen, std::uint64_t round) {
  std::unique_lock lock(mutex_);
  const auto has_ended = [&] { return closed_ || round_ != round; };
  changed_.wait_for(lock, kQuiet, [&] { return has_ended() || version_ > seen; });
  if (has_ended()) return std::nullopt;
  if (version_ == seen) return ": still here\n\n";
  seen = version_;
  return "event: state\ndata: " + state_ + "\n\n";
}

std::function<std::optional<std::string>()> WebEvents::stream() {
  const std::lock_guard lock(mutex_);
  if (closed_ || streams_ >= kMostStreams) return {};
  ++streams_;
  const std::shared_ptr<void> watching(nullptr, [this](void*) {
    const std::lock_guard gone(mutex_);
    --streams_;
  });
  return [this, watching, seen = std::uint64_t{0}, round = round_]() mutable {
    return next(seen, round);
  };
}

}  // namespace packmerger
