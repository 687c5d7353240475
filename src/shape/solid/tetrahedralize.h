// From shell to tetrahedra (paper, section 3), by TetGen (Si, 2015) in a process of its own.
#pragma once

#include <optional>

#include "base/progress.h"
#include "model/printer.h"
#include "model/shell.h"
#include "model/tet_mesh.h"

namespace packmerger {

// Long edges of the outer surface are halved first (the surface stays where it is), TetGen is run
// with settings.tetgen_flags (an "a" without a number is given the largest volume), and what is
// still larger is split by bisection. The largest volume is settings.max_tetrahedron_fraction of
// the shell's, or a hundredth of a cluster where that is less. Every vertex of shell.outer is a
// point of the result at exactly the same position when the flags hold Y.
//
// The result: positively oriented, neighbours linked, sides kOutside and kCavity from the facets'
// markers, volume equal to the shell's within 0.1 %.
//
// TetGen runs as `packmerger-tetgen`, found beside the running program, within 8 GiB and ten
// minutes; nullopt when it refuses or dies, or when what it answers does not hold the promises
// above: an ordinary outcome, the caller then re-samples the surface.
// Throws Error: kUnavailable when packmerger-tetgen is missing, kInterrupted.
std::optional<TetMesh> tetrahedralize(const Shell& shell, const ShapeSettings& settings,
                                      const Progress& progress);

}  // namespace packmerger
