// The firmware of a simulated MakerBot Replicator (Sailfish 7.8), as simulator.h describes it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>

#include "firmware_io/simulated/bytes.h"
#include "firmware_io/simulated/firmware.h"
#include "firmware_io/simulated/traits.h"

namespace packmerger::simulated {

class Replicator : public Firmware {
 public:
  explicit Replicator(Pace pace, ReplicatorTraits traits = {}) : pace_(pace), traits_(traits) {}

  void receive(std::string_view bytes, double now_s) override;
  void advance(double now_s) override;
  double next_event_s() const override;

  // What a person or the machine itself may do in the middle of a build.
  void cancel_at_panel();
  void press_pause();  // at its panel: pauses, or goes on
  void overheat();
  void power_cycle();
  void build_from_card();

 private:
  enum State : std::uint8_t { kNone, kRunning, kFinished, kPausedState, kCancelled };
  struct Move {
    std::array<std::int32_t, 5> from{};
    std::array<std::int32_t, 5> to{};
    double since_s = 0;
    double until_s = 0;
  };
  enum class Expect { kHeader, kLength, kPayload, kChecksum };

  void take_byte(std::uint8_t byte, double now_s);
  void take_packet(double now_s);
  void take_action();
  void take_query(double now_s);
  void take_tool_query(double now_s);
  void answer(std::uint8_t code, const Bytes& rest = {});
  Bytes statistics() const;
  Bytes position() const;
  void stop(double now_s);
  void clear();

  void execute(const Bytes& sent, double now_s);
  void execute_move(const Bytes& action, double now_s);
  void execute_tool_action(const Bytes& action, double now_s);
  void begin_build(const Bytes& action);
  void end_build(double now_s);
  void wait(double seconds, double now_s);
  Heater& tool(std::size_t index) { return tools_[index % tools_.size()]; }

  Pace pace_;
  ReplicatorTraits traits_;

  // the line
  Expect expect_ = Expect::kHeader;
  std::size_t length_ = 0;
  Bytes payload_;
  double packet_since_s_ = 0;
  double noise_since_s_ = kNever;  // a stray byte is complained about until a packet comes

  // the machine
  std::deque<Bytes> queue_;
  std::size_t queued_bytes_ = 0;
  double booted_at_s_ = 0;  // it is deaf until then
  double busy_until_s_ = 0;
  double now_s_ = 0;
  double stop_at_s_ = kNever;  // an abort takes effect a little later
  bool paused_ = false;
  bool waits_for_button_ = false;
  bool tell_cancelled_ = false;  // to whoever speaks next
  bool overheated_ = false;
  bool from_card_ = false;
  State state_ = kNone;
  std::string build_name_;
  std::uint32_t executed_count_ = 0;  // since the build start
  std::uint32_t last_count_ = 0;      // of the build that ended last
  double build_since_s_ = 0;
  std::array<std::int32_t, 5> position_{};  // at the end of the move that was begun last
  Move move_;                               // the one that was begun last
  double homing_until_s_ = 0;
  std::array<Heater, 2> tools_{Heater(3), Heater(3)};
  Heater platform_{1};
};

}  // namespace packmerger::simulated
