#include "shape/divide/adjacency.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "base/error.h"
#include "shape/divide/boundary_surface.h"

namespace packmerger {

std::vector<SegmentEdge> adjacency(const TetMesh& mesh, const Segments& segments) {
  std::map<std::pair<int, int>, double> areas;
  for (int t = 0; t < mesh.count(); ++t)
    for (int face = 0; face < 4; ++face) {
      const int across = mesh.neighbours[t][face];
      if (across < t) continue;  // each face once; the boundary's -1 too
      const auto pair = std::minmax(segments.of_tetrahedron[t], segments.of_tetrahedron[across]);
      if (pair.first != pair.second) areas[pair] += face_area_mm2(mesh, t, face);
    }
  std::vector<SegmentEdge> edges;
  for (const auto& [pair, area] : areas) edges.push_back({pair.first, pair.second, area});
  return edges;
}

std::vector<std::vector<int>> segments_round_cavities(const TetMesh& mesh,
                                                      const Segments& segments) {
  const BoundarySurface surface = boundary_surface(mesh);
  std::vector<std::vector<int>> enclosures;
  for (const std::vector<int>& cavity : cavity_faces(surface)) {
    std::set<int> labels;
    for (const int face : cavity)
      labels.insert(segments.of_tetrahedron[surface.faces[face].tetrahedron]);
    enclosures.emplace_back(labels.begin(), labels.end());
  }
  return enclosures;
}

std::vector<double> segment_volumes(const TetMesh& mesh, const Segments& segments) {
  std::vector<double> volumes(segments.count, 0);
  for (int t = 0; t < mesh.count(); ++t) volumes[segments.of_tetrahedron[t]] += mesh.volume_mm3(t);
  return volumes;
}

Segments united(const Segments& segments, const std::vector<std::vector<int>>& groups) {
  std::vector<int> label_of(segments.count, -1);
  bool each_once = true;
  for (int group = 0; group < static_cast<int>(groups.size()); ++group)
    for (const int label : groups[group]) {
      if (label < 0 || label >= segments.count || label_of[label] >= 0)
        each_once = false;
      else
        label_of[label] = group;
    }
  if (!each_once || std::find(label_of.begin(), label_of.end(), -1) != label_of.end())
    throw Error(Fault::kInternal, "Parts do not hold every segment exactly once",
                "Please report this model to the PackMerger project.");
  Segments result;
  result.count = static_cast<int>(groups.size());
  result.of_tetrahedron.reserve(segments.of_tetrahedron.size());
  for (const int label : segments.of_tetrahedron) result.of_tetrahedron.push_back(label_of[label]);
  return result;
}

std::vector<std::array<int, 2>> cut_edges(const TetMesh& mesh, const Segments& segments,
                                          FaceSide side) {
  const BoundarySurface surface = boundary_surface(mesh);
  std::vector<std::array<int, 2>> edges;
  for (const BoundarySurface::Face& face : surface.faces) {
    if (face.side != side) continue;
    for (int i = 0; i < 3; ++i) {
      const int a = face.corners[i];
      const int b = face.corners[(i + 1) % 3];
      const int beside = surface.faces[face.across[i]].tetrahedron;
      // the neighbour has the same edge the other way round
      if (a < b && segments.of_tetrahedron[face.tetrahedron] != segments.of_tetrahedron[beside])
        edges.push_back({a, b});
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

std::vector<std::array<Vec3, 2>> cut_curves(const TetMesh& mesh, const Segments& segments) {
  std::vector<std::array<Vec3, 2>> curves;
  for (const auto& [a, b] : cut_edges(mesh, segments, FaceSide::kOutside))
    curves.push_back({mesh.points[a], mesh.points[b]});
  return curves;
}

}  // namespace packmerger
