#include "daemon/web/web_events.h"

#include <charconv>
#include <chrono>
#include <memory>
#include <utility>

#include "daemon/keys/random_text.h"

namespace packmerger {
namespace {

constexpr int kMostStreams = 24;
constexpr std::chrono::seconds kQuiet(10);
// Who is further behind is told the state instead.
constexpr std::size_t kMostChanges = 240;
constexpr std::size_t kMostChangeBytes = std::size_t{1} << 20;

}  // namespace

WebEvents::WebEvents() : run_(random_text(9) + ".") {}

void WebEvents::publish(const std::string& change, const std::function<std::string()>& state) {
  bool is_wanted = false;
  {
    const std::lock_guard lock(mutex_);
    is_wanted = std::exchange(state_wanted_, false) || (state_streams_ > 0 && !change.empty());
  }
  std::string text = is_wanted ? state() : std::string();
  const std::lock_guard lock(mutex_);
  ++looks_;
  if (!change.empty()) {
    ++number_;
    changes_.push_back(change);
    change_bytes_ += change.size();
  }
  while (changes_.size() > kMostChanges || change_bytes_ > kMostChangeBytes) {
    change_bytes_ -= changes_.front().size();
    changes_.pop_front();
  }
  if (is_wanted) {
    state_ = std::move(text);
    state_number_ = number_;
    state_look_ = looks_;
  }
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

bool WebEvents::is_kept(std::uint64_t seen) const {
  return seen <= number_ && number_ - seen <= changes_.size();
}

void WebEvents::want_state(Reader& reader) {
  reader.seen.reset();
  reader.since = looks_;
  state_wanted_ = true;
  begun_.push({});
}

bool WebEvents::has_changes_for(const Reader& reader) const {
  if (reader.goes_on) return true;
  if (!reader.seen) return state_look_ > reader.since;
  return reader.wants_changes ? number_ > *reader.seen : state_number_ > *reader.seen;
}

std::string WebEvents::event(const char* name, std::uint64_t number,
                             const std::string& data) const {
  return "event: " + std::string(name) + "\nid: " + run_ + std::to_string(number) +
         "\ndata: " + data + "\n\n";
}

std::string WebEvents::changes_for(Reader& reader) {
  if (std::exchange(reader.goes_on, false)) return ": goes on\n\n";
  if (!reader.wants_changes) {
    reader.seen = state_number_;
    return "event: state\ndata: " + state_ + "\n\n";
  }
  if (!reader.seen) {
    reader.seen = state_number_;
    return event("state", state_number_, state_);
  }
  std::string text;
  while (*reader.seen < number_) {
    const std::size_t behind = number_ - (*reader.seen)++;
    text += event("delta", *reader.seen, changes_[changes_.size() - behind]);
  }
  return text;
}

std::optional<std::string> WebEvents::next(Reader& reader) {
  std::unique_lock lock(mutex_);
  const auto has_ended = [&] { return closed_ || round_ != reader.round; };
  changed_.wait_for(lock, kQuiet, [&] { return has_ended() || has_changes_for(reader); });
  if (has_ended()) return std::nullopt;
  if (!has_changes_for(reader)) return ": still here\n\n";
  if (reader.wants_changes && reader.seen && !is_kept(*reader.seen)) {
    want_state(reader);
    return ": too far behind\n\n";
  }
  return changes_for(reader);
}

std::function<std::optional<std::string>()> WebEvents::stream() { return begin({}); }

std::function<std::optional<std::string>()> WebEvents::changes(std::string_view last_id) {
  Reader reader;
  reader.wants_changes = true;
  std::uint64_t number = 0;
  const char* end = last_id.data() + last_id.size();
  if (last_id.starts_with(run_)) {
    const auto read = std::from_chars(last_id.data() + run_.size(), end, number);
    if (read.ec == std::errc() && read.ptr == end) reader.seen = number;
  }
  return begin(reader);
}

std::function<std::optional<std::string>()> WebEvents::begin(Reader reader) {
  const std::lock_guard lock(mutex_);
  if (closed_ || streams_ >= kMostStreams) return {};
  reader.round = round_;
  reader.goes_on = reader.seen && is_kept(*reader.seen);
  if (!reader.goes_on) want_state(reader);
  const int wants_states = reader.wants_changes ? 0 : 1;
  ++streams_;
  state_streams_ += wants_states;
  const std::shared_ptr<void> watching(nullptr, [this, wants_states](void*) {
    const std::lock_guard gone(mutex_);
    --streams_;
    state_streams_ -= wants_states;
  });
  return [this, watching, reader]() mutable { return next(reader); };
}

}  // namespace packmerger
