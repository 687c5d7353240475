// In which order a tray's parts can be taken out, and along which paths, found on the meshes
// themselves (assembly planning: Wilson and Latombe, 1994).
#pragma once

#include <functional>
#include <vector>

#include "base/progress.h"
#include "model/mesh.h"
#include "model/plate.h"
#include "pack/exact/sweep.h"

namespace packmerger {

struct ExactDisassembly {
  std::vector<int> order;                // first out first; without the stuck ones
  std::vector<std::vector<Vec3>> paths;  // by part: steps, mm, before it is lifted; empty: none
  std::vector<int> stuck;  // for which no way out was found; that none exists is not said
};

// Parts that can be lifted straight up go first, the highest before the others; where none can, the
// first that finds a path, by steps of half a millimetre or of two, along which it stays within the
// base, over no wall of the plate, and apart from those that are still there (sweep.h). The first
// of three searches looks at so few positions that what comes out easily is soon found; a search
// that failed is not made again while all that was in its way is there. Where is_over says so the
// search ends, and what is still there counts as stuck.
ExactDisassembly exact_disassembly(const StandingParts& parts, const Vec2& base_mm,
                                   const Plate& plate, const std::function<bool()>& is_over);

// What is known of the same parts where they stood a little elsewhere, where it still holds, or
// else another; paths among walls are always found anew.
ExactDisassembly renewed(const ExactDisassembly& known, const StandingParts& parts,
                         const Vec2& base_mm, const Plate& plate,
                         const std::function<bool()>& is_over);

// parts: closed, where they stand on one tray, mm.
ExactDisassembly exact_disassembly(const std::vector<Mesh>& parts, const Vec2& base_mm,
                                   const Progress& progress, const Plate& plate = {});

}  // namespace packmerger
