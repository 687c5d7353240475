// Searches divisions by planes whose pieces stand well on a plate: the partition decides more about
// support than the packing.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "base/progress.h"
#include "model/printer.h"
#include "model/segments.h"
#include "model/tet_mesh.h"
#include "shape/divide/premerge.h"

namespace packmerger {

struct CutSearch {
  double support_angle = 0;   // radians; V_s is judged for it
  double part_price_mm3 = 0;  // a part more must save this much support
  // or only this much, in one further plan; none where it is no lower
  double least_price_mm3 = std::numeric_limits<double>::infinity();
  int effort = 1000;    // changes tried, over all candidates
  int samples = 15000;  // about so many points stand for the matter
};

struct CutHistory;  // how to repeat it exactly

struct CutPlan {
  std::string construction;  // "rings", "slabs", "cuts", "overcut": where its search started
  int parts = 0;
  double support_mm3 = 0;  // judged: the sum over the parts, each alone the best way up
  std::shared_ptr<const CutHistory> history;
};

// Several divisions of the mesh, different in construction or number of parts, best first by
// support and price of parts; the second has more parts, at the lower price, since low parts save
// time that standing alone does not tell. As far as samples of the matter tell, none has more than
// settings.parts parts, a part below settings.min_volume_fraction of V_o, a joint below
// settings.min_glue_area_mm2, a part that fits `build` in none of the packer's rotations, or a
// cavity with one part all round it. A tail thinner than the samples' spacing may escape them:
// premerge and the packer see to the rest. Empty when no such division was found.
//
// Several constructions are made (cuts one after the other, over-cut and merged back; slabs;
// bands with strips across their caps), and the best of each are improved by a large neighbourhood
// search: neighbours are united and cut anew by a plane, a slab or wedges. Standing alone is a
// ranking only, since parts nest. Same mesh and seed: same answer on any number of threads.
// Throws Error{kInterrupted}.
std::vector<CutPlan> cut_plans(const TetMesh& mesh, const ShapeSettings& settings,
                               const BuildVolume& build, const CutSearch& search,
                               std::uint64_t seed, const Progress& progress);

// Cuts the mesh as planned: faces between parts lie within kOnPlane_mm of their planes, except
// where a part would be pinched. Segments are face-connected and closed 2-manifolds. The mesh must
// be the one that was planned for. Throws Error{kInterrupted}.
Segments cut_as_planned(TetMesh& mesh, const CutPlan& plan, const Progress& progress);

}  // namespace packmerger
