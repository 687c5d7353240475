#include "shape/solid/inside_point.h"

#include <algorithm>

#include "base/error.h"
#include "shape/surface/surface_query.h"

namespace packmerger {

Vec3 point_inside(const TriangleView& soup) {
  constexpr std::size_t kChords = 64;
  const SurfaceQuery query(soup);
  Vec3 best = Vec3::Zero();
  double longest = 0;
  const std::size_t count = soup.triangles.size();
  // All triangles are tried when the first chords found nothing.
  for (const std::size_t step : {std::max<std::size_t>(1, count / kChords), std::size_t{1}}) {
    for (std::size_t i = 0; i < count; i += step) {
      const auto& [a, b, c] = soup.triangles[i];
      const Vec3 normal =
          (soup.points[b] - soup.points[a]).cross(soup.points[c] - soup.points[a]).normalized();
      if (!normal.allFinite()) continue;
      const Vec3 middle = (soup.points[a] + soup.points[b] + soup.points[c]) / 3;
      const auto chord = query.ray_mm(middle, -normal);
      if (!chord || *chord <= longest) continue;
      const Vec3 candidate = middle - normal * (*chord / 2);
      if (query.winding_number(candidate) == 0) continue;
      best = candidate;
      longest = *chord;
    }
    if (longest > 0) return best;
  }
  throw Error(Fault::kBadInput, "A cavity of the model encloses no space",
              "Remove the cavity in a mesh editor and try again.");
}

}  // namespace packmerger
