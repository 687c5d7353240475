// How a division by planes came about, so that it can be repeated exactly on the tetrahedra.
// Internal to this folder.
#pragma once

#include <memory>
#include <vector>

#include "base/progress.h"
#include "shape/cut/matter_samples.h"
#include "shape/cut/plane_cut.h"

namespace packmerger {

// A region of the model and what became of it.
struct CutNode {
  enum class Kind {
    kPart,    // nothing: it is a part
    kSame,    // it went into next[0], with other regions perhaps
    kPlane,   // next[0] is what lies below the plane, next[1] what lies above
    kPieces,  // it fell apart into pieces that do not touch: (*members)[i] became next[i]
  };
  Kind kind = Kind::kPart;
  std::vector<int> next;
  Plane plane;
  std::shared_ptr<const std::vector<std::vector<int>>> members;  // samples
};

// Node 0 is the whole model. Regions that were united lead to the same node, so this is a graph,
// without cycles.
using CutTree = std::vector<CutNode>;

// Cuts the mesh apart as the tree tells. Planes between regions that were united again cut nothing.
// Pieces smaller than least_mm3 go to a neighbour; every segment is face-connected. Parts may still
// be pinched (make_manifold). Throws Error{kInterrupted}.
Segments cut_apart(TetMesh& mesh, const CutTree& tree, const MatterSamples& samples,
                   double least_mm3, const Progress& progress);

}  // namespace packmerger
