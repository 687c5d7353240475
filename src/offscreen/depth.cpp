#include <algorithm>
#include <cmath>
#include <map>

#include "offscreen/offscreen.h"
#include "offscreen/surface.h"

namespace packmerger {

struct DepthRenderer::Surface {
  std::map<int, std::unique_ptr<DrawingSurface>> by_size;

  // The surface's size enters the rounding of depths, so it must follow from what is drawn and not
  // from what was drawn before.
  DrawingSurface& for_size(int width, int height) {
    int size = 64;
    while (size < std::max(width, height)) size *= 2;
    std::unique_ptr<DrawingSurface>& drawing = by_size[size];
    if (!drawing) drawing = std::make_unique<DrawingSurface>(size, size);
    return *drawing;
  }
};

DepthRenderer::DepthRenderer() : surface_(std::make_unique<Surface>()) {}
DepthRenderer::DepthRenderer(DepthRenderer&&) noexcept = default;
DepthRenderer& DepthRenderer::operator=(DepthRenderer&&) noexcept = default;
DepthRenderer::~DepthRenderer() = default;

namespace {

struct HeightRange {
  double low = 0;
  double high = 1;
};

// The triangles' heights with room on both sides, so that no facet lies on a clipping plane.
HeightRange height_range(const DepthTriangles& triangles) {
  HeightRange range{kNothingAbove, kNothingBelow};
  for (const Eigen::Vector3f& point : triangles.points) {
    range.low = std::min<double>(range.low, point.z());
    range.high = std::max<double>(range.high, point.z());
  }
  const double room = 1e-3 * (range.high - range.low) + 1e-3;
  return {range.low - room, range.high + room};
}

// Pixel centres fall on the rays, and depth 0 is `near_z`, depth 1 `far_z`.
void look_along_z(const RayLattice& rays, double near_z, double far_z) {
  const double left = rays.x_mm - rays.step_mm / 2;
  const double bottom = rays.y_mm - rays.step_mm / 2;
  const double width = rays.width * rays.step_mm;
  const double height = rays.height * rays.step_mm;
  const double depth = far_z - near_z;
  const std::array<double, 16> projection{2 / width,
                                          0,
                                          0,
                                          0,
                                          0,
                                          2 / height,
                                          0,
                                          0,
                                          0,
                                          0,
                                          2 / depth,
                                          0,
                                          -1 - 2 * left / width,
                                          -1 - 2 * bottom / height,
                                          -1 - 2 * near_z / depth,
                                          1};
  glMatrixMode(GL_PROJECTION);
  glLoadMatrixd(projection.data());
  glMatrixMode(GL_MODELVIEW);
  glLoadIdentity();
}

DepthMap draw_depth(const DepthTriangles& triangles, const RayLattice& rays, double near_z,
                    double far_z, float nothing) {
  glViewport(0, 0, rays.width, rays.height);
  look_along_z(rays, near_z, far_z);
  glDisable(GL_CULL_FACE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  glClearDepth(1);
  glClear(GL_DEPTH_BUFFER_BIT);
  glEnableClientState(GL_VERTEX_ARRAY);
  glVertexPointer(3, GL_FLOAT, sizeof(Eigen::Vector3f), triangles.points.data());
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * triangles.triangles.size()),
                 GL_UNSIGNED_INT, triangles.triangles.data());
  glDisableClientState(GL_VERTEX_ARRAY);

  DepthMap map{rays.width, rays.height, {}};
  map.heights.resize(static_cast<std::size_t>(rays.width) * static_cast<std::size_t>(rays.height));
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, rays.width, rays.height, GL_DEPTH_COMPONENT, GL_FLOAT, map.heights.data());
  for (float& value : map.heights)
    value = value >= 1.0F ? nothing : static_cast<float>(near_z + (far_z - near_z) * value);
  return map;
}

DepthMap no_hits(const RayLattice& rays, float nothing) {
  DepthMap map{rays.width, rays.height, {}};
  map.heights.assign(static_cast<std::size_t>(rays.width) * static_cast<std::size_t>(rays.height),
                     nothing);
  return map;
}

}  // namespace

DepthMap DepthRenderer::from_above(const DepthTriangles& triangles, const RayLattice& rays) {
  if (triangles.triangles.empty()) return no_hits(rays, kNothingBelow);
  const DrawingSurface::Current current(surface_->for_size(rays.width, rays.height));
  const HeightRange range = height_range(triangles);
  return draw_depth(triangles, rays, range.high, range.low, kNothingBelow);
}

DepthMap DepthRenderer::from_below(const DepthTriangles& triangles, const RayLattice& rays) {
  if (triangles.triangles.empty()) return no_hits(rays, kNothingAbove);
  const DrawingSurface::Current current(surface_->for_size(rays.width, rays.height));
  const HeightRange range = height_range(triangles);
  return draw_depth(triangles, rays, range.low, range.high, kNothingAbove);
}

}  // namespace packmerger
