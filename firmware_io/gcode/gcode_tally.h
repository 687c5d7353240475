// What was sent since a line was given, and the oks that came: whether one of them is the line's
// own, where the printer answers strictly in order.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace packmerger {

class GcodeTally {
 public:
  // A line was given; asks_temperatures: it is M105.
  void begin(bool asks_temperatures);
  // Something was sent behind it.
  void count_sent(bool asks_temperatures);
  void count_empty_line();
  // The printer asked for a line again, and says ok behind that.
  void count_refusal() { ++sent_.owed; }
  // Returns whether that many were owed.
  bool count_ok(bool has_temperature);

  // temperatures_in_ok: as the printer answers M105; else its answer is an ok like any other.
  // Nothing more is to come, except from a printer that says no ok to an empty line.
  bool is_complete(bool temperatures_in_ok) const;
  // All that was sent was answered, or an M105 behind the line was, and ahead of its answer came
  // as many oks as were owed. answers_empty: as the printer does with empty lines.
  bool proves_line(bool temperatures_in_ok, bool answers_empty) const;
  // Whether the empty line between the last two M105 was answered; nothing where that is not all
  // that was sent between them, or one of them has no answer.
  std::optional<bool> tells_of_empty_line() const;

 private:
  struct Sent {
    std::size_t owed = 0;   // without those of M105 and of empty lines
    std::size_t empty = 0;  // lines
    std::size_t oks(bool answers_empty) const { return owed + (answers_empty ? empty : 0); }
  };
  Sent sent_;
  std::size_t oks_ = 0;
  std::vector<Sent> sent_ahead_;        // of each M105
  std::vector<std::size_t> oks_ahead_;  // of each answer to one
};

}  // namespace packmerger
