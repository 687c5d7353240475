// The packer's depth maps, against exact clipping, against columns and against OSMesa.
#include "pack/maps/depth_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include <rapidcheck/gtest.h>

#include "base/random.h"
#include "fixtures/z_buffer.h"
#include "model/sentinel_heights.h"
#include "pack/maps/columns.h"
#include "pack/maps/rotations.h"
#include "unit/pack/shapes.h"

namespace packmerger {
namespace {

std::size_t at(const DepthMaps& maps, int column, int row) {
  return static_cast<std::size_t>(row * maps.width + column);
}

// Large facets and small ones, thin walls, cavities' insides; any way up or standing on the axes.
Mesh any_shape(Random& random) {
  Mesh mesh;
  switch (random.below(5)) {
    case 0:
      mesh = shapes::l_shape(20, 3, 11);
      break;
    case 1:
      mesh = shapes::bowl(13, 1.5, 12);
      break;
    case 2:
      mesh = shapes::sphere_patch(15, 2, static_cast<int>(random.below(6)), 12);
      break;
    case 3:
      mesh = shapes::tetrahedron(17);
      break;
    default:
      mesh = shapes::cup(7, 9, 1, 40);
  }
  const std::size_t way = random.below(4);
  if (way == 0) return mesh;
  if (way == 1) return shapes::turned(mesh, turn_about_z(random.unit()));
  return shapes::turned(mesh, shapes::any_rotation(random));
}

// ---- bounds --------------------------------------------------------------------------------

// The part of a convex polygon where sign · p[axis] <= sign · limit.
std::vector<Vec3> clipped(const std::vector<Vec3>& polygon, int axis, double sign, double limit) {
  std::vector<Vec3> result;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3& p = polygon[i];
    const Vec3& q = polygon[(i + 1) % polygon.size()];
    const double from = sign * (p[axis] - limit);
    const double to = sign * (q[axis] - limit);
    if (from <= 0) result.push_back(p);
    if ((from < 0 && to > 0) || (from > 0 && to < 0))
      result.push_back(p + (q - p) * (from / (from - to)));
  }
  return result;
}

struct Heights {
  std::vector<double> low;
  std::vector<double> top;
};

// The least and greatest height in every cell, each grown by `room` on all sides.
Heights clipped_heights(const TriangleView& surface, const DepthMaps& maps, double grid,
                        double room) {
  Heights heights{std::vector<double>(maps.low.size(), kNothingAbove),
                  std::vector<double>(maps.low.size(), kNothingBelow)};
  for (const auto& [a, b, c] : surface.triangles)
    for (int row = 0; row < maps.height; ++row) {
      std::vector<Vec3> strip{surface.points[static_cast<std::size_t>(a)],
                              surface.points[static_cast<std::size_t>(b)],
                              surface.points[static_cast<std::size_t>(c)]};
      strip = clipped(strip, 1, -1, (maps.y0 + row) * grid - room);
      strip = clipped(strip, 1, 1, (maps.y0 + row + 1) * grid + room);
      if (strip.empty()) continue;
      for (int column = 0; column < maps.width; ++column) {
        std::vector<Vec3> piece = clipped(strip, 0, -1, (maps.x0 + column) * grid - room);
        piece = clipped(piece, 0, 1, (maps.x0 + column + 1) * grid + room);
        double& low = heights.low[at(maps, column, row)];
        double& top = heights.top[at(maps, column, row)];
        for (const Vec3& p : piece) {
          low = std::min(low, p.z());
          top = std::max(top, p.z());
        }
      }
    }
  return heights;
}

RC_GTEST_PROP(DepthMaps, BoundsAreThoseOfTheTrianglesClippedToTheCells, (std::uint64_t seed)) {
  constexpr double kRoom_mm = 1e-6;
  Random random(seed);
  const double grid = random.below(3) == 0 ? 1 : 0.7 + 2 * random.unit();
  const Mesh surface = any_shape(random);
  const DepthMaps maps = draw_depth_maps(surface, grid, 0);
  const Heights least = clipped_heights(surface, maps, grid, -kRoom_mm);
  const Heights most = clipped_heights(surface, maps, grid, kRoom_mm);
  for (std::size_t i = 0; i < maps.low.size(); ++i) {
    RC_ASSERT(maps.low[i] <= least.low[i] + 1e-5);
    RC_ASSERT(maps.low[i] >= most.low[i] - 1e-5);
    RC_ASSERT(maps.top[i] >= least.top[i] - 1e-5);
    RC_ASSERT(maps.top[i] <= most.top[i] + 1e-5);
  }
}

// Nothing of the surface lies in a cell without bounds or outside of them.
void expect_bounds(const DepthMaps& maps, const Mesh& mesh, double grid, Random& random) {
  for (std::size_t t = 0; t < mesh.n_triangles(); ++t) {
    const auto corner = mesh.corners(t);
    const Vec3 normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
    for (int i = 0; i < 40; ++i) {
      double u = random.unit();
      double v = random.unit();
      if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      const Vec3 p = corner[0] + u * (corner[1] - corner[0]) + v * (corner[2] - corner[0]);
      const int x = static_cast<int>(std::floor(p.x() / grid)) - maps.x0;
      const int y = static_cast<int>(std::floor(p.y() / grid)) - maps.y0;
      RC_ASSERT(x >= 0 && x < maps.width && y >= 0 && y < maps.height);
      // A cell may miss what reaches no further into it than its tolerance.
      const double allowed = 1e-5 + 2e-7 * grid / std::max(std::abs(normal.z()), 1e-3);
      RC_ASSERT(maps.low[at(maps, x, y)] <= p.z() + allowed);
      RC_ASSERT(maps.top[at(maps, x, y)] >= p.z() - allowed);
    }
  }
}

RC_GTEST_PROP(DepthMaps, BoundTheSurfaceInEveryCell, (std::uint64_t seed)) {
  Random random(seed);
  const double grid = 0.5 + random.unit();
  const Mesh mesh = shapes::turned(any_shape(random), shapes::any_rotation(random));
  const DepthMaps maps = draw_depth_maps(mesh, grid, 0);
  expect_bounds(maps, mesh, grid, random);
  // Turned by quarters, they bound the turned surface.
  for (int quarters = 1; quarters < 4; ++quarters)
    expect_bounds(quarter_turned(maps, quarters),
                  shapes::turned(mesh, turn_about_z(quarters * std::numbers::pi / 2)), grid,
                  random);
}

TEST(DepthMaps, ASlopeHasItsCornersBoundsAndItsCentresHeight) {
  const DepthMaps maps = draw_depth_maps(shapes::tetrahedron(20), 1, 0);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) {
      EXPECT_NEAR(maps.top[at(maps, x, y)], 20 - x - y, 1e-5);
      EXPECT_NEAR(maps.roof[at(maps, x, y)], 19 - x - y, 1e-5);
      EXPECT_EQ(maps.low[at(maps, x, y)], 0);
    }
}

TEST(DepthMaps, ABoxOnTheGridKeepsToItsCells) {
  for (const double grid : {1.0, 0.1, 1.0 / 3}) {
    const DepthMaps maps =
        draw_depth_maps(shapes::box(grid * Vec3(5, 3, 2), grid * Vec3(-2, 1, 4)), grid, 0);
    EXPECT_EQ(maps.x0, -2);
    EXPECT_EQ(maps.y0, 1);
    ASSERT_EQ(maps.width, 5);
    ASSERT_EQ(maps.height, 3);
    for (std::size_t i = 0; i < maps.low.size(); ++i) {
      EXPECT_EQ(maps.low[i], static_cast<float>(4 * grid));
      EXPECT_EQ(maps.top[i], static_cast<float>(6 * grid));
      EXPECT_FLOAT_EQ(maps.bottom[i], static_cast<float>(4 * grid));
      EXPECT_FLOAT_EQ(maps.roof[i], static_cast<float>(6 * grid));
      EXPECT_EQ(maps.hangs[i], 1);
    }
  }
}

TEST(DepthMaps, AStepOnTheGridHasNoRoomBesideItsWall) {
  // The wall stands in the line between columns 2 and 3 of the map and belongs to neither.
  const Mesh step = shapes::l_shape(9, 3, 4);
  const DepthMaps maps = draw_depth_maps(step, 1, 0);
  ASSERT_EQ(maps.width, 9);
  ASSERT_EQ(maps.height, 4);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 9; ++x) {
      EXPECT_EQ(maps.low[at(maps, x, y)], 0);
      EXPECT_EQ(maps.top[at(maps, x, y)], x < 3 ? 9 : 3) << x;
      EXPECT_EQ(maps.roof[at(maps, x, y)], x < 3 ? 9 : 3) << x;
    }
}

TEST(DepthMaps, AWallThroughTheMiddleOfCellsCountsInFull) {
  // Both walls lie within one row of cells and neither passes through a centre.
  const DepthMaps maps = draw_depth_maps(shapes::box(Vec3(4, 0.2, 7), Vec3(0.5, 1.6, 2)), 1, 0);
  ASSERT_EQ(maps.height, 1);
  ASSERT_EQ(maps.width, 5);
  for (std::size_t i = 0; i < maps.low.size(); ++i) {
    EXPECT_EQ(maps.low[i], 2);
    EXPECT_EQ(maps.top[i], 9);
    EXPECT_EQ(maps.bottom[i], kNothingAbove);
    EXPECT_EQ(maps.roof[i], kNothingBelow);
    EXPECT_EQ(maps.hangs[i], 0);
  }
}

TEST(DepthMaps, CentresOnAnEdgeBelongToOneSide) {
  // A box of 3 × 3 cells whose sides all pass through centres covers nine of them.
  const DepthMaps maps = draw_depth_maps(shapes::box(Vec3(3, 3, 3), Vec3(0.5, 0.5, 0)), 1, 0);
  EXPECT_EQ(std::count(maps.bottom.begin(), maps.bottom.end(), 0.0F), 9);
  EXPECT_EQ(std::count(maps.roof.begin(), maps.roof.end(), 3.0F), 9);
}

TEST(DepthMaps, UnitedMapsAreTheMapsOfTheUnion) {
  const Mesh a = shapes::box(Vec3(4, 4, 4), Vec3(0.3, 0.3, 0));
  const Mesh b = shapes::box(Vec3(4, 4, 4), Vec3(2.3, 6.3, 8));
  const DepthMaps map_a = draw_depth_maps(a, 1, 0);
  const DepthMaps map_b = draw_depth_maps(b, 1, 0);
  const DepthMaps both = united_maps({&map_a, &map_b});
  const DepthMaps drawn = draw_depth_maps(united(std::vector<const Mesh*>{&a, &b}), 1, 0);
  EXPECT_EQ(both.low, drawn.low);
  EXPECT_EQ(both.top, drawn.top);
  EXPECT_EQ(both.bottom, drawn.bottom);
  EXPECT_EQ(both.roof, drawn.roof);
  EXPECT_EQ(both.hangs, drawn.hangs);
}

// ---- centres -------------------------------------------------------------------------------

RC_GTEST_PROP(DepthMaps, WhatHangsIsTheSupportOfTheColumns, (std::uint64_t seed)) {
  Random random(seed);
  const double grid = 0.5 + random.unit();
  const double angle = radians(60 * random.unit());
  const Mesh surface = shapes::turned(any_shape(random), shapes::any_rotation(random));
  const DepthMaps maps = draw_depth_maps(surface, grid, angle);
  const double plate = maps.box.min().z();
  double support = 0;
  for (std::size_t i = 0; i < maps.bottom.size(); ++i)
    if (maps.hangs[i] != 0) support += (maps.bottom[i] - plate) * grid * grid;
  const double expected = column_support({surface}, grid, angle, plate).below;
  RC_ASSERT(std::abs(support - expected) <= 1e-5 * expected + 1e-4);
}

RC_GTEST_PROP(DepthMaps, CentresAreTheSameAlone, (std::uint64_t seed)) {
  Random random(seed);
  const double grid = 0.5 + random.unit();
  const Mesh surface = shapes::turned(any_shape(random), shapes::any_rotation(random));
  const DepthMaps whole = draw_depth_maps(surface, grid, 0.5);
  const DepthMaps alone = draw_centre_maps(surface, grid, 0.5);
  RC_ASSERT(alone.x0 == whole.x0 && alone.y0 == whole.y0);
  RC_ASSERT(alone.bottom == whole.bottom);
  RC_ASSERT(alone.roof == whole.roof);
  RC_ASSERT(alone.hangs == whole.hangs);
}

RC_GTEST_PROP(DepthMaps, RoofsAreTheSameAlone, (std::uint64_t seed)) {
  Random random(seed);
  const double grid = 0.5 + random.unit();
  const Mesh surface = shapes::turned(any_shape(random), shapes::any_rotation(random));
  const DepthMaps whole = draw_centre_maps(surface, grid, 0);
  const RoofMap alone = draw_roof(surface, grid);
  RC_ASSERT(alone.x0 == whole.x0 && alone.y0 == whole.y0 && alone.width == whole.width);
  RC_ASSERT(alone.roof == whole.roof);
}

// OSMesa's heights at one ray and at its eight neighbours: what its sampling, which is exact to a
// fraction of a step sideways, leaves open.
struct Neighbourhood {
  float low = kNothingAbove;
  float high = kNothingBelow;
  float room() const { return 1e-3F + (high - low) / 32; }
};

Neighbourhood round_ray(const DepthMap& map, int i, int j) {
  Neighbourhood found;
  for (int y = std::max(0, j - 1); y <= std::min(map.height - 1, j + 1); ++y)
    for (int x = std::max(0, i - 1); x <= std::min(map.width - 1, i + 1); ++x) {
      const float height = map.heights[static_cast<std::size_t>(y * map.width + x)];
      found.low = std::min(found.low, height);
      found.high = std::max(found.high, height);
    }
  return found;
}

constexpr int kRays = 8;  // a cell, on each side

// The extent of the cells that a ray touches. A ray between cells may be sampled in any of them:
// a wall that passes within that fraction of a step belongs to one of them alone.
Neighbourhood cells_touching(const DepthMaps& maps, int i, int j) {
  Neighbourhood found;
  for (int row = std::max(0, j - 1) / kRays; row <= std::min(j / kRays, maps.height - 1); ++row)
    for (int column = std::max(0, i - 1) / kRays; column <= std::min(i / kRays, maps.width - 1);
         ++column) {
      found.low = std::min(found.low, maps.low[at(maps, column, row)]);
      found.high = std::max(found.high, maps.top[at(maps, column, row)]);
    }
  return found;
}

RC_GTEST_PROP(DepthMaps, AgreeWithTheZBufferAtEveryPixel, (std::uint64_t seed)) {
  Random random(seed);
  const double grid = 0.5 + random.unit();
  const Mesh surface = shapes::turned(any_shape(random), shapes::any_rotation(random));
  const DepthMaps maps = draw_depth_maps(surface, grid, 0);
  const DepthTriangles triangles = shapes::depth_triangles(surface);
  const RayLattice rays{maps.x0 * grid, maps.y0 * grid, grid / kRays, kRays * maps.width + 1,
                        kRays * maps.height + 1};
  DepthRenderer renderer;
  const DepthMap below = renderer.from_below(triangles, rays);
  const DepthMap above = renderer.from_above(triangles, rays);
  std::size_t compared = 0;
  for (int j = 0; j < rays.height; ++j)
    for (int i = 0; i < rays.width; ++i) {
      const std::size_t ray = static_cast<std::size_t>(j * rays.width + i);
      const Neighbourhood bottom = round_ray(below, i, j);
      const Neighbourhood roof = round_ray(above, i, j);
      if (!std::isfinite(bottom.high)) continue;  // at the silhouette
      const Neighbourhood cells = cells_touching(maps, i, j);
      RC_ASSERT(cells.low <= below.heights[ray] + bottom.room());
      RC_ASSERT(cells.high >= above.heights[ray] - roof.room());
      ++compared;
    }
  for (int row = 0; row < maps.height; ++row)
    for (int column = 0; column < maps.width; ++column) {
      const std::size_t cell = at(maps, column, row);
      const int i = kRays * column + kRays / 2;
      const int j = kRays * row + kRays / 2;
      const Neighbourhood bottom = round_ray(below, i, j);
      const Neighbourhood roof = round_ray(above, i, j);
      if (bottom.low == kNothingAbove) RC_ASSERT(maps.bottom[cell] == kNothingAbove);
      if (!std::isfinite(bottom.high)) continue;
      RC_ASSERT(maps.bottom[cell] >= bottom.low - bottom.room());
      RC_ASSERT(maps.bottom[cell] <= bottom.high + bottom.room());
      RC_ASSERT(maps.roof[cell] >= roof.low - roof.room());
      RC_ASSERT(maps.roof[cell] <= roof.high + roof.room());
    }
  RC_ASSERT(compared > 100U);
}

}  // namespace
}  // namespace packmerger
