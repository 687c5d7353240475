// A channel to a simulated firmware that loses, flips, doubles, delays and splits what it carries,
// in a time of its own: hours of waiting pass in a moment, and the same seed plays the same faults.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/random.h"
#include "firmware_io/ports/port.h"
#include "firmware_io/simulated/firmware.h"

namespace packmerger::test {

// Probabilities, of one chunk (a line, a packet, a burst of answers) each way.
struct FaultRates {
  double drop_byte = 0;
  double drop_chunk = 0;
  double flip = 0;  // of one bit
  double duplicate = 0;
  double delay = 0;  // by up to longest_delay_s
  double split = 0;
  double longest_delay_s = 0.3;
  // Of one chunk that is written; each happens once at most.
  double mishap = 0;  // on_mishap is called
  double unplug = 0;  // the channel ends
};

class FaultyPort : public Port {
 public:
  FaultyPort(simulated::Firmware& firmware, FaultRates rates = {}, std::uint64_t seed = 1)
      : firmware_(firmware), rates_(rates), random_(seed) {}

  std::size_t read(char* data, std::size_t size, double timeout_s) override;
  std::size_t write(std::string_view bytes, double timeout_s) override;
  double now_s() const override { return now_s_; }
  std::string name() const override { return "a faulty channel"; }

  // Called before anything passes, with the number of chunks written so far.
  std::function<void(std::size_t written)> on_step;
  // What becomes of the machine at a mishap: a reset, a halt.
  std::function<void()> on_mishap;
  // May change what passes to the printer, or clear it.
  std::function<void(std::string& bytes)> on_send;
  // May change what the printer says, or clear it.
  std::function<void(std::string& bytes)> on_answer;
  // While true, what the firmware says is lost.
  bool lose_answers = false;
  // The channel ends once this many chunks were written.
  std::size_t end_after = static_cast<std::size_t>(-1);
  // Everything that was written, before any fault.
  std::string sent;

  // All that the firmware executed so far.
  const std::vector<std::string>& executed();
  // The machine goes on for so long with nobody at the other end.
  void leave_alone(double seconds);
  std::size_t faults() const { return faults_; }
  bool had_mishap() const { return had_mishap_; }
  bool was_unplugged() const { return unplugged_; }
  std::size_t chunks() const { return written_; }

 private:
  struct Chunk {
    double due_s = 0;
    std::string bytes;
  };

  void step();
  void deliver();
  void pass(std::string bytes, std::deque<Chunk>& queue);
  std::string damaged(std::string bytes);
  bool happens(double rate) { return rate > 0 && random_.unit() < rate; }

  simulated::Firmware& firmware_;
  FaultRates rates_;
  Random random_;
  double now_s_ = 0;
  std::size_t written_ = 0;
  std::size_t faults_ = 0;
  bool had_mishap_ = false;
  bool unplugged_ = false;
  std::deque<Chunk> to_printer_;
  std::deque<Chunk> to_host_;
  std::vector<std::string> executed_;
};

}  // namespace packmerger::test
