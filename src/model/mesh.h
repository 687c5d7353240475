// Surfaces. Mesh is the noun of the house: indexed triangles that were checked and do not change
// any more. TriangleSoup is what files hold before anyone has looked whether it is a surface at
// all.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "base/geometry.h"

namespace packmerger {

struct TriangleSoup {
  std::vector<Vec3> points;                   // mm, or the file's unit where a header says so
  std::vector<std::array<int, 3>> triangles;  // indices into points, counter-clockwise from outside
};

// A 2-manifold: at most two triangles meet at an edge, turned alike, and one fan of them at a
// point. Every point is some triangle's corner. Copies share what they hold, and copies that were
// moved share their triangles. Const, so any thread may read it. Moved from: only assign to it.
//
// Everywhere but in the inside of a verb a Mesh is closed, and its normals point out of the matter;
// it may have several components, and inner ones (cavities) are oriented towards the empty side.
// closed_mesh() looks whether it is closed; which side the matter is on only a whole model tells,
// and shape/surface/orient.h asks it. No two points lie at the same position.
class Mesh {
 public:
  Mesh();  // nothing, closed

  const std::vector<Vec3>& points() const { return *points_; }  // mm
  const std::vector<std::array<int, 3>>& triangles() const { return faces_->corners; }
  // For each triangle those beside it: [k] is across the edge from corner k to the next; -1 where
  // the surface ends.
  const std::vector<std::array<int, 3>>& neighbours() const { return faces_->neighbours; }

  bool is_closed() const { return faces_->are_closed; }
  bool empty() const { return triangles().empty(); }
  std::size_t n_points() const { return points().size(); }
  std::size_t n_triangles() const { return triangles().size(); }

  // The corners of one triangle, counter-clockwise seen from outside. The third comes first: what
  // is summed over them is the same to the last bit as in job folders of earlier versions.
  std::array<Vec3, 3> corners(std::size_t triangle) const {
    const auto& [a, b, c] = triangles()[triangle];
    const std::vector<Vec3>& at = points();
    return {at[static_cast<std::size_t>(c)], at[static_cast<std::size_t>(a)],
            at[static_cast<std::size_t>(b)]};
  }

  // The same triangles with their points elsewhere, in the same order and as many.
  Mesh with_points(std::vector<Vec3> points) const;

 private:
  struct Faces {
    std::vector<std::array<int, 3>> corners;
    std::vector<std::array<int, 3>> neighbours;
    bool are_closed = true;
  };
  Mesh(std::vector<Vec3> points, Faces faces);
  friend Mesh manifold_mesh(TriangleSoup soup);
  friend Mesh united(const std::vector<const Mesh*>& meshes);

  std::shared_ptr<const std::vector<Vec3>> points_;
  std::shared_ptr<const Faces> faces_;
};

// A soup or a mesh as verbs read it that do not care which of them it is. Lives no longer than what
// it looks at.
struct TriangleView {
  TriangleView(const TriangleSoup& soup)  // NOLINT(google-explicit-constructor)
      : points(soup.points), triangles(soup.triangles) {}
  TriangleView(const Mesh& mesh)  // NOLINT(google-explicit-constructor)
      : points(mesh.points()), triangles(mesh.triangles()) {}

  std::span<const Vec3> points;
  std::span<const std::array<int, 3>> triangles;
};

// Drops points that no triangle uses; the order of the others is kept.
TriangleSoup without_unused_points(TriangleSoup soup);

// The mesh of the soup, less points that no triangle uses, in the same order. Throws
// Error{kBadInput} when it is no 2-manifold (OpenMesh tells, half_edges.h).
Mesh manifold_mesh(TriangleSoup soup);

// The same, and throws Error{kBadInput} where an edge has one side only.
Mesh closed_mesh(TriangleSoup soup);

// For those who change what they copy.
TriangleSoup to_soup(const TriangleView& surface);

// Signed: cavities count negative. mm³.
double volume_mm3(const Mesh& mesh);
double area_mm2(const Mesh& mesh);
Box3 bounding_box(const Mesh& mesh);

// Every point p at pose * p.
Mesh transformed(const Mesh& mesh, const Pose& pose);

// The disjoint union of several meshes, without any boolean operation.
Mesh united(const std::vector<const Mesh*>& meshes);

}  // namespace packmerger
