// What a simulated printer is made of: bytes in, bytes out, and time that is handed to it, so that
// the same firmware runs on a pseudo-terminal and, in tests, hours of it within a moment.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace packmerger::simulated {

inline constexpr double kNever = std::numeric_limits<double>::infinity();

// How the machine's time relates to the host's. Moves and heating take machine time; time-outs on
// the line belong to the host's time, however fast the machine runs.
struct Pace {
  double speed = 1;      // machine seconds per host second
  bool instant = false;  // moves and heating take no time at all (then speed is 1)

  double machine_s(double seconds) const { return instant ? 0 : seconds; }
  double line_s(double seconds) const { return seconds * speed; }
};

class Firmware {
 public:
  virtual ~Firmware() = default;

  // now_s: machine time, never going back.
  virtual void receive(std::string_view bytes, double now_s) = 0;
  // Executes what is due.
  virtual void advance(double now_s) = 0;
  // When advance() has something to do next, if nothing is received before; kNever: nothing.
  virtual double next_event_s() const = 0;

  std::string take_output() { return std::exchange(output_, {}); }
  // The commands executed since the last call, as a record shows them.
  std::vector<std::string> take_executed() { return std::exchange(executed_, {}); }

 protected:
  std::string output_;
  std::vector<std::string> executed_;
};

// A heater that moves towards its target at a constant rate.
class Heater {
 public:
  explicit Heater(double degrees_per_s) : degrees_per_s_(degrees_per_s) {}

  void set_target(double target, double now_s);
  double target() const { return target_; }
  double temperature(double now_s, const Pace& pace) const;
  // When it has its target; now_s where it has none.
  double ready_s(double now_s, const Pace& pace) const;

 private:
  static constexpr double kRoom = 21;

  double degrees_per_s_;
  double target_ = 0;
  double from_ = kRoom;
  double since_s_ = 0;
};

}  // namespace packmerger::simulated
