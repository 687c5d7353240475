// Segmentation and manifold parts on procedural meshes.
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <atomic>

#include "base/parallel.h"
#include "fixtures/tet_models.h"
#include "part_checks.h"
#include "shape/divide/manifold_parts.h"
#include "shape/divide/pinch_test.h"
#include "shape/divide/segment.h"

namespace packmerger {
namespace {

// Every tetrahedron joins a random neighbour's segment: connected, and pinched nearly everywhere.
Segments ragged(const TetMesh& mesh, int count, Random& random) {
  Segments segments{std::vector<int>(mesh.tetrahedra.size(), -1), count};
  std::vector<int> front;
  for (int label = 0; label < count; ++label) {
    int seed = static_cast<int>(random.below(mesh.tetrahedra.size()));
    while (segments.of_tetrahedron[seed] >= 0) seed = (seed + 1) % mesh.count();
    segments.of_tetrahedron[seed] = label;
    front.push_back(seed);
  }
  while (!front.empty()) {
    const std::size_t pick = random.below(front.size());
    const int t = front[pick];
    std::vector<int> open;
    for (const int across : mesh.neighbours[t])
      if (across >= 0 && segments.of_tetrahedron[across] < 0) open.push_back(across);
    if (open.empty()) {
      front[pick] = front.back();
      front.pop_back();
      continue;
    }
    const int taken = open[random.below(open.size())];
    segments.of_tetrahedron[taken] = segments.of_tetrahedron[t];
    front.push_back(taken);
  }
  return segments;
}

TetMesh any_model(Random& random) {
  TetMesh mesh = random.below(2) == 0 ? fixtures::cube_shell(6, 1 + random.below(2), 30)
                                      : fixtures::solid_box({5, 4, 3}, 4);
  fixtures::jitter(mesh, 0.1, random);
  return mesh;
}

TEST(Fixtures, AreSound) {
  checks::expect_sound_mesh(fixtures::cube_shell(6, 1, 60), 216000 - 64000);
  const double ball = std::numbers::pi / 6 * 60 * 60 * 60;
  checks::expect_sound_mesh(fixtures::sphere_shell(5, 2, 60, 3), ball * (1 - 0.9 * 0.9 * 0.9));
}

TEST(ManifoldParts, FreesACheckerboard) {
  // two colours can only touch along edges and in points
  TetMesh mesh = fixtures::solid_box({2, 2, 2}, 10);
  Segments segments{{}, 2};
  for (int t = 0; t < mesh.count(); ++t) {
    const Vec3 c = mesh.centroid(t) / 10;
    const int parity = static_cast<int>(c.x()) + static_cast<int>(c.y()) + static_cast<int>(c.z());
    segments.of_tetrahedron.push_back(parity % 2);
  }
  EXPECT_FALSE(is_manifold(mesh, segments));
  const ManifoldChange change = make_manifold(mesh, segments, Progress());
  EXPECT_GT(change.split, 0);
  EXPECT_EQ(change.reassigned, 0);  // whole tetrahedra are larger than the reach
  EXPECT_TRUE(is_manifold(mesh, segments));
  checks::expect_sound_mesh(mesh, 8000);
}

TEST(ManifoldParts, LeavesCleanPartsAlone) {
  TetMesh mesh = fixtures::solid_box({4, 2, 2}, 5);
  Segments segments{{}, 2};
  for (int t = 0; t < mesh.count(); ++t)
    segments.of_tetrahedron.push_back(mesh.centroid(t).x() < 10 ? 0 : 1);
  const auto tetrahedra = mesh.tetrahedra;
  const ManifoldChange change = make_manifold(mesh, segments, Progress(), kFreeReach);
  EXPECT_EQ(change.split, 0);
  EXPECT_EQ(change.reassigned, 0);
  EXPECT_EQ(mesh.tetrahedra, tetrahedra);
}

RC_GTEST_PROP(ManifoldParts, AnyConnectedDivisionBecomesManifold,
              (std::uint64_t seed, bool placed)) {
  Random random(seed);
  TetMesh mesh = any_model(random);
  const TetMesh before = mesh;
  const double volume = total_volume_mm3(mesh);
  Segments segments = ragged(mesh, 2 + static_cast<int>(random.below(30)), random);
  make_manifold(mesh, segments, Progress(), placed ? kPlacedReach_mm : kFreeReach);
  checks::expect_sound_mesh(mesh, volume);
  checks::expect_proper_parts(mesh, segments);
  RC_ASSERT(std::equal(before.points.begin(), before.points.end(), mesh.points.begin()));
}

RC_GTEST_PROP(ManifoldParts, MergedNeighboursBecomeManifoldInPlace, (std::uint64_t seed)) {
  Random random(seed);
  TetMesh mesh = any_model(random);
  const double volume = total_volume_mm3(mesh);
  ShapeSettings settings;
  settings.clusters = 30;
  Segments segments = segment(mesh, settings, seed, Progress());
  segments = checks::randomly_merged(mesh, segments, 2 + static_cast<int>(random.below(6)), random);
  const TetMesh before = mesh;
  const Segments merged = segments;
  make_manifold(mesh, segments, Progress(), kPlacedReach_mm);
  checks::expect_sound_mesh(mesh, volume);
  checks::expect_proper_parts(mesh, segments);

  // away from the pinches nothing changed
  std::vector<Vec3> pinches;
  std::vector<char> is_pinched(before.points.size(), 0);
  const Stars stars(before);
  PinchTest test;
  for (std::size_t i = 0; i < before.points.size(); ++i) {
    const int point = static_cast<int>(i);
    if (test.defects(before, merged.of_tetrahedron, point, stars.of(point)) == 0) continue;
    is_pinched[i] = 1;
    pinches.push_back(before.points[i]);
  }
  for (int t = 0; t < before.count(); ++t) {
    const auto& corners = before.tetrahedra[t];
    for (const int a : corners)
      for (const int b : corners)
        if (a < b && is_pinched[a] && is_pinched[b])
          pinches.push_back((before.points[a] + before.points[b]) / 2);
    if (std::any_of(corners.begin(), corners.end(), [&](int p) { return is_pinched[p]; })) continue;
    RC_ASSERT(mesh.tetrahedra[t] == corners);
    RC_ASSERT(segments.of_tetrahedron[t] == merged.of_tetrahedron[t]);
  }
  for (std::size_t i = before.points.size(); i < mesh.points.size(); ++i)
    RC_ASSERT(std::any_of(pinches.begin(), pinches.end(), [&](const Vec3& pinch) {
      return (pinch - mesh.points[i]).norm() < kPlacedReach_mm + 1e-9;
    }));
}

TEST(Segment, DividesASphereEvenly) {
  TetMesh mesh = fixtures::sphere_shell(3, 3, 60, 3);
  Random random(3);
  fixtures::jitter(mesh, 0.1, random);
  const double volume = total_volume_mm3(mesh);
  ShapeSettings settings;
  const Segments segments = segment(mesh, settings, 1, Progress());
  checks::expect_sound_mesh(mesh, volume);
  checks::expect_proper_parts(mesh, segments);
  EXPECT_GE(segments.count, 50);
  EXPECT_LE(segments.count, 100);
  const auto volumes = segment_volumes(mesh, segments);
  EXPECT_LT(*std::max_element(volumes.begin(), volumes.end()), 3.5 * volume / segments.count);
}

TEST(Segment, IsTheSameOnOneThreadAndTwo) {
  std::vector<Segments> answers;
  std::vector<TetMesh> meshes;
  for (const std::size_t threads : {1, 2}) {
    const ThreadLimit limit(threads);
    meshes.push_back(fixtures::cube_shell(10, 2, 50));
    answers.push_back(segment(meshes.back(), ShapeSettings(), 7, Progress()));
  }
  EXPECT_EQ(answers[0].of_tetrahedron, answers[1].of_tetrahedron);
  EXPECT_EQ(meshes[0].tetrahedra, meshes[1].tetrahedra);
  EXPECT_EQ(meshes[0].points, meshes[1].points);
  TetMesh other = fixtures::cube_shell(10, 2, 50);
  EXPECT_NE(segment(other, ShapeSettings(), 8, Progress()).of_tetrahedron,
            answers[0].of_tetrahedron);
}

TEST(Segment, CoversComponentsThatAreTooSmallForASeed) {
  // a large box and, ten cells away, a single cell
  TetMesh mesh = fixtures::grid_mesh(
      {20, 6, 6}, 3,
      [](const fixtures::Cell& c) {
        return c[0] < 8 || c == fixtures::Cell{19, 0, 0};
      },
      [](const fixtures::Cell&) { return false; });
  ShapeSettings settings;
  settings.clusters = 10;
  const Segments segments = segment(mesh, settings, 1, Progress());
  checks::expect_proper_parts(mesh, segments);
  const auto volumes = segment_volumes(mesh, segments);
  EXPECT_NEAR(*std::min_element(volumes.begin(), volumes.end()), 27, 1e-9);
}

TEST(Segment, OneTetrahedronAndNone) {
  TetMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.tetrahedra = {{0, 1, 2, 3}};
  mesh.sides = {{FaceSide::kOutside, FaceSide::kOutside, FaceSide::kOutside, FaceSide::kOutside}};
  link_neighbours(mesh);
  EXPECT_EQ(segment(mesh, ShapeSettings(), 1, Progress()).count, 1);
  TetMesh empty;
  EXPECT_THROW(segment(empty, ShapeSettings(), 1, Progress()), Error);
}

TEST(Segment, CanBeInterrupted) {
  TetMesh mesh = fixtures::cube_shell(6, 1, 60);
  const std::atomic<bool> cancelled{true};
  EXPECT_THROW(segment(mesh, ShapeSettings(), 1, Progress({}, &cancelled)), Error);
}

TEST(PartSurface, RefusesAPinchedPart) {
  TetMesh mesh = fixtures::solid_box({2, 2, 1}, 10);
  Segments segments{{}, 2};
  for (int t = 0; t < mesh.count(); ++t) {
    const Vec3 c = mesh.centroid(t) / 10;
    segments.of_tetrahedron.push_back((static_cast<int>(c.x()) + static_cast<int>(c.y())) % 2);
  }
  EXPECT_THROW(part_surface(mesh, segments, 0), Error);
}

TEST(Adjacency, MeasuresTheSharedFaces) {
  TetMesh mesh = fixtures::solid_box({4, 2, 3}, 5);
  Segments segments{{}, 2};
  for (int t = 0; t < mesh.count(); ++t)
    segments.of_tetrahedron.push_back(mesh.centroid(t).x() < 10 ? 0 : 1);
  const auto edges = adjacency(mesh, segments);
  ASSERT_EQ(edges.size(), 1u);
  EXPECT_EQ(edges[0].a, 0);
  EXPECT_EQ(edges[0].b, 1);
  EXPECT_NEAR(edges[0].area_mm2, 10 * 15, 1e-9);
  double length = 0;
  for (const auto& [a, b] : cut_curves(mesh, segments)) length += (a - b).norm();
  EXPECT_NEAR(length, 2 * (10 + 15), 1e-9);
}

TEST(Adjacency, FindsTheSegmentsRoundEachCavity) {
  // two cavities of one cell in a row of seven cells, walls one cell thick
  const auto hole = [](const fixtures::Cell& c) {
    return c[1] == 1 && c[2] == 1 && (c[0] == 1 || c[0] == 5);
  };
  const TetMesh mesh = fixtures::grid_mesh(
      {7, 3, 3}, 10, [&](const fixtures::Cell& c) { return !hole(c); }, hole);
  Segments segments{{}, 3};
  for (int t = 0; t < mesh.count(); ++t) {
    const double x = mesh.centroid(t).x();
    segments.of_tetrahedron.push_back(x < 15 ? 0 : x < 40 ? 1 : 2);
  }
  EXPECT_EQ(segments_round_cavities(mesh, segments), (std::vector<std::vector<int>>{{0, 1}, {2}}));
  EXPECT_TRUE(
      segments_round_cavities(fixtures::solid_box({2, 2, 2}, 5), {std::vector<int>(48, 0), 1})
          .empty());
}

TEST(United, RefusesGroupsThatMissOrRepeatALabel) {
  const Segments segments{{0, 1, 2}, 3};
  EXPECT_EQ(united(segments, {{2}, {0, 1}}).of_tetrahedron, (std::vector<int>{1, 1, 0}));
  EXPECT_THROW(united(segments, {{0}, {1}}), Error);
  EXPECT_THROW(united(segments, {{0, 1}, {1, 2}}), Error);
  EXPECT_THROW(united(segments, {{0, 1}, {2, 3}}), Error);
}

}  // namespace
}  // namespace packmerger
