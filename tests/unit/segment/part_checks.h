// What must hold of every division of a mesh into parts.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "base/random.h"
#include "model/mesh.h"
#include "shape/divide/adjacency.h"
#include "shape/divide/part_surface.h"

namespace packmerger::checks {

// The mesh is linked both ways, positively oriented, and fills `volume_mm3`.
inline void expect_sound_mesh(const TetMesh& mesh, double volume_mm3) {
  ASSERT_EQ(mesh.tetrahedra.size(), mesh.neighbours.size());
  ASSERT_EQ(mesh.tetrahedra.size(), mesh.sides.size());
  int inverted = 0, unlinked = 0, mismarked = 0;
  TetMesh linked = mesh;
  link_neighbours(linked);
  for (int t = 0; t < mesh.count(); ++t) {
    inverted += mesh.volume_mm3(t) <= 0 ? 1 : 0;
    for (int f = 0; f < 4; ++f) {
      unlinked += linked.neighbours[t][f] != mesh.neighbours[t][f] ? 1 : 0;
      mismarked +=
          (mesh.neighbours[t][f] >= 0) != (mesh.sides[t][f] == FaceSide::kInterior) ? 1 : 0;
    }
  }
  EXPECT_EQ(inverted, 0);
  EXPECT_EQ(unlinked, 0);
  EXPECT_EQ(mismarked, 0);
  EXPECT_NEAR(total_volume_mm3(mesh), volume_mm3, 1e-3 * volume_mm3);
}

inline int face_connected_pieces(const TetMesh& mesh, const Segments& segments) {
  std::vector<char> seen(mesh.tetrahedra.size(), 0);
  std::vector<int> stack;
  int pieces = 0;
  for (int start = 0; start < mesh.count(); ++start) {
    if (seen[start]) continue;
    ++pieces;
    seen[start] = 1;
    stack.assign(1, start);
    while (!stack.empty()) {
      const int t = stack.back();
      stack.pop_back();
      for (const int across : mesh.neighbours[t]) {
        if (across < 0 || seen[across] ||
            segments.of_tetrahedron[across] != segments.of_tetrahedron[t])
          continue;
        seen[across] = 1;
        stack.push_back(across);
      }
    }
  }
  return pieces;
}

// Every tetrahedron in one segment, segments connected and not empty, surfaces closed, manifold,
// outward, with the volume of their tetrahedra; volumes sum to the mesh's.
inline void expect_proper_parts(const TetMesh& mesh, const Segments& segments) {
  ASSERT_EQ(segments.of_tetrahedron.size(), mesh.tetrahedra.size());
  std::vector<int> sizes(segments.count, 0);
  for (const int label : segments.of_tetrahedron) {
    ASSERT_GE(label, 0);
    ASSERT_LT(label, segments.count);
    ++sizes[label];
  }
  EXPECT_EQ(std::count(sizes.begin(), sizes.end(), 0), 0);
  EXPECT_EQ(face_connected_pieces(mesh, segments), segments.count);
  double sum = 0;
  for (const SegmentSurface& part : part_surfaces(mesh, segments)) {
    EXPECT_GT(part.volume_mm3, 0);
    EXPECT_NEAR(volume_mm3(part.surface), part.volume_mm3, 1e-6 * part.volume_mm3 + 1e-9);
    sum += volume_mm3(part.surface);
  }
  const double whole = total_volume_mm3(mesh);
  EXPECT_NEAR(sum, whole, 1e-3 * whole);
}

// Joins random neighbours until `count` are left.
inline Segments randomly_merged(const TetMesh& mesh, Segments segments, int count, Random& random) {
  while (segments.count > count) {
    const auto edges = adjacency(mesh, segments);
    if (edges.empty()) break;
    const SegmentEdge edge = edges[random.below(edges.size())];
    std::vector<std::vector<int>> groups;
    for (int label = 0; label < segments.count; ++label)
      if (label != edge.a && label != edge.b) groups.push_back({label});
    groups.push_back({edge.a, edge.b});
    segments = united(segments, groups);
  }
  return segments;
}

}  // namespace packmerger::checks
