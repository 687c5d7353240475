#include "pack/depth_map.h"

#include <algorithm>
#include <cmath>

#include "pack/columns.h"

namespace packmerger {
namespace {

// In cells: what reaches less far into a cell than this does not count as being in it, so that a
// box on the grid keeps to its cells.
constexpr double kCellTolerance = 1e-7;

std::size_t cells(const DepthMaps& maps) {
  return static_cast<std::size_t>(maps.width) * static_cast<std::size_t>(maps.height);
}

std::size_t at(const DepthMaps& maps, int column, int row) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(maps.width) +
         static_cast<std::size_t>(column);
}

void allocate(DepthMaps& maps) {
  maps.low.assign(cells(maps), kNothingAbove);
  maps.top.assign(cells(maps), kNothingBelow);
  maps.bottom.assign(cells(maps), kNothingAbove);
  maps.roof.assign(cells(maps), kNothingBelow);
  maps.hangs.assign(cells(maps), 0);
}

DepthMaps empty_maps_around(const TriangleSoup& surface, double grid) {
  DepthMaps maps;
  for (const Vec3& point : surface.points) maps.box.extend(point);
  const Vec3 low = maps.box.min() / grid;
  const Vec3 high = maps.box.max() / grid;
  maps.x0 = static_cast<int>(std::floor(low.x() + kCellTolerance));
  maps.y0 = static_cast<int>(std::floor(low.y() + kCellTolerance));
  maps.width = std::max(1, static_cast<int>(std::ceil(high.x() - kCellTolerance)) - maps.x0);
  maps.height = std::max(1, static_cast<int>(std::ceil(high.y() - kCellTolerance)) - maps.y0);
  allocate(maps);
  return maps;
}

DepthTriangles in_single_precision(const TriangleSoup& surface) {
  DepthTriangles triangles;
  triangles.points.reserve(surface.points.size());
  for (const Vec3& point : surface.points) triangles.points.push_back(point.cast<float>());
  triangles.triangles.reserve(surface.triangles.size());
  for (const auto& [a, b, c] : surface.triangles)
    triangles.triangles.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
                                   static_cast<std::uint32_t>(c)});
  return triangles;
}

std::vector<std::array<std::uint32_t, 3>> facets_that_need_support(const TriangleSoup& surface,
                                                                   double support_angle) {
  const double limit = support_normal_limit(support_angle);
  std::vector<std::array<std::uint32_t, 3>> found;
  for (const auto& [a, b, c] : surface.triangles) {
    const Vec3& p = surface.points[static_cast<std::size_t>(a)];
    const Vec3 normal = (surface.points[static_cast<std::size_t>(b)] - p)
                            .cross(surface.points[static_cast<std::size_t>(c)] - p);
    if (normal.z() < limit * normal.norm())
      found.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
                       static_cast<std::uint32_t>(c)});
  }
  return found;
}

// A corner of the grid that a facet covers bounds that facet in the four cells round it.
void enter_corners(const DepthMap& above, const DepthMap& below, DepthMaps& maps) {
  for (int j = 0; j <= maps.height; ++j)
    for (int i = 0; i <= maps.width; ++i) {
      const std::size_t ray =
          static_cast<std::size_t>(2 * j) * static_cast<std::size_t>(above.width) +
          static_cast<std::size_t>(2 * i);
      for (int row = std::max(0, j - 1); row <= std::min(j, maps.height - 1); ++row)
        for (int column = std::max(0, i - 1); column <= std::min(i, maps.width - 1); ++column) {
          const std::size_t cell = at(maps, column, row);
          maps.low[cell] = std::min(maps.low[cell], below.heights[ray]);
          maps.top[cell] = std::max(maps.top[cell], above.heights[ray]);
        }
    }
}

void enter_centres(const DepthMap& above, const DepthMap& below, const DepthMap& hanging,
                   DepthMaps& maps) {
  for (int row = 0; row < maps.height; ++row)
    for (int column = 0; column < maps.width; ++column) {
      const std::size_t ray =
          static_cast<std::size_t>(2 * row + 1) * static_cast<std::size_t>(above.width) +
          static_cast<std::size_t>(2 * column + 1);
      const std::size_t cell = at(maps, column, row);
      maps.bottom[cell] = below.heights[ray];
      maps.roof[cell] = above.heights[ray];
      maps.hangs[cell] = hanging.heights[ray] != kNothingAbove &&
                         hanging.heights[ray] <= below.heights[ray] + 1e-3F;
    }
}

// Walks an edge from cell to cell; between two grid lines it is extreme at its ends.
void enter_edge(const Vec3& a, const Vec3& b, double grid, std::vector<double>& cuts,
                DepthMaps& maps) {
  cuts.assign({0, 1});
  for (int axis = 0; axis < 2; ++axis) {
    const double from = a[axis] / grid;
    const double to = b[axis] / grid;
    const double low = std::min(from, to);
    const double high = std::max(from, to);
    for (double line = std::floor(low) + 1; line < high; ++line)
      cuts.push_back(std::clamp((line - from) / (to - from), 0.0, 1.0));
  }
  std::sort(cuts.begin(), cuts.end());
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    const Vec3 middle = a + (b - a) * ((cuts[i] + cuts[i + 1]) / 2);
    const int column =
        std::clamp(static_cast<int>(std::floor(middle.x() / grid)) - maps.x0, 0, maps.width - 1);
    const int row =
        std::clamp(static_cast<int>(std::floor(middle.y() / grid)) - maps.y0, 0, maps.height - 1);
    const std::size_t cell = at(maps, column, row);
    for (const double t : {cuts[i], cuts[i + 1]}) {
      const float z = static_cast<float>(a.z() + (b.z() - a.z()) * t);
      maps.low[cell] = std::min(maps.low[cell], z);
      maps.top[cell] = std::max(maps.top[cell], z);
    }
  }
}

void enter_edges(const TriangleSoup& surface, double grid, DepthMaps& maps) {
  std::vector<double> cuts;
  for (const auto& triangle : surface.triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const int a = triangle[i];
      const int b = triangle[(i + 1) % 3];
      // In a closed surface every edge comes once in each direction.
      if (a < b)
        enter_edge(surface.points[static_cast<std::size_t>(a)],
                   surface.points[static_cast<std::size_t>(b)], grid, cuts, maps);
    }
}

DepthMaps once_turned(const DepthMaps& maps) {
  DepthMaps turned;
  turned.x0 = -(maps.y0 + maps.height);
  turned.y0 = maps.x0;
  turned.width = maps.height;
  turned.height = maps.width;
  turned.box.extend(Vec3(-maps.box.max().y(), maps.box.min().x(), maps.box.min().z()));
  turned.box.extend(Vec3(-maps.box.min().y(), maps.box.max().x(), maps.box.max().z()));
  allocate(turned);
  for (int row = 0; row < maps.height; ++row)
    for (int column = 0; column < maps.width; ++column) {
      const std::size_t from = at(maps, column, row);
      const std::size_t to = at(turned, maps.height - 1 - row, column);
      turned.low[to] = maps.low[from];
      turned.top[to] = maps.top[from];
      turned.bottom[to] = maps.bottom[from];
      turned.roof[to] = maps.roof[from];
      turned.hangs[to] = maps.hangs[from];
    }
  return turned;
}

}  // namespace

DepthMaps draw_depth_maps(DepthRenderer& renderer, const TriangleSoup& surface, double grid_mm,
                          double support_angle) {
  DepthMaps maps = empty_maps_around(surface, grid_mm);
  // Half steps: even rays are the cells' corners, odd ones their centres.
  const RayLattice rays{maps.x0 * grid_mm, maps.y0 * grid_mm, grid_mm / 2, 2 * maps.width + 1,
                        2 * maps.height + 1};
  DepthTriangles triangles = in_single_precision(surface);
  const DepthMap above = renderer.from_above(triangles, rays);
  const DepthMap below = renderer.from_below(triangles, rays);
  triangles.triangles = facets_that_need_support(surface, support_angle);
  const DepthMap hanging = renderer.from_below(triangles, rays);
  enter_corners(above, below, maps);
  enter_centres(above, below, hanging, maps);
  enter_edges(surface, grid_mm, maps);
  return maps;
}

DepthMaps quarter_turned(const DepthMaps& maps, int quarters) {
  DepthMaps turned = maps;
  for (int i = 0; i < quarters; ++i) turned = once_turned(turned);
  return turned;
}

DepthMaps united_maps(const std::vector<const DepthMaps*>& members) {
  DepthMaps all;
  int x1 = members.front()->x0;
  int y1 = members.front()->y0;
  all.x0 = x1;
  all.y0 = y1;
  for (const DepthMaps* member : members) {
    all.x0 = std::min(all.x0, member->x0);
    all.y0 = std::min(all.y0, member->y0);
    x1 = std::max(x1, member->x0 + member->width);
    y1 = std::max(y1, member->y0 + member->height);
    all.box.extend(member->box);
  }
  all.width = x1 - all.x0;
  all.height = y1 - all.y0;
  allocate(all);
  for (const DepthMaps* member : members)
    for (int row = 0; row < member->height; ++row)
      for (int column = 0; column < member->width; ++column) {
        const std::size_t from = at(*member, column, row);
        const std::size_t to = at(all, column + member->x0 - all.x0, row + member->y0 - all.y0);
        all.low[to] = std::min(all.low[to], member->low[from]);
        all.top[to] = std::max(all.top[to], member->top[from]);
        all.roof[to] = std::max(all.roof[to], member->roof[from]);
        if (member->bottom[from] < all.bottom[to]) {
          all.bottom[to] = member->bottom[from];
          all.hangs[to] = member->hangs[from];
        }
      }
  return all;
}

}  // namespace packmerger
