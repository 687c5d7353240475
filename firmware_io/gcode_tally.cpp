#include "firmware_io/gcode_tally.h"

namespace packmerger {

void GcodeTally::begin(bool asks_temperatures) {
  *this = {};
  count_sent(asks_temperatures);
}

void GcodeTally::count_sent(bool asks_temperatures) {
  if (asks_temperatures)
    owed_ahead_.push_back(owed_);
  else
    ++owed_;
}

bool GcodeTally::count_ok(bool has_temperature) {
  if (!has_temperature) return ++oks_ <= owed_;
  oks_ahead_.push_back(oks_);
  return oks_ahead_.size() <= owed_ahead_.size();
}

bool GcodeTally::is_complete(bool temperatures_in_ok) const {
  return temperatures_in_ok ? oks_ahead_.size() >= owed_ahead_.size()
                            : oks_ >= owed_ + owed_ahead_.size();
}

bool GcodeTally::proves_line(bool temperatures_in_ok) const {
  if (!temperatures_in_ok) return is_complete(temperatures_in_ok);
  if (owed_ > 0 && oks_ >= owed_) return true;
  // Which answer is for which question is known only where none got lost.
  if (oks_ahead_.size() != owed_ahead_.size()) return false;
  for (std::size_t i = 0; i < owed_ahead_.size(); ++i)
    if (oks_ahead_[i] >= owed_ahead_[i]) return true;
  return false;
}

}  // namespace packmerger
