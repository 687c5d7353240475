// Taking the inside out of a solid model (paper, section 3).
#pragma once

#include "base/progress.h"
#include "model/mesh.h"
#include "model/printer.h"
#include "model/shell.h"
#include "model/warning.h"

namespace packmerger {

// The inner surface lies at depth settings.wall_mm below the outer one: a level of the signed
// distance, sampled every settings.voxel_mm on a sparse grid, coarsened within a tenth of the wall.
// Cavities below settings.min_cavity_mm3 stay solid. Each cavity is closed, manifold, free of
// self-intersections, one component, within the matter, and no nearer to the outer surface than 0.9
// wall_mm. A chamber with a way out is no matter, however narrow the way.
//
// Too thin to hollow is an ordinary outcome: no cavities. Inner components of `outer` (the model's
// own cavities) stay part of Shell::outer, and the wall is kept around them too; where that wall
// would float free in a new cavity, the two cavities become one.
//
// Warnings: "sealed_cavity" (support or powder stays trapped in the model printed in one piece),
// "thin_features" (more than half of the surface has less than two walls of matter below it).
//
// outer: closed, mm. Where it crosses itself, the wall is kept along all of its sheets, and what it
// winds around twice stays solid. Throws Error{kBadInput} when the wall needs a grid of
// more than 200 million voxels, when no inner surface is found that does not cross itself, or when
// it cannot be told what is matter.
Shell hollow(const Mesh& outer, const ShapeSettings& settings, Warnings& warnings,
             const Progress& progress);

// A shell without cavities: the model stays solid.
Shell solid_shell(const Mesh& outer, const ShapeSettings& settings);

}  // namespace packmerger
