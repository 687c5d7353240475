// What OSMesa's z-buffer draws of a surface, for tests and measurements.
#pragma once

#include "offscreen/offscreen.h"

namespace packmerger::shapes {

inline DepthTriangles depth_triangles(const TriangleSoup& surface) {
  DepthTriangles result;
  for (const Vec3& point : surface.points) result.points.push_back(point.cast<float>());
  for (const auto& [a, b, c] : surface.triangles)
    result.triangles.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
                                static_cast<std::uint32_t>(c)});
  return result;
}

}  // namespace packmerger::shapes
