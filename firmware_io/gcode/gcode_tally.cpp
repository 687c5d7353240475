#include "firmware_io/gcode/gcode_tally.h"

namespace packmerger {

void GcodeTally::begin(bool asks_temperatures) {
  *this = {};
  count_sent(asks_temperatures);
}

void GcodeTally::count_sent(bool asks_temperatures) {
  if (asks_temperatures)
    sent_ahead_.push_back(sent_);
  else
    ++sent_.owed;
}

void GcodeTally::count_empty_line() { ++sent_.empty; }

bool GcodeTally::count_ok(bool has_temperature) {
  if (!has_temperature) return ++oks_ <= sent_.oks(true);
  oks_ahead_.push_back(oks_);
  return oks_ahead_.size() <= sent_ahead_.size();
}

bool GcodeTally::is_complete(bool temperatures_in_ok) const {
  return temperatures_in_ok ? oks_ahead_.size() >= sent_ahead_.size()
                            : oks_ >= sent_.oks(true) + sent_ahead_.size();
}

bool GcodeTally::proves_line(bool temperatures_in_ok, bool answers_empty) const {
  if (!temperatures_in_ok) return is_complete(temperatures_in_ok);
  const std::size_t owed = sent_.oks(answers_empty);
  if (owed > 0 && oks_ >= owed) return true;
  // Which answer is for which question is known only where none got lost.
  if (oks_ahead_.size() != sent_ahead_.size()) return false;
  for (std::size_t i = 0; i < sent_ahead_.size(); ++i)
    if (oks_ahead_[i] >= sent_ahead_[i].oks(answers_empty)) return true;
  return false;
}

std::optional<bool> GcodeTally::tells_of_empty_line() const {
  const std::size_t count = sent_ahead_.size();
  if (count < 2 || oks_ahead_.size() != count) return std::nullopt;
  const Sent& before = sent_ahead_[count - 2];
  const Sent& behind = sent_ahead_[count - 1];
  if (behind.owed != before.owed || behind.empty != before.empty + 1) return std::nullopt;
  return oks_ahead_[count - 1] > oks_ahead_[count - 2];
}

}  // namespace packmerger
