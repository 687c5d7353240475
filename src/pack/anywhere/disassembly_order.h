// The proof that a tray can be taken apart: an order, and for each part an escape path past
// those that are still there (assembly planning: Wilson and Latombe, 1994, for single
// translations).
#pragma once

#include <optional>
#include <vector>

#include "pack/anywhere/solid_tray.h"

namespace packmerger {

struct DisassemblyOrder {
  std::vector<int> order;                // indices into the places, first out first
  std::vector<std::vector<Vec3>> paths;  // by part: steps, mm, before it is lifted; empty: none
};

// grid: of bounds. Parts that can be lifted straight up go first, of several the last one; where
// none can, the first that finds a escape_path. Nothing where some parts find none.
std::optional<DisassemblyOrder> disassembly_order(const SolidGrid& grid,
                                                  const std::vector<SolidPlace>& places);

}  // namespace packmerger
