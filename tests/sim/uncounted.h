// Prints to a printer that looks at neither the number nor the checksum of a line (Klipper).
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "firmware_io/simulated/marlin.h"
#include "sim/scenario.h"

namespace packmerger::test {

// Moves that each lead elsewhere, with filament as `mode` (M82 or M83) has it.
inline std::vector<std::string> moves(const std::string& mode, int count) {
  std::vector<std::string> program = {"M104 S100", "G28", "G90", mode, "G92 E0"};
  for (int i = 1; i <= count; ++i)
    program.push_back("G1 X" + std::to_string(i % 100) + "." + std::to_string(100 + i) + " Y" +
                      std::to_string(i) + " E" + (mode == "M83" ? "0.05" : std::to_string(i)));
  return program;
}

inline std::string text(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

// RepRapFirmware, whose new versions drop in silence what came garbled.
inline simulated::MarlinTraits rep_rap_firmware(bool drops) {
  simulated::MarlinTraits traits = simulated::klipper();
  traits.checks_sums = true;
  traits.drops_garbled = drops;
  traits.counts_relative_e = false;
  return traits;
}

struct Outcome {
  std::optional<Error> failure;
  std::vector<std::string> executed;  // of the program
  std::string sent;
};

// What becomes of a numbered line on its way; `bytes` is all of it.
using Harm = std::function<void(const std::string& command, std::string& bytes)>;

inline Outcome outcome(const std::vector<std::string>& program, const Harm& harm,
                       const std::string& lost_answer = "", std::size_t window_bytes = 0,
                       simulated::Pace pace = {1, true},
                       const simulated::MarlinTraits& traits = simulated::klipper()) {
  simulated::Marlin firmware(pace, traits);
  FaultyPort port(firmware);
  port.on_send = [&](std::string& bytes) {
    const std::string command = command_of(bytes);
    if (!lost_answer.empty()) port.lose_answers = command == lost_answer;
    if (harm && bytes.starts_with("N")) harm(command, bytes);
  };
  PrintControl control;
  StreamOptions options = scenario_options();
  options.timeout_s = 5;
  options.window_bytes = window_bytes;
  const auto failure = print(port, true, text(program), control, {}, options);
  return {failure, only(port.executed(), program), port.sent};
}

}  // namespace packmerger::test
