#include "shape/solid/solidify.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/parallel.h"
#include "fixtures/models.h"
#include "shape/read/soup.h"
#include "shape/solid/hollow.h"
#include "shape/solid/tetrahedralize.h"
#include "shape/surface/repair.h"
#include "shape/surface/surface_query.h"

namespace packmerger {
namespace {

using fixtures::scaled_to;

struct Made {
  Mesh model;
  Solidified solid;
  Warnings warnings;
};

Made made(const TriangleSoup& soup, bool hollow_it = true) {
  Made result;
  result.model = repair(soup, result.warnings, Progress());
  result.solid = solidify(result.model, ShapeSettings(), hollow_it, result.warnings, Progress());
  return result;
}

bool warned(const Warnings& warnings, const std::string& code) {
  return std::any_of(warnings.begin(), warnings.end(),
                     [&](const Warning& warning) { return warning.code == code; });
}

int count_components(const TetMesh& mesh) {
  std::vector<char> seen(mesh.tetrahedra.size(), 0);
  int count = 0;
  for (int first = 0; first < mesh.count(); ++first) {
    if (seen[first] != 0) continue;
    ++count;
    std::vector<int> open = {first};
    seen[first] = 1;
    while (!open.empty()) {
      const int t = open.back();
      open.pop_back();
      for (const int next : mesh.neighbours[t])
        if (next >= 0 && seen[next] == 0) {
          seen[next] = 1;
          open.push_back(next);
        }
    }
  }
  return count;
}

TriangleSoup boundary(const TetMesh& mesh, FaceSide side) {
  TriangleSoup soup;
  soup.points = mesh.points;
  for (int t = 0; t < mesh.count(); ++t)
    for (int face = 0; face < 4; ++face)
      if (mesh.sides[t][face] == side) soup.triangles.push_back(face_corners(mesh, t, face));
  return without_unused_points(soup);
}

double furthest(const TriangleView& from, const TriangleView& to) {
  const SurfaceQuery query(to);
  double furthest = 0;
  for (const Vec3& point : from.points) furthest = std::max(furthest, query.distance_mm(point));
  for (const auto& [a, b, c] : from.triangles)
    furthest = std::max(furthest,
                        query.distance_mm((from.points[a] + from.points[b] + from.points[c]) / 3));
  return furthest;
}

void expect_solid(const Made& made, int components = 1) {
  const TetMesh& mesh = made.solid.tets;
  const Shell& shell = made.solid.shell;
  const double limit = ShapeSettings().max_tetrahedron_fraction * shell.volume_mm3;
  ASSERT_GT(mesh.count(), 0);
  EXPECT_LT(mesh.count(), 250000);
  double sum = 0;
  for (int t = 0; t < mesh.count(); ++t) {
    const double volume = mesh.volume_mm3(t);
    ASSERT_GT(volume, 0);
    ASSERT_LE(volume, limit);
    sum += volume;
    for (int face = 0; face < 4; ++face)
      ASSERT_EQ(mesh.neighbours[t][face] < 0, mesh.sides[t][face] != FaceSide::kInterior);
  }
  EXPECT_NEAR(sum, shell.volume_mm3, 1e-3 * shell.volume_mm3);
  EXPECT_EQ(count_components(mesh), components);

  const TriangleSoup outside = boundary(mesh, FaceSide::kOutside);
  EXPECT_TRUE(is_closed_manifold(outside));
  EXPECT_NEAR(signed_volume_mm3(outside), volume_mm3(shell.outer), 1e-6 * volume_mm3(shell.outer));
  const double tolerance = made.solid.resample_tolerance_mm.value_or(0.1);
  EXPECT_LE(furthest(outside, made.model), tolerance);
  if (!made.solid.resample_tolerance_mm) {
    EXPECT_LE(furthest(shell.outer, outside), 1e-9);
    // TetGen keeps the outer surface's own points exactly.
    const auto less = [](const Vec3& a, const Vec3& b) {
      return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
    };
    std::vector<Vec3> points = outside.points;
    std::sort(points.begin(), points.end(), less);
    for (const Vec3& point : shell.outer.points())
      EXPECT_TRUE(std::binary_search(points.begin(), points.end(), point, less));
  }
  EXPECT_EQ(boundary(mesh, FaceSide::kCavity).triangles.empty(), shell.cavities.empty());
}

TEST(Solidify, ProceduralModels) {
  for (const TriangleSoup& soup :
       {fixtures::cube(25), fixtures::sphere(12, 3), fixtures::torus(16, 6, 40, 20),
        fixtures::nested_cubes(30, 10), fixtures::nested_cubes(20, 16), fixtures::thin_plate(30, 4),
        fixtures::blob(36, 3)}) {
    const Made result = made(soup);
    expect_solid(result);
    EXPECT_FALSE(result.solid.resample_tolerance_mm);
  }
}

TEST(Solidify, NotHollowedIsTheWholeModel) {
  const Made result = made(fixtures::cube(40), false);
  expect_solid(result);
  EXPECT_TRUE(result.solid.shell.cavities.empty());
  EXPECT_NEAR(total_volume_mm3(result.solid.tets), 64000, 64);
  EXPECT_TRUE(result.warnings.empty());
}

TEST(Solidify, SeveralBodiesStaySeveral) {
  TriangleSoup second = fixtures::sphere(15, 3);
  for (Vec3& point : second.points) point += Vec3(50, 10, 10);
  expect_solid(made(fixtures::together(fixtures::cube(20), second)), 2);
}

TEST(Solidify, CrossingBodiesAreResampledAndSaySo) {
  TriangleSoup second = fixtures::cube(30);
  for (Vec3& point : second.points) point += Vec3(15, 14, 13);
  const Made result = made(fixtures::together(fixtures::cube(30), second));
  expect_solid(result);
  EXPECT_EQ(result.solid.resample_tolerance_mm, ShapeSettings().resample_tolerance_mm);
  EXPECT_TRUE(warned(result.warnings, "resampled"));
}

TEST(Solidify, SameBytesOnOneAndTwoThreads) {
  const TriangleSoup model = fixtures::blob(36, 3);
  const auto with_threads = [&](std::size_t threads) {
    const ThreadLimit limit(threads);
    return made(model).solid.tets;
  };
  const TetMesh one = with_threads(1);
  const TetMesh two = with_threads(2);
  EXPECT_EQ(one.points, two.points);
  EXPECT_EQ(one.tetrahedra, two.tetrahedra);
  EXPECT_EQ(one.sides, two.sides);
}

TEST(Tetrahedralize, ASurfaceThatCrossesItselfIsAnOrdinaryOutcome) {
  TriangleSoup second = fixtures::sphere(10, 2);
  for (Vec3& point : second.points) point += Vec3(5, 1, 1);
  const Mesh crossing = closed_mesh(fixtures::together(fixtures::sphere(10, 2), second));
  EXPECT_FALSE(tetrahedralize(solid_shell(crossing, ShapeSettings()), ShapeSettings(), Progress()));
}

// A fin over an edge, whose two sides begin nearer to one another than TetGen keeps points apart by
// itself. Cutting bodies where they cross leaves such things.
TriangleSoup with_fin(TriangleSoup soup) {
  const int a = soup.triangles[0][0];
  const int b = soup.triangles[0][1];
  const int c = soup.triangles[0][2];
  const auto other =
      std::find_if(soup.triangles.begin() + 1, soup.triangles.end(), [&](const auto& triangle) {
        return std::count(triangle.begin(), triangle.end(), a) +
                   std::count(triangle.begin(), triangle.end(), b) ==
               2;
      });
  const int d = (*other)[0] + (*other)[1] + (*other)[2] - a - b;
  const Vec3 middle = (soup.points[a] + soup.points[b]) / 2;
  const int before = static_cast<int>(soup.points.size());
  const int behind = before + 1;
  const int tip = before + 2;
  soup.points.push_back(middle + 1e-9 * (soup.points[c] - middle));
  soup.points.push_back(middle + 1e-9 * (soup.points[d] - middle));
  soup.points.push_back(1.1 * middle);
  soup.triangles[0] = {a, before, c};
  *other = {b, behind, d};
  for (const std::array<int, 3> triangle :
       {std::array{before, b, c}, std::array{behind, a, d}, std::array{before, a, tip},
        std::array{b, before, tip}, std::array{behind, b, tip}, std::array{a, behind, tip}})
    soup.triangles.push_back(triangle);
  return soup;
}

TEST(Tetrahedralize, PointsNextToOneAnotherStayApart) {
  const Mesh mesh = closed_mesh(with_fin(fixtures::sphere(20, 2)));
  ASSERT_FALSE(self_intersects(mesh));
  const Shell shell = solid_shell(mesh, ShapeSettings());
  const auto tets = tetrahedralize(shell, ShapeSettings(), Progress());
  ASSERT_TRUE(tets);
  EXPECT_NEAR(total_volume_mm3(*tets), shell.volume_mm3, 1e-6 * shell.volume_mm3);
}

TEST(Tetrahedralize, CanBeInterrupted) {
  const std::atomic<bool> cancelled{true};
  const Shell shell = solid_shell(closed_mesh(fixtures::cube(10)), ShapeSettings());
  try {
    tetrahedralize(shell, ShapeSettings(), Progress({}, &cancelled));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.fault(), Fault::kInterrupted);
  }
}

TEST(SolidifyRealModels, Bunny) {
  PACKMERGER_TEST_MODEL(soup, "bunny");
  for (const double size : {60.0, 138.0}) {
    const Made result = made(scaled_to(soup, size));
    expect_solid(result);
    EXPECT_FALSE(result.solid.resample_tolerance_mm);
    EXPECT_GT(result.solid.tets.count(), 10000);
  }
}

TEST(SolidifyRealModels, Spot) {
  PACKMERGER_TEST_MODEL(soup, "spot.obj");
  expect_solid(made(scaled_to(soup, 100)));
}

TEST(SolidifyRealModels, RockerArm) {
  PACKMERGER_TEST_MODEL(soup, "rocker-arm.obj");
  expect_solid(made(scaled_to(soup, 100)));
}

TEST(SolidifyRealModels, CowIsResampled) {
  PACKMERGER_TEST_MODEL(soup, "cow.obj");
  const Made result = made(scaled_to(soup, 100));
  expect_solid(result);
  EXPECT_TRUE(warned(result.warnings, "resampled"));
}

TEST(SolidifyRealModels, StanfordBunnyHasItsHolesFilled) {
  PACKMERGER_TEST_MODEL(soup, "stanford-bunny.obj");
  const Made result = made(scaled_to(soup, 100));
  expect_solid(result);
  EXPECT_TRUE(warned(result.warnings, "repaired"));
}

// Open, non-manifold, with eyes that cross the head.
TEST(SolidifyRealModels, SuzanneIsMadeSolidOrRefusedClearly) {
  PACKMERGER_TEST_MODEL(soup, "suzanne.obj");
  try {
    const Made result = made(scaled_to(soup, 100));
    expect_solid(result, count_components(result.solid.tets));
    EXPECT_TRUE(warned(result.warnings, "repaired"));
  } catch (const Error& error) {
    EXPECT_EQ(error.fault(), Fault::kBadInput);
    EXPECT_FALSE(error.hint().empty());
  }
}

}  // namespace
}  // namespace packmerger
