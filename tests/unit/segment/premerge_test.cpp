// Pre-merging: what it promises, and when it must not merge.
#include "shape/divide/premerge.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/parallel.h"
#include "fixtures/tet_models.h"
#include "part_checks.h"
#include "shape/divide/manifold_parts.h"
#include "shape/divide/segment.h"

namespace packmerger {
namespace {

const BuildVolume kHuge{Vec3(1000, 1000, 1000), radians(30)};

TetMesh jittered_sphere() {
  TetMesh mesh = fixtures::sphere_shell(4, 2, 100, 3);
  Random random(3);
  fixtures::jitter(mesh, 0.1, random);
  return mesh;
}

// Slices of a bar along x: label i up to ends[i].
Segments sliced(const TetMesh& mesh, const std::vector<double>& ends) {
  Segments segments{{}, static_cast<int>(ends.size())};
  for (int t = 0; t < mesh.count(); ++t) {
    int label = 0;
    while (mesh.centroid(t).x() > ends[label]) ++label;
    segments.of_tetrahedron.push_back(label);
  }
  return segments;
}

bool warns(const Warnings& warnings, const std::string& code) {
  return std::any_of(warnings.begin(), warnings.end(),
                     [&](const Warning& w) { return w.code == code; });
}

// Straight from the definition: rotates every point every way.
bool fits_somehow(const Mesh& part, const BuildVolume& build) {
  const int steps = static_cast<int>(std::lround(2 * std::numbers::pi / build.rotation_step));
  for (int i = 0; i < steps * steps * steps; ++i) {
    const Mat3 turn = (Eigen::AngleAxisd(i / steps / steps * build.rotation_step, Vec3::UnitZ()) *
                       Eigen::AngleAxisd(i / steps % steps * build.rotation_step, Vec3::UnitY()) *
                       Eigen::AngleAxisd(i % steps * build.rotation_step, Vec3::UnitX()))
                          .toRotationMatrix();
    Box3 box;
    for (const Vec3& point : part.points()) box.extend(turn * point);
    if ((box.sizes().array() <= build.build_mm.array() + 1e-6).all()) return true;
  }
  return false;
}

TEST(Premerge, LeavesNoSmallJointAndNoSmallSegment) {
  TetMesh mesh = jittered_sphere();
  const double volume = total_volume_mm3(mesh);
  const ShapeSettings settings;
  Warnings warnings;
  const Segments clusters = segment(mesh, settings, 1, Progress());
  const Segments merged = premerge(mesh, clusters, settings, kHuge, warnings, Progress());
  checks::expect_sound_mesh(mesh, volume);
  checks::expect_proper_parts(mesh, merged);
  EXPECT_TRUE(warnings.empty());
  EXPECT_GT(merged.count, 5);
  EXPECT_LE(merged.count, 20);
  for (const SegmentEdge& edge : adjacency(mesh, merged))
    EXPECT_GE(edge.area_mm2, settings.min_glue_area_mm2);
  for (const double part : segment_volumes(mesh, merged))
    EXPECT_GE(part, settings.min_volume_fraction * volume);
}

TEST(Premerge, NeverExceedsTheBuildVolumeAndSaysWhatItLeaves) {
  TetMesh mesh = jittered_sphere();
  const ShapeSettings settings;
  const BuildVolume build{Vec3(40, 30, 25), radians(45)};
  Warnings warnings;
  const Segments clusters = segment(mesh, settings, 1, Progress());
  const Segments merged = premerge(mesh, clusters, settings, build, warnings, Progress());
  checks::expect_proper_parts(mesh, merged);
  for (const SegmentSurface& part : part_surfaces(mesh, merged))
    EXPECT_TRUE(fits_somehow(part.surface, build));
  const double volume = total_volume_mm3(mesh);
  const auto volumes = segment_volumes(mesh, merged);
  EXPECT_EQ(warns(warnings, "small_segment"),
            std::any_of(volumes.begin(), volumes.end(),
                        [&](double part) { return part < settings.min_volume_fraction * volume; }));
  const auto edges = adjacency(mesh, merged);
  EXPECT_EQ(warns(warnings, "small_glue_area"),
            std::any_of(edges.begin(), edges.end(), [&](const SegmentEdge& edge) {
              return edge.area_mm2 < settings.min_glue_area_mm2;
            }));
  EXPECT_TRUE(warns(warnings, "small_segment"));
}

TEST(Premerge, TurnsABarUprightWhereThePackerMay) {
  ShapeSettings settings;
  settings.min_volume_fraction = 0.6;
  const auto parts_of_bar = [&](const Vec3& build_mm, double step) {
    TetMesh mesh = fixtures::solid_box({20, 2, 2}, 5);  // 100×10×10
    Warnings warnings;
    return premerge(mesh, sliced(mesh, {50, 100}), settings, {build_mm, step}, warnings, Progress())
        .count;
  };
  EXPECT_EQ(parts_of_bar({100, 10, 10}, 0), 1);
  EXPECT_EQ(parts_of_bar({10, 10, 100}, 0), 2);
  EXPECT_EQ(parts_of_bar({10, 10, 100}, radians(90)), 1);
  EXPECT_EQ(parts_of_bar({10, 10, 99}, radians(90)), 2);
  // along the diagonal of a square plate: (100 + 10) / √2 = 77.8
  EXPECT_EQ(parts_of_bar({78, 78, 10}, radians(45)), 1);
  EXPECT_EQ(parts_of_bar({77, 77, 10}, radians(45)), 2);
  EXPECT_EQ(parts_of_bar({78, 78, 10}, radians(90)), 2);
}

TEST(Premerge, LeavesNoPartThatHasNoRoomBetweenThePlatesWalls) {
  ShapeSettings settings;
  settings.min_volume_fraction = 0.6;
  const auto parts_of_bar = [&](const Plate& plate) {
    TetMesh mesh = fixtures::solid_box({20, 2, 2}, 5);  // 100×10×10
    Warnings warnings;
    const BuildVolume build{Vec3(120, 120, 20), radians(90), plate};
    return premerge(mesh, sliced(mesh, {50, 100}), settings, build, warnings, Progress()).count;
  };
  const auto disc = [](double radius) {
    Polygon corners;
    for (int i = 0; i < 72; ++i) {
      const double angle = radians(5.0 * i);
      corners.emplace_back(60 + radius * std::cos(angle), 60 + radius * std::sin(angle));
    }
    return corners;
  };
  EXPECT_EQ(parts_of_bar({}), 1);
  EXPECT_EQ(parts_of_bar(Plate(disc(51), {})), 1);
  EXPECT_EQ(parts_of_bar(Plate(disc(49), {})), 2);
  // Strips that leave 11, or 9 mm of the plate.
  EXPECT_EQ(parts_of_bar(Plate({}, {{{11, -1}, {121, -1}, {121, 121}, {11, 121}}})), 1);
  EXPECT_EQ(parts_of_bar(Plate({}, {{{9, -1}, {121, -1}, {121, 121}, {9, 121}}})), 2);
}

TEST(Premerge, SmallestCrossSectionFirstThenSmallestVolumeIntoSmallestNeighbour) {
  ShapeSettings settings;
  settings.min_glue_area_mm2 = 50;
  settings.min_volume_fraction = 0.25;
  TetMesh mesh = fixtures::solid_box({20, 2, 2}, 5);
  Warnings warnings;
  // 10 % goes to the smaller neighbour on its right, though the left one comes first
  const Segments merged =
      premerge(mesh, sliced(mesh, {50, 60, 100}), settings, kHuge, warnings, Progress());
  ASSERT_EQ(merged.count, 2);
  const auto volumes = segment_volumes(mesh, merged);
  EXPECT_NEAR(volumes[0], 5000, 1e-6);
  EXPECT_NEAR(volumes[1], 5000, 1e-6);
  EXPECT_TRUE(warnings.empty());
  // joints of 100 mm² are all below 101 mm²
  settings.min_glue_area_mm2 = 101;
  EXPECT_EQ(
      premerge(mesh, sliced(mesh, {50, 60, 100}), settings, kHuge, warnings, Progress()).count, 1);
}

TEST(Premerge, ShutsNoCavity) {
  ShapeSettings settings;
  settings.min_volume_fraction = 1;  // all in one part, but for the cavity
  TetMesh mesh = fixtures::cube_shell(10, 2, 50);
  Segments halves{{}, 2};
  for (int t = 0; t < mesh.count(); ++t)
    halves.of_tetrahedron.push_back(mesh.centroid(t).x() < 0 ? 0 : 1);
  Warnings warnings;
  EXPECT_EQ(premerge(mesh, halves, settings, kHuge, warnings, Progress()).count, 2);
  EXPECT_TRUE(warns(warnings, "small_segment"));
  // a cavity that lies in one segment from the start is no reason to keep another one apart
  Segments corner{{}, 2};
  for (int t = 0; t < mesh.count(); ++t)
    corner.of_tetrahedron.push_back(mesh.centroid(t).maxCoeff() < -20 ? 0 : 1);
  EXPECT_EQ(premerge(mesh, corner, settings, kHuge, warnings, Progress()).count, 1);
}

TEST(Premerge, LeavesALonelySmallComponentWithAWarning) {
  TetMesh mesh = fixtures::grid_mesh(
      {20, 6, 6}, 3,
      [](const fixtures::Cell& c) {
        return c[0] < 8 || c == fixtures::Cell{19, 0, 0};
      },
      [](const fixtures::Cell&) { return false; });
  Warnings warnings;
  const Segments clusters = segment(mesh, ShapeSettings(), 1, Progress());
  const Segments merged = premerge(mesh, clusters, ShapeSettings(), kHuge, warnings, Progress());
  checks::expect_proper_parts(mesh, merged);
  EXPECT_TRUE(warns(warnings, "small_segment"));
}

TEST(Premerge, IsTheSameOnOneThreadAndTwo) {
  std::vector<Segments> answers;
  for (const std::size_t threads : {1, 2}) {
    const ThreadLimit limit(threads);
    TetMesh mesh = fixtures::cube_shell(10, 2, 50);
    Warnings warnings;
    const Segments clusters = segment(mesh, ShapeSettings(), 7, Progress());
    answers.push_back(premerge(mesh, clusters, ShapeSettings(), kHuge, warnings, Progress()));
  }
  EXPECT_EQ(answers[0].of_tetrahedron, answers[1].of_tetrahedron);
}

}  // namespace
}  // namespace packmerger
