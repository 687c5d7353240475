// Divisions by planes: what is promised of the search, of the judge and of the exact cuts.
#include "shape/cut/cut_plans.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <map>

#include "base/parallel.h"
#include "fixtures/tet_models.h"
#include "part_checks.h"
#include "shape/cut/cut_recipes.h"
#include "shape/cut/plane_cut.h"
#include "shape/cut/stand_alone.h"
#include "shape/divide/manifold_parts.h"

namespace packmerger {
namespace {

const BuildVolume kHuge{Vec3(1000, 1000, 1000), radians(30)};

Vec3 random_direction(Random& random) {
  Vec3 direction;
  do direction = {2 * random.unit() - 1, 2 * random.unit() - 1, 2 * random.unit() - 1};
  while (direction.norm() > 1 || direction.norm() < 0.1);
  return direction.normalized();
}

TetMesh any_mesh(Random& random) {
  TetMesh mesh = random.below(2) == 0 ? fixtures::cube_shell(6, 1 + random.below(2), 30)
                                      : fixtures::sphere_shell(2, 3, 40, 4);
  fixtures::jitter(mesh, 0.15, random);
  return mesh;
}

CutSearch brief(double part_price_mm3 = 100) {
  CutSearch search;
  search.part_price_mm3 = part_price_mm3;
  search.effort = 60;
  search.samples = 6000;
  return search;
}

PieceShape whole_of(const MatterSamples& samples) {
  PieceShape piece;
  for (int i = 0; i < samples.count(); ++i) piece.samples.push_back(i);
  piece.volume_mm3 = samples.volume_mm3;
  return piece;
}

RC_GTEST_PROP(PlaneCut, CutsFlatAndKeepsTheMeshSound, (std::uint64_t seed)) {
  Random random(seed);
  TetMesh mesh = any_mesh(random);
  const double volume = total_volume_mm3(mesh);
  std::vector<int> labels(mesh.tetrahedra.size(), 0);
  PlaneCutter cutter(mesh, labels);
  // each cut divides one label; the planes may cross, coincide with mesh points and miss the mesh
  std::map<int, std::vector<std::pair<Plane, bool>>> sides{{0, {}}};
  int next = 1;
  for (int i = 0; i < 4; ++i) {
    const Vec3 normal = random.below(3) == 0 ? Vec3(Vec3::UnitX()) : random_direction(random);
    const Vec3 through = random.below(2) == 0 ? mesh.points[random.below(mesh.points.size())]
                                              : Vec3(10 * random_direction(random));
    const Plane plane(normal, through);
    const int label = static_cast<int>(random.below(next));
    cutter.cut(label, plane, label, next);
    sides[next] = sides[label];
    sides[label].emplace_back(plane, false);
    sides[next].emplace_back(plane, true);
    ++next;
  }
  cutter.link();
  checks::expect_sound_mesh(mesh, volume);
  RC_ASSERT(labels.size() == mesh.tetrahedra.size());
  // a later move within an earlier plane is not one away from it, but a later plane may take a
  // point along that could not stay
  const double flat = 4 * kOnPlane_mm;
  for (int t = 0; t < mesh.count(); ++t)
    for (const auto& [plane, above] : sides[labels[t]])
      for (const int point : mesh.tetrahedra[t]) {
        const double distance = plane.signedDistance(mesh.points[point]);
        RC_ASSERT((above ? distance : -distance) >= -flat);
      }
}

TEST(PlaneCut, PlanesThroughOneLineKeepMeetingThere) {
  TetMesh mesh = fixtures::sphere_shell(4, 2, 80, 3);
  Random random(4);
  fixtures::jitter(mesh, 0.15, random);
  const Vec3 axis = Vec3(0.3, 0.2, 1).normalized();
  const Vec3 x = axis.unitOrthogonal(), y = axis.cross(x);
  std::vector<int> labels(mesh.tetrahedra.size(), 0);
  PlaneCutter cutter(mesh, labels);
  cutter.cut(0, Plane(x, 0), 0, 1);
  cutter.cut(0, Plane(y, 0), 0, 2);
  cutter.cut(1, Plane(y, 0), 1, 3);
  cutter.link();
  Segments segments = connected_segments(mesh, labels, 0);
  ASSERT_EQ(segments.count, 4);
  // opposite quarters meet in the axis only
  EXPECT_EQ(adjacency(mesh, segments).size(), 4U);
}

TEST(PlaneCut, FragmentsGoToTheirLargestNeighbour) {
  const TetMesh mesh = fixtures::solid_box({10, 2, 2}, 1);
  std::vector<int> labels;
  for (int t = 0; t < mesh.count(); ++t) {
    const double x = mesh.centroid(t).x();
    labels.push_back(x < 1 ? 0 : x < 5 ? 1 : x < 6 ? 0 : 2);
  }
  const Segments all = connected_segments(mesh, labels, 0);
  EXPECT_EQ(all.count, 4);
  const Segments large = connected_segments(mesh, labels, 6);
  EXPECT_EQ(large.count, 2);
  EXPECT_EQ(checks::face_connected_pieces(mesh, large), 2);
}

TEST(MatterSamples, HoldTheVolumeAndTheCrossSections) {
  TetMesh mesh = fixtures::sphere_shell(4, 2, 80, 3);
  Random random(3);
  fixtures::jitter(mesh, 0.15, random);
  const MatterSamples samples = sample_matter(mesh, 20000);
  EXPECT_GT(samples.count(), 10000);
  EXPECT_LT(samples.count(), 40000);
  double sum = 0;
  Vec3 outward = Vec3::Zero();
  for (int i = 0; i < samples.count(); ++i) {
    sum += samples.volumes_mm3[i];
    outward += samples.areas_mm2[i];
  }
  EXPECT_NEAR(sum, total_volume_mm3(mesh), 1e-6 * sum);
  EXPECT_NEAR(outward.norm(), 0, 1e-6);
  ASSERT_EQ(samples.round_cavities.size(), 1U);
  for (int n = 0; n < 5; ++n) {
    const Plane plane(random_direction(random), Vec3(10 * random_direction(random)));
    int crossed = 0;
    for (int i = 0; i < samples.count(); ++i)
      for (const int other : samples.near_to(i))
        crossed += plane.signedDistance(samples.points[i]) > 0 &&
                           plane.signedDistance(samples.points[other]) <= 0
                       ? 1
                       : 0;
    TetMesh cut = mesh;
    std::vector<int> labels(cut.tetrahedra.size(), 0);
    PlaneCutter cutter(cut, labels);
    cutter.cut(0, plane, 0, 1);
    cutter.link();
    const auto sections = adjacency(cut, {labels, 2});
    ASSERT_EQ(sections.size(), 1U);
    EXPECT_NEAR(crossed * samples.area_per_link_mm2, sections[0].area_mm2,
                0.25 * sections[0].area_mm2);
  }
}

TEST(StandAlone, ASolidBoxNeedsNothing) {
  const TetMesh mesh = fixtures::solid_box({20, 10, 5}, 2);
  const MatterSamples samples = sample_matter(mesh, 5000);
  EXPECT_LT(stand_alone(samples, whole_of(samples), 0).support_mm3, 0.03 * samples.volume_mm3);
}

// Half a shell stands best on its rim, and the room below its dome is two thirds of π r³.
TEST(StandAlone, AHalfShellNeedsTheRoomBelowItsDome) {
  const TetMesh mesh = fixtures::sphere_shell(5, 2, 80, 3);
  const MatterSamples samples = sample_matter(mesh, 30000);
  PieceShape half;
  for (int i = 0; i < samples.count(); ++i)
    if (samples.points[i].z() > 0) {
      half.samples.push_back(i);
      half.volume_mm3 += samples.volumes_mm3[i];
    }
  half.planes.emplace_back(Vec3(Vec3::UnitZ()), 0.0);
  const Standing standing = stand_alone(samples, half, 0);
  // on the rim 2/3 π 37³ = 106 cm³; as a bowl what is outside: π 40² 40 - 2/3 π 40³ = 67 cm³
  EXPECT_NEAR(standing.support_mm3, 67000, 4000);
  EXPECT_LT(standing.up.z(), -0.8);
  // at 89° hardly a facet is steep enough
  EXPECT_LT(stand_alone(samples, half, radians(89)).support_mm3, 0.1 * standing.support_mm3);
}

// Every promise of the search and of the cuts on one mesh; answers the best plan's support.
double plan_and_check(const TetMesh& whole, const ShapeSettings& settings, const CutSearch& search,
                      const BuildVolume& build = kHuge) {
  const double volume = total_volume_mm3(whole);
  const auto plans = cut_plans(whole, settings, build, search, 3, Progress());
  EXPECT_FALSE(plans.empty());
  double last = 0;
  for (const CutPlan& plan : plans) {
    EXPECT_GE(plan.parts, 2);
    EXPECT_LE(plan.parts, settings.parts);
    const double cost = plan.support_mm3 + search.part_price_mm3 * plan.parts;
    EXPECT_GE(cost, last);
    last = cost;
    TetMesh mesh = whole;
    const Segments segments = cut_as_planned(mesh, plan, Progress());
    checks::expect_sound_mesh(mesh, volume);
    checks::expect_proper_parts(mesh, segments);
    EXPECT_EQ(segments.count, plan.parts);
    for (const double part : segment_volumes(mesh, segments))
      EXPECT_GT(part, 0.8 * settings.min_volume_fraction * volume);
    for (const auto& labels : segments_round_cavities(mesh, segments)) EXPECT_GT(labels.size(), 1U);
    // samples may miss a tiny contact, seldom
    Warnings warnings;
    const Segments merged = premerge(mesh, segments, settings, build, warnings, Progress());
    EXPECT_GE(merged.count, plan.parts - 2);
    EXPECT_TRUE(warnings.empty());
    checks::expect_proper_parts(mesh, merged);
  }
  return plans.empty() ? 0 : plans.front().support_mm3;
}

TEST(CutPlans, ASphereStandsFarBetterThanWhole) {
  const TetMesh mesh = fixtures::sphere_shell(4, 2, 80, 3);
  ShapeSettings settings;
  // the solid ball's own support: half of the cylinder round it less half of the ball
  const double solid_mm3 = 67000;
  EXPECT_LT(plan_and_check(mesh, settings, brief()), 0.5 * solid_mm3);
  settings.parts = 7;
  EXPECT_LT(plan_and_check(mesh, settings, brief()), 0.7 * solid_mm3);
}

TEST(CutPlans, ABoxFallsIntoPlates) {
  const TetMesh mesh = fixtures::cube_shell(20, 1, 60);
  ShapeSettings settings;
  settings.parts = 8;
  // standing as an open frame and plates it needs next to nothing; whole, its cavity
  EXPECT_LT(plan_and_check(mesh, settings, brief()), 0.2 * std::pow(54, 3));
}

TEST(CutPlans, ManyPartsAreNotMadeWhereTheySaveLittle) {
  const TetMesh mesh = fixtures::sphere_shell(3, 2, 80, 3);
  ShapeSettings settings;
  for (const CutPlan& plan : cut_plans(mesh, settings, kHuge, brief(20000), 1, Progress()))
    EXPECT_LE(plan.parts, 8);
}

TEST(CutPlans, OnePlanIsOfTheManyPartsThatALowerPriceAllows) {
  const TetMesh mesh = fixtures::sphere_shell(3, 3, 40, 4);
  ShapeSettings settings;
  settings.parts = 10;
  CutSearch search = brief(total_volume_mm3(mesh) / 20);
  search.least_price_mm3 = total_volume_mm3(mesh) / 1000;
  const std::vector<CutPlan> plans = cut_plans(mesh, settings, kHuge, search, 1, {});
  ASSERT_GE(plans.size(), 2U);
  EXPECT_GT(plans[1].parts, plans[0].parts);
  EXPECT_LT(plans[1].support_mm3, plans[0].support_mm3);
}

TEST(CutPlans, SomePlanFitsASmallPrinter) {
  const TetMesh mesh = fixtures::sphere_shell(4, 2, 80, 3);
  const BuildVolume build{Vec3(70, 70, 40), radians(90)};
  CutSearch search = brief();
  search.samples = CutSearch().samples;
  const auto plans = cut_plans(mesh, ShapeSettings(), build, search, 1, Progress());
  ASSERT_FALSE(plans.empty());
  const bool some_fits = std::any_of(plans.begin(), plans.end(), [&](const CutPlan& plan) {
    TetMesh cut = mesh;
    const Segments segments = cut_as_planned(cut, plan, Progress());
    const auto parts = part_surfaces(cut, segments);
    return std::all_of(parts.begin(), parts.end(), [](const SegmentSurface& part) {
      // quarter turns only exchange the axes
      Vec3 size = bounding_box(part.surface).sizes();
      std::sort(size.begin(), size.end());
      return size.x() <= 40 && size.z() <= 70;
    });
  });
  EXPECT_TRUE(some_fits);
}

TEST(CutPlans, AreTheSameOnOneThreadAndTwo) {
  const TetMesh mesh = fixtures::sphere_shell(3, 2, 80, 3);
  std::vector<std::vector<CutPlan>> answers;
  std::vector<TetMesh> cut(2, mesh);
  std::vector<Segments> segments;
  for (const std::size_t threads : {1, 2}) {
    const ThreadLimit limit(threads);
    answers.push_back(cut_plans(mesh, ShapeSettings(), kHuge, brief(), 5, Progress()));
    segments.push_back(cut_as_planned(cut[threads - 1], answers.back().front(), Progress()));
  }
  ASSERT_EQ(answers[0].size(), answers[1].size());
  for (std::size_t i = 0; i < answers[0].size(); ++i) {
    EXPECT_EQ(answers[0][i].construction, answers[1][i].construction);
    EXPECT_EQ(answers[0][i].parts, answers[1][i].parts);
    EXPECT_EQ(answers[0][i].support_mm3, answers[1][i].support_mm3);
  }
  EXPECT_EQ(cut[0].points, cut[1].points);
  EXPECT_EQ(cut[0].tetrahedra, cut[1].tetrahedra);
  EXPECT_EQ(segments[0].of_tetrahedron, segments[1].of_tetrahedron);
}

RC_GTEST_PROP(CutPlans, KeepTheMeshAndThePartsSound, (std::uint64_t seed)) {
  Random random(seed);
  const TetMesh whole = any_mesh(random);
  const double volume = total_volume_mm3(whole);
  ShapeSettings settings;
  settings.parts = 3 + static_cast<int>(random.below(6));
  CutSearch search = brief();
  search.effort = 10;
  search.samples = 1000;
  search.support_angle = random.below(2) == 0 ? 0 : radians(45);
  for (const CutPlan& plan : cut_plans(whole, settings, kHuge, search, seed, Progress())) {
    TetMesh mesh = whole;
    const Segments segments = cut_as_planned(mesh, plan, Progress());
    checks::expect_sound_mesh(mesh, volume);
    checks::expect_proper_parts(mesh, segments);
  }
}

}  // namespace
}  // namespace packmerger
