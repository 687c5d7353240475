// Smoothing: rougher cuts become smooth, and the model keeps its shape.
#include "shape/divide/smooth_cuts.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include "fixtures/tet_models.h"
#include "part_checks.h"
#include "shape/divide/manifold_parts.h"
#include "shape/divide/pinch_test.h"
#include "shape/divide/segment.h"

namespace packmerger {
namespace {

std::array<int, 2> coordinates_on_a_plane(const Vec3& point, double half) {
  std::array<int, 2> count{};
  for (int axis = 0; axis < 3; ++axis) {
    count[0] += std::abs(std::abs(point[axis]) - half) < 1e-9 ? 1 : 0;
    count[1] += std::abs(point[axis]) > half + 1e-9 ? 1 : 0;
  }
  return count;
}

TEST(SmoothCuts, KeepsACubesFacesEdgesAndCorners) {
  TetMesh mesh = fixtures::cube_shell(16, 2, 80);
  Random random(2);
  fixtures::jitter(mesh, 0.1, random);
  const TetMesh before = mesh;
  const double volume = total_volume_mm3(mesh);
  ShapeSettings settings;
  settings.clusters = 20;
  Segments segments = segment(mesh, settings, 1, Progress());
  const std::size_t points = mesh.points.size();
  const CutRoughness roughness = smooth_cuts(mesh, segments, settings, Progress());
  EXPECT_EQ(mesh.points.size(), points);
  EXPECT_LT(roughness.after_rad, roughness.before_rad / 2);
  EXPECT_DOUBLE_EQ(roughness.after_rad, cut_roughness(mesh, segments));
  checks::expect_sound_mesh(mesh, volume);
  checks::expect_proper_parts(mesh, segments);
  EXPECT_NEAR(total_volume_mm3(mesh), volume, 1e-6 * volume);
  int moved = 0;
  for (std::size_t i = 0; i < before.points.size(); ++i) {
    moved += before.points[i] != mesh.points[i] ? 1 : 0;
    // as many planes of the outer cube hold the point as before, and none is overstepped
    ASSERT_EQ(coordinates_on_a_plane(before.points[i], 40),
              coordinates_on_a_plane(mesh.points[i], 40));
    if (coordinates_on_a_plane(before.points[i], 40)[0] == 3) {
      ASSERT_EQ(before.points[i], mesh.points[i]);
    }
  }
  EXPECT_GT(moved, 100);
}

TEST(SmoothCuts, MovesOnlyPointsOnCuts) {
  TetMesh mesh = fixtures::sphere_shell(4, 2, 100, 3);
  ShapeSettings settings;
  settings.clusters = 12;
  Segments segments = segment(mesh, settings, 1, Progress());
  const std::vector<Vec3> before = mesh.points;
  smooth_cuts(mesh, segments, settings, Progress());
  const Stars stars(mesh);
  for (std::size_t i = 0; i < before.size(); ++i) {
    const auto star = stars.of(static_cast<int>(i));
    const bool on_cut = std::any_of(star.begin(), star.end(), [&](int t) {
      return segments.of_tetrahedron[t] != segments.of_tetrahedron[star.front()];
    });
    if (!on_cut) {
      ASSERT_EQ(before[i], mesh.points[i]);
    }
  }
}

TEST(SmoothCuts, KeepsASphereRoundWithinATenth) {
  TetMesh mesh = fixtures::sphere_shell(5, 2, 100, 3);
  Random random(2);
  fixtures::jitter(mesh, 0.1, random);
  const double volume = total_volume_mm3(mesh);
  ShapeSettings settings;
  settings.clusters = 12;
  Segments segments = segment(mesh, settings, 1, Progress());
  const CutRoughness roughness = smooth_cuts(mesh, segments, settings, Progress());
  EXPECT_LT(roughness.after_rad, roughness.before_rad / 2);
  checks::expect_sound_mesh(mesh, volume);
  checks::expect_proper_parts(mesh, segments);
  for (int t = 0; t < mesh.count(); ++t)
    for (int f = 0; f < 4; ++f) {
      if (mesh.sides[t][f] != FaceSide::kOutside) continue;
      const auto [a, b, c] = face_corners(mesh, t, f);
      // facets of this ball lie up to 0.02 mm inside it
      for (const Vec3& p : {mesh.points[a], Vec3((mesh.points[a] + mesh.points[b]) / 2),
                            Vec3((mesh.points[a] + mesh.points[b] + mesh.points[c]) / 3)}) {
        ASSERT_LE(p.norm(), 50 + 1e-9);
        ASSERT_GE(p.norm(), 50 - 0.12);
      }
    }
}

// Seen from its side a fin is flat, yet its tip may not go: a cavity has no sharp edges to follow.
TEST(SmoothCuts, KeepsTheTipOfAThinFin) {
  TetMesh mesh;
  mesh.points = {{0, -1, 0}, {0, 0, 0}, {0, 1, 0}, {0, 0, 0.01}, {2, 0, 0}};
  mesh.tetrahedra = {{0, 4, 1, 3}, {1, 4, 2, 3}};
  for (const Vec3& far : {Vec3(50, 0, 0), Vec3(60, 0, 0), Vec3(50, 10, 0), Vec3(50, 0, 10)})
    mesh.points.push_back(far);
  mesh.tetrahedra.push_back({5, 6, 7, 8});
  for (int t = 0; t < mesh.count(); ++t) ASSERT_GT(mesh.volume_mm3(t), 0) << t;
  mesh.sides.assign(mesh.tetrahedra.size(),
                    {FaceSide::kCavity, FaceSide::kCavity, FaceSide::kCavity, FaceSide::kCavity});
  link_neighbours(mesh);
  Segments segments{{0, 1, 2}, 3};
  smooth_cuts(mesh, segments, ShapeSettings(), Progress());
  ASSERT_EQ(segments.of_tetrahedron, (std::vector<int>{0, 1, 2}));
  EXPECT_NEAR(mesh.points[4].x(), 2, 0.1);
}

TEST(SmoothCuts, HasNothingToDoWithoutCuts) {
  TetMesh mesh = fixtures::cube_shell(6, 1, 60);
  const auto before = mesh.points;
  Segments one{std::vector<int>(mesh.tetrahedra.size(), 0), 1};
  const CutRoughness roughness = smooth_cuts(mesh, one, ShapeSettings(), Progress());
  EXPECT_EQ(roughness.before_rad, 0);
  EXPECT_EQ(roughness.after_rad, 0);
  EXPECT_EQ(mesh.points, before);
}

RC_GTEST_PROP(SmoothCuts, InvertsNothingAndKeepsPartsProper, (std::uint64_t seed)) {
  Random random(seed);
  TetMesh mesh = random.below(2) == 0 ? fixtures::cube_shell(6, 1 + random.below(2), 30)
                                      : fixtures::sphere_shell(2, 3, 40, 4);
  fixtures::jitter(mesh, 0.15, random);
  const double volume = total_volume_mm3(mesh);
  ShapeSettings settings;
  settings.clusters = 3 + static_cast<int>(random.below(30));
  settings.smooth_rounds = 3;
  Segments segments = segment(mesh, settings, seed, Progress());
  segments = checks::randomly_merged(mesh, segments, 2 + static_cast<int>(random.below(8)), random);
  make_manifold(mesh, segments, Progress(), kFreeReach);
  const auto edges = adjacency(mesh, segments);
  smooth_cuts(mesh, segments, settings, Progress());
  checks::expect_sound_mesh(mesh, volume);
  checks::expect_proper_parts(mesh, segments);
  RC_ASSERT(adjacency(mesh, segments).size() <= edges.size());
}

}  // namespace
}  // namespace packmerger
