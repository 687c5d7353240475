// The whole division of real models, 100 mm large: every promise of section 2 to 5 of the paper.
#include <gtest/gtest.h>

#include "base/parallel.h"
#include "fixtures/models.h"
#include "part_checks.h"
#include "shape/cut/cut_plans.h"
#include "shape/divide/manifold_parts.h"
#include "shape/divide/premerge.h"
#include "shape/divide/segment.h"
#include "shape/divide/smooth_cuts.h"
#include "shape/solid/solidify.h"
#include "shape/surface/repair.h"
#include "shape/surface/surface_query.h"

namespace packmerger {
namespace {

struct Division {
  TetMesh mesh;
  Segments segments;
  CutRoughness roughness;
  Warnings warnings;
};

Division divided(const TetMesh& whole, std::uint64_t seed) {
  const ShapeSettings settings;
  Division result{whole, {}, {}, {}};
  const BuildVolume build{Vec3(294, 192, 148.6), radians(30)};
  const Segments clusters = segment(result.mesh, settings, seed, Progress());
  checks::expect_proper_parts(result.mesh, clusters);
  result.segments = premerge(result.mesh, clusters, settings, build, result.warnings, Progress());
  result.roughness = smooth_cuts(result.mesh, result.segments, settings, Progress());
  return result;
}

TriangleSoup boundary_soup(const TetMesh& mesh, FaceSide side) {
  TriangleSoup soup{mesh.points, {}};
  for (int t = 0; t < mesh.count(); ++t)
    for (int f = 0; f < 4; ++f)
      if (mesh.sides[t][f] == side) soup.triangles.push_back(face_corners(mesh, t, f));
  return soup;
}

// Distance from samples of one surface (corners, middles of edges and faces) to another.
double furthest_mm(const TriangleSoup& from, const TriangleSoup& to) {
  const SurfaceQuery query(to);
  std::vector<double> of_triangle(from.triangles.size(), 0);
  parallel_for(of_triangle.size(), [&](std::size_t i) {
    const auto& [ia, ib, ic] = from.triangles[i];
    const Vec3 &a = from.points[ia], &b = from.points[ib], &c = from.points[ic];
    for (const Vec3& p :
         {a, b, c, Vec3((a + b) / 2), Vec3((b + c) / 2), Vec3((c + a) / 2), Vec3((a + b + c) / 3),
          Vec3((4 * a + b + c) / 6), Vec3((a + 4 * b + c) / 6), Vec3((a + b + 4 * c) / 6)})
      of_triangle[i] = std::max(of_triangle[i], query.distance_mm(p));
  });
  return of_triangle.empty() ? 0 : *std::max_element(of_triangle.begin(), of_triangle.end());
}

void divide_and_check(const TriangleSoup& soup) {
  Warnings warnings;
  const Mesh model = repair(fixtures::scaled_to(soup, 100), warnings, Progress());
  const TetMesh whole = solidify(model, ShapeSettings(), true, warnings, Progress()).tets;
  const double volume = total_volume_mm3(whole);
  Division division = divided(whole, 1);
  checks::expect_sound_mesh(division.mesh, volume);
  checks::expect_proper_parts(division.mesh, division.segments);
  EXPECT_GT(division.segments.count, 1);
  EXPECT_LT(division.roughness.after_rad, division.roughness.before_rad / 2);
  ::testing::Test::RecordProperty("roughness_before",
                                  std::to_string(division.roughness.before_rad));
  ::testing::Test::RecordProperty("roughness_after", std::to_string(division.roughness.after_rad));

  for (const FaceSide side : {FaceSide::kOutside, FaceSide::kCavity}) {
    const TriangleSoup was = boundary_soup(whole, side);
    const TriangleSoup is = boundary_soup(division.mesh, side);
    EXPECT_LT(furthest_mm(is, was), 0.1);
    EXPECT_LT(furthest_mm(was, is), 0.1);
  }

  // what the packer does afterwards
  Random random(5);
  for (const int left : {8, 4, 2}) {
    if (left >= division.segments.count) continue;
    TetMesh mesh = division.mesh;
    Segments merged = checks::randomly_merged(mesh, division.segments, left, random);
    make_manifold(mesh, merged, Progress());
    checks::expect_proper_parts(mesh, merged);
  }
}

// Divided by planes: parts are proper and as planned, and the surface is not moved.
void cut_and_check(const TriangleSoup& soup) {
  Warnings warnings;
  const Mesh model = repair(fixtures::scaled_to(soup, 100), warnings, Progress());
  const TetMesh whole = solidify(model, ShapeSettings(), true, warnings, Progress()).tets;
  const double volume = total_volume_mm3(whole);
  const ShapeSettings settings;
  const BuildVolume build{Vec3(294, 192, 148.6), radians(30)};
  CutSearch search;
  search.part_price_mm3 = 0.02 * volume;
  search.effort = 100;
  search.samples = 8000;
  const auto plans = cut_plans(whole, settings, build, search, 1, Progress());
  ASSERT_FALSE(plans.empty());
  for (const CutPlan& plan : plans) {
    TetMesh mesh = whole;
    const Segments cut = cut_as_planned(mesh, plan, Progress());
    checks::expect_sound_mesh(mesh, volume);
    checks::expect_proper_parts(mesh, cut);
    EXPECT_NEAR(cut.count, plan.parts, 1);
    const Segments merged = premerge(mesh, cut, settings, build, warnings, Progress());
    checks::expect_proper_parts(mesh, merged);
    EXPECT_GE(merged.count, plan.parts - 2);
    EXPECT_LE(merged.count, settings.parts);
    for (const FaceSide side : {FaceSide::kOutside, FaceSide::kCavity}) {
      const TriangleSoup was = boundary_soup(whole, side);
      const TriangleSoup is = boundary_soup(mesh, side);
      EXPECT_LT(furthest_mm(is, was), 0.1);
      EXPECT_LT(furthest_mm(was, is), 0.1);
    }
  }
}

TEST(RealModels, TorusByPlanes) { cut_and_check(fixtures::torus(35, 15, 64, 32)); }

TEST(RealModels, BunnyByPlanes) {
  PACKMERGER_TEST_MODEL(soup, "stanford-bunny.obj");
  cut_and_check(soup);
}

TEST(RealModels, Bunny) {
  PACKMERGER_TEST_MODEL(soup, "stanford-bunny.obj");
  divide_and_check(soup);
}

TEST(RealModels, Spot) {
  PACKMERGER_TEST_MODEL(soup, "spot.obj");
  divide_and_check(soup);
}

TEST(RealModels, RockerArm) {
  PACKMERGER_TEST_MODEL(soup, "rocker-arm.obj");
  divide_and_check(soup);
}

TEST(RealModels, BlobIsTheSameOnOneThreadAndTwo) {
  Warnings warnings;
  const Mesh model = repair(fixtures::blob(80, 4), warnings, Progress());
  const TetMesh whole = solidify(model, ShapeSettings(), true, warnings, Progress()).tets;
  std::vector<Division> divisions;
  for (const std::size_t threads : {1, 2}) {
    const ThreadLimit limit(threads);
    divisions.push_back(divided(whole, 11));
  }
  EXPECT_EQ(divisions[0].mesh.points, divisions[1].mesh.points);
  EXPECT_EQ(divisions[0].mesh.tetrahedra, divisions[1].mesh.tetrahedra);
  EXPECT_EQ(divisions[0].segments.of_tetrahedron, divisions[1].segments.of_tetrahedron);
}

}  // namespace
}  // namespace packmerger
