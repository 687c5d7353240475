// What was sent since a line was given, and the oks that came: whether one of them is the line's
// own, where the printer answers strictly in order.
#pragma once

#include <cstddef>
#include <vector>

namespace packmerger {

class GcodeTally {
 public:
  // A line was given; asks_temperatures: it is M105.
  void begin(bool asks_temperatures);
  // Something was sent behind it, be it an empty line.
  void count_sent(bool asks_temperatures);
  // The printer asked for a line again, and says ok behind that.
  void count_refusal() { ++owed_; }
  // Returns whether that many were owed.
  bool count_ok(bool has_temperature);

  // temperatures_in_ok: as the printer answers M105; else its answer is an ok like any other.
  // Nothing more is to come, except from a printer that says no ok to an empty line.
  bool is_complete(bool temperatures_in_ok) const;
  // All that was sent was answered, or an M105 behind the line was, and ahead of its answer came
  // as many oks as were owed.
  bool proves_line(bool temperatures_in_ok) const;

 private:
  std::size_t owed_ = 0;  // without those of M105
  std::size_t oks_ = 0;
  std::vector<std::size_t> owed_ahead_;  // of each M105
  std::vector<std::size_t> oks_ahead_;   // of each answer to one
};

}  // namespace packmerger
