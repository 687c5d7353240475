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

void WebEvents::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_all();
}

std::optional<std::string> WebEvents::next(std::uint64_t& seen) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, kQuiet, [&] { return closed_ || version_ > seen; });
  if (closed_) return std::nullopt;
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
  return [this, watching, seen = std::uint64_t{0}]() mutable { return next(seen); };
}

}  // namespace packmerger
