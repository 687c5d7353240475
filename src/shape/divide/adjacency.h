// What segments have in common: the paper's adjacency graph (section 5), volumes, and unions.
#pragma once

#include <array>
#include <vector>

#include "model/segments.h"
#include "model/tet_mesh.h"

namespace packmerger {

// Every pair of segments that shares faces, with their area; sorted by (a, b), a < b.
std::vector<SegmentEdge> adjacency(const TetMesh& mesh, const Segments& segments);

// For each hollowed cavity the segments that it touches, sorted.
std::vector<std::vector<int>> segments_round_cavities(const TetMesh& mesh,
                                                      const Segments& segments);

// By label, mm³.
std::vector<double> segment_volumes(const TetMesh& mesh, const Segments& segments);

// groups[i] are the labels that become label i. Every label must stand in exactly one group:
// Error{kInternal} otherwise.
Segments united(const Segments& segments, const std::vector<std::vector<int>>& groups);

// The edges of the boundary (kOutside or kCavity) whose two boundary faces belong to different
// segments, as indices into mesh.points; each once, lower index first, sorted.
std::vector<std::array<int, 2>> cut_edges(const TetMesh& mesh, const Segments& segments,
                                          FaceSide side);

// The cut edges on the model's outside as positions, for pictures.
std::vector<std::array<Vec3, 2>> cut_curves(const TetMesh& mesh, const Segments& segments);

}  // namespace packmerger
