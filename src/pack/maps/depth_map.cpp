#include "pack/maps/depth_map.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "model/sentinel_heights.h"
#include "pack/maps/columns.h"

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

// Of the size that the surface asks for, nothing allocated.
DepthMaps frame_around(const Mesh& surface, double grid) {
  DepthMaps maps;
  for (const Vec3& point : surface.points()) maps.box.extend(point);
  const Vec3 low = maps.box.min() / grid;
  const Vec3 high = maps.box.max() / grid;
  maps.x0 = static_cast<int>(std::floor(low.x() + kCellTolerance));
  maps.y0 = static_cast<int>(std::floor(low.y() + kCellTolerance));
  maps.width = std::max(1, static_cast<int>(std::ceil(high.x() - kCellTolerance)) - maps.x0);
  maps.height = std::max(1, static_cast<int>(std::ceil(high.y() - kCellTolerance)) - maps.y0);
  return maps;
}

// A point of the rotated frame: x and y in cells from the maps' corner, so never below 0 by more
// than rounding and truncation is the floor; z in mm.
struct CellPoint {
  double x;
  double y;
  double z;
};

std::vector<CellPoint> in_cells(const std::vector<Vec3>& points, double grid,
                                const DepthMaps& maps) {
  std::vector<CellPoint> result;
  result.reserve(points.size());
  const double scale = 1 / grid;
  for (const Vec3& point : points)
    result.push_back({point.x() * scale - maps.x0, point.y() * scale - maps.y0, point.z()});
  return result;
}

// The corners of a triangle from low to high along one axis. Where a side lies is computed from its
// lower end whatever triangle it belongs to, so that neighbours meet without a gap.
template <double CellPoint::*kAlong, double CellPoint::*kAcross>
struct SortedTriangle {
  struct Place {
    double across;
    double z;
  };

  SortedTriangle(const CellPoint& p, const CellPoint& q, const CellPoint& r) {
    // Which corner is which is as good as random: chosen without branches.
    const CellPoint* low = q.*kAlong < p.*kAlong ? &q : &p;
    const CellPoint* high = q.*kAlong < p.*kAlong ? &p : &q;
    const CellPoint* upper = r.*kAlong < high->*kAlong ? &r : high;
    last = r.*kAlong < high->*kAlong ? high : &r;
    first = upper->*kAlong < low->*kAlong ? upper : low;
    middle = upper->*kAlong < low->*kAlong ? low : upper;
  }

  // Where the line at `along` meets a side that it must pass strictly above `low`.
  static Place on_side(const CellPoint& low, const CellPoint& high, double along) {
    const double t = (along - low.*kAlong) / (high.*kAlong - low.*kAlong);
    return {low.*kAcross + t * (high.*kAcross - low.*kAcross), low.z + t * (high.z - low.z)};
  }
  Place long_side(double along) const { return on_side(*first, *last, along); }
  Place short_sides(double along) const {
    const bool lower = along <= middle->*kAlong;
    return on_side(lower ? *first : *middle, lower ? *middle : *last, along);
  }

  const CellPoint* first;
  const CellPoint* middle;
  const CellPoint* last;
};

// The cells along one axis that a triangle reaches into; none where it lies in a line of the grid:
// what it closes there is entered by its neighbours.
struct CellRange {
  int first;
  int last;

  CellRange(double low, double high, int cells)
      : first(static_cast<int>(low + kCellTolerance)),
        last(std::min(static_cast<int>(high - kCellTolerance), cells - 1)) {}
  int holding(double where) const { return std::clamp(static_cast<int>(where), first, last); }
};

// The number of cells whose centres lie at or below `where`: of a triangle's two sides one owns the
// centres exactly on it.
int centres_up_to(double where) {
  const int cell = static_cast<int>(where);
  return where - cell >= 0.5 ? cell + 1 : cell;  // exact, unlike rounding where + 0.5
}

// The triangles that lie over some centre along x and along y; small ones mostly do not. Told
// without branches, which would be as good as random.
std::vector<int> triangles_over_centres(const Mesh& surface, const std::vector<CellPoint>& points) {
  struct Passed {  // centres along both axes
    int columns;
    int rows;
  };
  std::vector<Passed> passed;
  passed.reserve(points.size());
  for (const CellPoint& point : points)
    passed.push_back({centres_up_to(point.x), centres_up_to(point.y)});
  std::vector<int> found(surface.triangles().size());
  std::size_t count = 0;
  int index = 0;
  for (const auto& [a, b, c] : surface.triangles()) {
    const Passed& p = passed[static_cast<std::size_t>(a)];
    const Passed& q = passed[static_cast<std::size_t>(b)];
    const Passed& r = passed[static_cast<std::size_t>(c)];
    const int columns = (p.columns ^ q.columns) | (p.columns ^ r.columns);
    const int rows = (p.rows ^ q.rows) | (p.rows ^ r.rows);
    found[count] = index++;
    count += static_cast<std::size_t>((columns != 0) & (rows != 0));
  }
  found.resize(count);
  return found;
}

class Rasterizer {
 public:
  Rasterizer(DepthMaps& maps, double grid, double normal_limit)
      : maps_(maps), grid_(grid), normal_limit_(normal_limit) {}

  // Into `low` and `top`.
  void enter_extent(const CellPoint& a, const CellPoint& b, const CellPoint& c) {
    const CellRange columns(std::min({a.x, b.x, c.x}), std::max({a.x, b.x, c.x}), maps_.width);
    const CellRange rows(std::min({a.y, b.y, c.y}), std::max({a.y, b.y, c.y}), maps_.height);
    if (columns.last < columns.first || rows.last < rows.first) return;
    if (columns.first == columns.last && rows.first == rows.last) {
      enter_bounds(at(maps_, columns.first, rows.first), std::min({a.z, b.z, c.z}),
                   std::max({a.z, b.z, c.z}));
      return;
    }
    for (const CellPoint* corner : {&a, &b, &c})
      enter_bounds(at(maps_, columns.holding(corner->x), rows.holding(corner->y)), corner->z,
                   corner->z);
    enter_lines<&CellPoint::x, &CellPoint::y>(a, b, c, columns, rows, 1, maps_.width);
    enter_lines<&CellPoint::y, &CellPoint::x>(a, b, c, rows, columns, maps_.width, 1);
  }

  // Into `bottom`, `roof` and `hangs`.
  void enter_centres(const CellPoint& a, const CellPoint& b, const CellPoint& c) {
    const Vec3 normal = normal_of(a, b, c);
    if (normal.z() == 0) return;
    const auto hangs = [&] {
      const Vec3 in_mm(normal.x(), normal.y(), normal.z() * grid_);
      return static_cast<std::uint8_t>(in_mm.z() < normal_limit_ * in_mm.norm() ? 1 : 0);
    };
    for_each_centre(a, b, c, normal,
                    [&](std::size_t cell, float z) { enter_centre(cell, z, hangs); });
  }

  // Into `roof`, facets that face up only: of a closed surface the others lie below them.
  void enter_roof(const CellPoint& a, const CellPoint& b, const CellPoint& c) {
    const Vec3 normal = normal_of(a, b, c);
    if (normal.z() <= 0) return;
    for_each_centre(a, b, c, normal, [&](std::size_t cell, float z) {
      maps_.roof[cell] = std::max(maps_.roof[cell], z);
    });
  }

 private:
  static Vec3 normal_of(const CellPoint& a, const CellPoint& b, const CellPoint& c) {
    return Vec3(b.x - a.x, b.y - a.y, b.z - a.z).cross(Vec3(c.x - a.x, c.y - a.y, c.z - a.z));
  }

  // enter(cell, height) for the cells whose centre lies over the triangle.
  template <typename Enter>
  void for_each_centre(const CellPoint& a, const CellPoint& b, const CellPoint& c,
                       const Vec3& normal, const Enter& enter) {
    // Steep facets are steeper still after rounding, but their heights remain theirs.
    const double low = std::min({a.z, b.z, c.z});
    const double high = std::max({a.z, b.z, c.z});
    const double slope_x = -normal.x() / normal.z();
    const double slope_y = -normal.y() / normal.z();
    const SortedTriangle<&CellPoint::y, &CellPoint::x> sorted(a, b, c);
    const int end = centres_up_to(sorted.last->y);
    for (int row = centres_up_to(sorted.first->y); row < end; ++row) {
      const double y = row + 0.5;
      const double left = sorted.long_side(y).across;
      const double right = sorted.short_sides(y).across;
      const int last = centres_up_to(std::max(left, right));
      for (int column = centres_up_to(std::min(left, right)); column < last; ++column) {
        const double z = a.z + slope_x * (column + 0.5 - a.x) + slope_y * (y - a.y);
        enter(at(maps_, column, row), static_cast<float>(std::clamp(z, low, high)));
      }
    }
  }

  void enter_bounds(std::size_t cell, double low, double high) {
    maps_.low[cell] = std::min(maps_.low[cell], static_cast<float>(low));
    maps_.top[cell] = std::max(maps_.top[cell], static_cast<float>(high));
  }

  // On a cell's part of a facet, a height is extreme at the facet's corners and where the facet
  // crosses the cell's sides. Enters the crossings with the grid lines between cells `along` into
  // the cells on both sides of each; step and side_step lead to the next cell along and across.
  template <double CellPoint::*kAlong, double CellPoint::*kAcross>
  void enter_lines(const CellPoint& a, const CellPoint& b, const CellPoint& c,
                   const CellRange& along, const CellRange& across, int step, int side_step) {
    if (along.first == along.last) return;
    const SortedTriangle<kAlong, kAcross> sorted(a, b, c);
    for (int line = along.first + 1; line <= along.last; ++line) {
      const auto one = sorted.long_side(line);
      const auto other = sorted.short_sides(line);
      const bool turned = other.across < one.across;
      const auto from = turned ? other : one;
      const auto to = turned ? one : other;
      const int last = across.holding(to.across);
      int side = across.holding(from.across);
      std::size_t cell = static_cast<std::size_t>(line * step + side * side_step);
      double z = from.z;
      const double slope = side < last ? (to.z - from.z) / (to.across - from.across) : 0;
      for (; side <= last; ++side, cell += static_cast<std::size_t>(side_step)) {
        const double next = side == last ? to.z : from.z + slope * (side + 1 - from.across);
        const double low = std::min(z, next);
        const double high = std::max(z, next);
        enter_bounds(cell, low, high);
        enter_bounds(cell - static_cast<std::size_t>(step), low, high);
        z = next;
      }
    }
  }

  // hangs() is asked for the lowest only.
  template <typename Hangs>
  void enter_centre(std::size_t cell, float z, const Hangs& hangs) {
    maps_.roof[cell] = std::max(maps_.roof[cell], z);
    if (z > maps_.bottom[cell]) return;
    maps_.hangs[cell] = z < maps_.bottom[cell] ? hangs() : maps_.hangs[cell] | hangs();
    maps_.bottom[cell] = z;
  }

  DepthMaps& maps_;
  double grid_;
  double normal_limit_;
};

template <bool kExtents>
DepthMaps drawn(const Mesh& surface, double grid_mm, double support_angle) {
  DepthMaps maps = frame_around(surface, grid_mm);
  allocate(maps);
  const std::vector<CellPoint> points = in_cells(surface.points(), grid_mm, maps);
  Rasterizer rasterizer(maps, grid_mm, support_normal_limit(support_angle));
  const auto corner = [&](int triangle, std::size_t i) -> const CellPoint& {
    const auto& corners = surface.triangles()[static_cast<std::size_t>(triangle)];
    return points[static_cast<std::size_t>(corners[i])];
  };
  if constexpr (kExtents)
    for (int t = 0; t < static_cast<int>(surface.triangles().size()); ++t)
      rasterizer.enter_extent(corner(t, 0), corner(t, 1), corner(t, 2));
  for (const int t : triangles_over_centres(surface, points))
    rasterizer.enter_centres(corner(t, 0), corner(t, 1), corner(t, 2));
  return maps;
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

DepthMaps draw_depth_maps(const Mesh& surface, double grid_mm, double support_angle) {
  return drawn<true>(surface, grid_mm, support_angle);
}

DepthMaps draw_centre_maps(const Mesh& surface, double grid_mm, double support_angle) {
  return drawn<false>(surface, grid_mm, support_angle);
}

DepthMaps draw_sampled_maps(const Mesh& surface, double grid_mm, double support_angle) {
  const DepthMaps fine = draw_centre_maps(surface, grid_mm / 2, support_angle);
  const auto half = [](int cells) { return cells >= 0 ? cells / 2 : (cells - 1) / 2; };
  DepthMaps maps;
  maps.box = fine.box;
  maps.x0 = half(fine.x0);
  maps.y0 = half(fine.y0);
  maps.width = half(fine.x0 + fine.width - 1) - maps.x0 + 1;
  maps.height = half(fine.y0 + fine.height - 1) - maps.y0 + 1;
  allocate(maps);
  for (int row = 0; row < fine.height; ++row)
    for (int column = 0; column < fine.width; ++column) {
      const int x = fine.x0 + column;
      const int y = fine.y0 + row;
      const std::size_t from = at(fine, column, row);
      const std::size_t to = at(maps, half(x) - maps.x0, half(y) - maps.y0);
      maps.low[to] = std::min(maps.low[to], fine.bottom[from]);
      maps.top[to] = std::max(maps.top[to], fine.roof[from]);
      if ((x & 1) != 0 || (y & 1) != 0) continue;
      maps.bottom[to] = fine.bottom[from];
      maps.roof[to] = fine.roof[from];
      maps.hangs[to] = fine.hangs[from];
    }
  return maps;
}

RoofMap draw_roof(const Mesh& surface, double grid_mm) {
  DepthMaps maps = frame_around(surface, grid_mm);
  maps.roof.assign(cells(maps), kNothingBelow);
  const std::vector<CellPoint> points = in_cells(surface.points(), grid_mm, maps);
  Rasterizer rasterizer(maps, grid_mm, 0);
  for (const int t : triangles_over_centres(surface, points)) {
    const auto& [a, b, c] = surface.triangles()[static_cast<std::size_t>(t)];
    rasterizer.enter_roof(points[static_cast<std::size_t>(a)], points[static_cast<std::size_t>(b)],
                          points[static_cast<std::size_t>(c)]);
  }
  return {maps.x0, maps.y0, maps.width, maps.height, maps.box, std::move(maps.roof)};
}

DepthMaps quarter_turned(const DepthMaps& maps, int quarters) {
  DepthMaps turned = maps;
  for (int i = 0; i < quarters; ++i) turned = once_turned(turned);
  return turned;
}

DepthMaps united_maps(const std::vector<const DepthMaps*>& members) {
  DepthMaps all = frame_of(members);
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
