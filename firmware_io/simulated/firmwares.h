// The firmwares that can be simulated, by name: a row each.
#pragma once

#include <atomic>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_io/simulated/simulator.h"

namespace packmerger::simulated {

struct Firmware {
  std::string_view name;  // "marlin-2.1"

  // How each of its traits is given, for people; the same text where they are the same traits.
  std::string (*traits_told)();

  // Runs it (simulator.h) with its traits as usual but for `changes`, as set_trait() takes them.
  // Throws Error{kUsage} for a trait that it does not have.
  void (*run)(const SimulatorOptions& options, const std::vector<std::string>& changes,
              const ListeningAt& listening, const std::atomic<bool>& stop);
};

std::span<const Firmware> firmwares();

// Throws Error{kInternal} where none has the name.
const Firmware& firmware_named(std::string_view name);

}  // namespace packmerger::simulated
