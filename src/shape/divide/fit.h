// Whether a union of segments fits the build volume in some rotation. Internal to this folder.
#pragma once

#include <array>
#include <vector>

#include "model/segments.h"
#include "model/tet_mesh.h"
#include "shape/divide/premerge.h"

namespace packmerger {

// Answers from the extents of each segment along every axis that some rotation turns into x, y or
// z: the extents of a union are the hull of the extents, so no geometry is looked at twice.
class FitTest {
 public:
  // The least and greatest coordinate of one segment along each axis, mm.
  struct Extents {
    std::vector<double> low, high;
  };

  // The rotations are all products of turns about x, then y, then z by multiples of the step, as in
  // the packer.
  explicit FitTest(const BuildVolume& build);

  // By label.
  std::vector<Extents> extents(const TetMesh& mesh, const Segments& segments) const;

  bool fits(const Extents& a, const Extents& b) const;
  // Of a part that holds these points and reaches at most margin_mm / 2 beyond them. False for
  // none.
  bool fits(const std::vector<Vec3>& points, double margin_mm) const;
  static void unite(Extents& into, const Extents& from);

 private:
  Extents extents_of(const std::vector<Vec3>& points) const;

  // Whether a box of this footprint has room between the plate's walls.
  bool has_room(double x_mm, double y_mm) const;

  Vec3 build_mm_;
  std::vector<double> deepest_mm_;  // by x in whole mm; empty where the plate has no walls
  std::vector<Vec3> axes_;          // without opposites
  std::vector<std::array<int, 3>> rotations_;  // which axes become x, y and z
};

}  // namespace packmerger
