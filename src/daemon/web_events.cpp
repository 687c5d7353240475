#include "daemon/web_events.h"

#include <chrono>

namespace packmerger {
namespace {

constexpr int kMostStreams = 24;
constexpr std::chrono::seconds kQuiet(10);

}  // namespace

void WebEvents::publish(std::string state) {
  const std::lock_guard lock(mutex_);
  ++published_;
  if (state != state_) ++version_;
  state_ = std::move(state);
  changed_.notify_all();
}

bool WebEvents::take_begun() {
  bool any = false;
  while (begun_.try_pop()) any = true;
  return any;
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

std::optional<std::string> WebEvents::next(Reader& reader) {
  std::unique_lock lock(mutex_);
  const auto has_ended = [&] { return closed_ || round_ != reader.round; };
  const auto has_news = [&] { return published_ > reader.since && version_ > reader.seen; };
  changed_.wait_for(lock, kQuiet, [&] { return has_ended() || has_news(); });
  if (has_ended()) return std::nullopt;
  if (!has_news()) return ": still here\n\n";
  reader.seen = version_;
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
  begun_.push({});
  return [this, watching, reader = Reader{published_, round_}]() mutable { return next(reader); };
}

}  // namespace packmerger
