#include "firmware_io/simulated/firmwares.h"

#include <algorithm>
#include <array>

#include "base/error.h"

namespace packmerger::simulated {
namespace {

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::string marlin_traits_told() {
  return "NAME=on or NAME=off of " + joined(marlin_trait_names()) +
         "; or NAME=N, where it happens with the N-th line, of " +
         joined(marlin_line_trait_names());
}

std::string replicator_traits_told() {
  return "NAME=on or NAME=off of " + joined(replicator_trait_names());
}

template <typename Traits>
Traits with_traits(Traits traits, const std::vector<std::string>& changes,
                   const std::string& told) {
  for (const std::string& change : changes)
    if (!set_trait(traits, change))
      throw Error(Fault::kUsage, "This firmware has no trait " + change, "Give " + told + ".");
  return traits;
}

template <MarlinTraits (*usual)()>
void run_marlin(const SimulatorOptions& options, const std::vector<std::string>& changes,
                const ListeningAt& listening, const std::atomic<bool>& stop) {
  run_simulated_marlin(options, with_traits(usual(), changes, marlin_traits_told()), listening,
                       stop);
}

void run_replicator(const SimulatorOptions& options, const std::vector<std::string>& changes,
                    const ListeningAt& listening, const std::atomic<bool>& stop) {
  run_simulated_replicator(
      options, with_traits(ReplicatorTraits(), changes, replicator_traits_told()), listening, stop);
}

MarlinTraits marlin_2_1() { return {}; }

constexpr std::array<Firmware, 3> kFirmwares = {{
    {"marlin-2.1", marlin_traits_told, run_marlin<marlin_2_1>},
    {"marlin-1.1", marlin_traits_told, run_marlin<marlin_1_1>},
    {"sailfish", replicator_traits_told, run_replicator},
}};

}  // namespace

std::span<const Firmware> firmwares() { return kFirmwares; }

const Firmware& firmware_named(std::string_view name) {
  const auto* found = std::find_if(kFirmwares.begin(), kFirmwares.end(),
                                   [&](const Firmware& firmware) { return firmware.name == name; });
  if (found == kFirmwares.end())
    throw Error(Fault::kInternal, "No simulated firmware is called " + std::string(name),
                "Please report this.");
  return *found;
}

}  // namespace packmerger::simulated
