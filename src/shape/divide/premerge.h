// Merges segments that would be hard to glue or to handle (paper, section 5).
#pragma once

#include "base/geometry.h"
#include "base/progress.h"
#include "model/printer.h"
#include "model/segments.h"
#include "model/tet_mesh.h"
#include "model/warning.h"

namespace packmerger {

struct BuildVolume {
  Vec3 build_mm = Vec3::Zero();  // the tray's inner size
  double rotation_step = 0;      // radians, about each of the three axes, as the packer turns parts
  Plate plate{};                 // its walls within build_mm
};

// First the pair with the smallest cross-section is merged until every cross-section is at least
// settings.min_glue_area_mm2; then the segment with the smallest volume is merged into its smallest
// neighbour until each holds at least settings.min_volume_fraction of V_o. A merge is permitted
// only when the union's axis-aligned box fits `build` in at least one of the packer's rotations,
// and when it leaves no hollowed cavity with one segment all round it. What no permitted merge can
// mend stays and is told in `warnings`: "small_glue_area", "small_segment". The parts are made
// manifold again (tetrahedra of `mesh` may be split). Labels keep the order of the lowest old label
// in each. Throws Error{kInterrupted}.
Segments premerge(TetMesh& mesh, const Segments& segments, const ShapeSettings& settings,
                  const BuildVolume& build, Warnings& warnings, const Progress& progress);

}  // namespace packmerger
