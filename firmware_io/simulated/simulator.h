// Printers that do not exist, each on a pseudo-terminal: they behave as the firmware does and
// record what they executed. They share no code with the links (own framing, own checksums), so
// that one cannot hide the other's mistake.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>

#include "firmware_io/simulated/traits.h"

namespace packmerger {

struct SimulatorOptions {
  double speed = 1;              // simulated seconds per real second; 0: no waiting at all
  std::filesystem::path record;  // every executed command, a line each; empty: no record
};

// Called once with the path of the pseudo-terminal that the printer listens at.
using ListeningAt = std::function<void(const std::string& path)>;

// A MakerBot Replicator with Sailfish 7.8: s3g, a 512-byte action buffer, replies 0x81, 0x82
// (full), 0x83 (checksum), 0x84, 0x85 and 0x8C as the firmware gives them, build name, state and
// statistics, heaters that take their time. Record: one action a line in execution order,
// lower-case hex of its payload ("9b…"), and "abort" where the host ended the build. Returns once
// stop is true. Throws Error{kCannotWrite} when the record cannot be written, Error{kInternal} when
// there is no pseudo-terminal.
void run_simulated_replicator(const SimulatorOptions& options,
                              const simulated::ReplicatorTraits& traits,
                              const ListeningAt& listening, const std::atomic<bool>& stop);

// A RepRap with Marlin, as its traits say: line numbers and checksums, Resend, four queued
// commands, busy every two seconds, temperatures, M115, prompts, emergency commands. Record: one
// command a line in execution order, without line number and checksum ("G1 X10 F3000"), and "halt"
// where it was killed. Returns and throws as above.
void run_simulated_marlin(const SimulatorOptions& options, const simulated::MarlinTraits& traits,
                          const ListeningAt& listening, const std::atomic<bool>& stop);

}  // namespace packmerger
