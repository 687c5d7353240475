// How many models are prepared at the same time.
#pragma once

#include <cstdint>

#include "daemon/settings/config.h"

namespace packmerger {

inline constexpr int kMostWorkers = 64;

// One for every two cores and for every memory_bytes of memory, whichever are fewer; at least one.
int workers_for(unsigned cores, std::uint64_t memory, std::uint64_t memory_bytes);

// Those of the settings, or else as many as suit this machine.
int workers_of(const PrepareConfig& prepare);

}  // namespace packmerger
