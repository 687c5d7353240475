// Signed distance to a surface on a sparse grid, and its levels as surfaces: OpenVDB (Museth,
// 2013), which no other file includes.
#pragma once

#include <memory>
#include <optional>

#include "base/progress.h"
#include "model/mesh.h"

namespace packmerger {

// What becomes of sheets between which and the outside no voxel lies, such as the walls of a
// crevice.
enum class NarrowSheets {
  kCount,  // distances are measured to them as to others
  kDrop,   // they may be inner ones, of bodies that overlap: no distance is measured to them
};

class DistanceGrid {
 public:
  // Exact near the surface: from inside_mm below it to outside_mm above. What no way from outside
  // leads to without crossing a triangle is inside, so pieces that overlap become one; components
  // that are oriented inwards are cavities.
  // mesh: closed; it may intersect itself.
  // Throws Error{kBadInput} when about more than 200 million voxels are needed.
  DistanceGrid(const Mesh& mesh, double voxel_mm, double inside_mm, double outside_mm,
               NarrowSheets sheets, const Progress& progress);
  DistanceGrid(DistanceGrid&&) noexcept;
  ~DistanceGrid();

  // The surface around what is less than level_mm outside (negative: more than that inside), closed
  // and manifold, normals pointing away from it; possibly empty. Where the level pinches itself,
  // the enclosed side gives way, by up to a voxel, and the grid keeps that. Empty optional: it
  // stays pinched; another level or voxel may not be.
  std::optional<TriangleSoup> level(double level_mm, const Progress& progress);

 private:
  struct Grid;
  std::unique_ptr<Grid> grid_;
};

}  // namespace packmerger
