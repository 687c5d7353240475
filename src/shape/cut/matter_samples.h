// A tetrahedral mesh as a few ten thousand points that know their neighbours: fine enough to judge
// a division by, small enough to judge thousands. Internal to this folder.
#pragma once

#include <span>
#include <vector>

#include "model/tet_mesh.h"

namespace packmerger {

// At most one sample in each cube of spacing_mm, one in every cube that holds matter; surfaces are
// preferred to insides, so extents are right.
struct MatterSamples {
  double spacing_mm = 0;
  std::vector<Vec3> points;
  std::vector<double> volumes_mm3;  // sum to the mesh's volume
  std::vector<Vec3> areas_mm2;      // of the mesh's boundary nearby, as outward vectors
  std::vector<int> of_tetrahedron;  // a sample in or beside each tetrahedron
  // Links between samples of all neighbouring cubes, so that what is connected stays connected, as
  // compressed rows, the short ones first. A plane through the matter crosses one short link for
  // every area_per_link_mm2 of its cross-section, on average.
  std::vector<int> first_link;
  std::vector<int> first_long_link;
  std::vector<int> links;
  double area_per_link_mm2 = 0;
  std::vector<std::vector<int>> round_cavities;  // the samples on each cavity's surface, ascending
  double volume_mm3 = 0;

  int count() const { return static_cast<int>(points.size()); }
  std::span<const int> linked_to(int sample) const {
    return {links.data() + first_link[sample],
            static_cast<std::size_t>(first_link[sample + 1] - first_link[sample])};
  }
  std::span<const int> near_to(int sample) const {  // the short links
    return {links.data() + first_link[sample],
            static_cast<std::size_t>(first_long_link[sample] - first_link[sample])};
  }
};

// About `target` samples. Throws Error{kBadInput} when the mesh holds no tetrahedron.
MatterSamples sample_matter(const TetMesh& mesh, int target);

}  // namespace packmerger
