#include "bench/models.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "base/error.h"
#include "bench/balls_and_sticks.h"
#include "fixtures/models.h"
#include "fixtures/profiles.h"
#include "printers/estimate/estimate.h"
#include "shape/solid/hollow.h"
#include "shape/surface/repair.h"

namespace packmerger::bench {
namespace {

// closed_mesh() has made sure that the surface is closed and 2-manifold.
void expect_model(const Mesh& mesh, const Vec3& size_mm, double tolerance_mm) {
  EXPECT_FALSE(self_intersects(mesh));
  const Box3 box = bounding_box(mesh);
  EXPECT_NEAR(box.min().z(), 0, 1e-9);
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(box.sizes()[axis], size_mm[axis], tolerance_mm) << "axis " << axis;
}

int pieces_by_euler(const Mesh& mesh) {  // of surfaces without handles
  const auto faces = static_cast<int>(mesh.n_triangles());
  const int edges = 3 * faces / 2;
  return (static_cast<int>(mesh.n_points()) - edges + faces) / 2;
}

Estimate standing(const Mesh& mesh) {
  Tray tray;
  tray.parts.push_back(mesh);
  return estimate(fixtures::shipped_profile("objet30"), {tray}, Assembly{}, Progress());
}

TEST(FigureModels, Sphere) {
  const Mesh mesh = sphere_model();
  expect_model(mesh, Vec3::Constant(80), 0.05);
  EXPECT_NEAR(volume_mm3(mesh), 4.0 / 3 * std::numbers::pi * std::pow(40, 3), 500);
}

TEST(FigureModels, Table) {
  const Mesh mesh = table_model();
  expect_model(mesh, {72, 72, 56}, 1e-9);
  EXPECT_NEAR(volume_mm3(mesh), 72 * 72 * 5 + 4 * 7 * 7 * 51, 1e-6);
}

TEST(FigureModels, Arch) {
  const Mesh mesh = arch_model();
  expect_model(mesh, {kArchWidth_mm, kArchDepth_mm, kArchHeight_mm}, 1e-9);
  EXPECT_EQ(pieces_by_euler(mesh), 1);
  const double outer = kArchWidth_mm / 2, inner = outer - kArchRib_mm;
  const double front = std::numbers::pi / 2 * (outer * outer - inner * inner) +
                       2 * kArchRib_mm * (kArchHeight_mm - outer);
  EXPECT_NEAR(volume_mm3(mesh), front * kArchDepth_mm, 2e-3 * front * kArchDepth_mm);
}

TEST(FigureModels, HollowArchHoldsWhatThePaperPrinted) {
  Warnings warnings;
  const Shell shell = hollow(arch_model(), ShapeSettings(), warnings, Progress());
  ASSERT_EQ(shell.cavities.size(), 1U);
  EXPECT_NEAR(shell.volume_mm3, 167e3, 0.05 * 167e3);
}

TEST(FigureModels, ArchFitsTheUprintPlusInNoWay) {
  const Vec3 tray = fixtures::shipped_profile("uprint-plus").build();
  const Mesh arch = arch_model();
  for (int degree = 0; degree <= 180; ++degree) {
    const double c = std::cos(radians(degree)), s = std::sin(radians(degree));
    Box3 box;
    for (const Vec3& p : arch.points())
      box.extend(Vec3(c * p.x() - s * p.z(), s * p.x() + c * p.z(), p.y()));
    EXPECT_GT(box.sizes().head<2>().maxCoeff(), tray.x()) << "lying, turned by " << degree;
    EXPECT_GT(box.sizes().y(), tray.z()) << "on edge, turned by " << degree;
  }
}

TEST(BallsAndSticks, DumbBell) {
  constexpr double kBall = 10, kStick = 4, kApart = 40, kPi = std::numbers::pi;
  const Vec3 far(kApart / std::sqrt(2), 0, kApart / std::sqrt(2));
  const Mesh mesh =
      closed_mesh(balls_and_sticks({{Vec3::Zero(), kBall}, {far, kBall}}, {{0, 1}}, kStick, 1));
  EXPECT_EQ(pieces_by_euler(mesh), 1);
  EXPECT_FALSE(self_intersects(mesh));
  for (const Vec3& p : mesh.points()) {
    const double from_axis = p.cross(far.normalized()).norm();
    const double nearest = std::min({std::abs(p.norm() - kBall), std::abs((p - far).norm() - kBall),
                                     std::abs(from_axis - kStick)});
    EXPECT_NEAR(nearest, 0, 1e-9);
  }
  const double rim = std::sqrt(kBall * kBall - kStick * kStick);  // from a ball's centre
  const double cap = kPi * std::pow(kBall - rim, 2) * (2 * kBall + rim) / 3;
  const double volume =
      2 * (4.0 / 3 * kPi * std::pow(kBall, 3) - cap) + kPi * kStick * kStick * (kApart - 2 * rim);
  EXPECT_NEAR(volume_mm3(mesh), volume, 0.01 * volume);
}

TEST(FigureModels, Molecule) {
  const Mesh mesh = molecule_model();
  EXPECT_EQ(pieces_by_euler(mesh), 1);
  // two hydrogens beside each other below, at 120° round the axis
  const double to_hydrogen = (kMoleculeHeight_mm - 2 * kHydrogenRadius_mm) / std::numbers::sqrt2;
  const double across = to_hydrogen * 2 * std::sqrt(2.0 / 3) + 2 * kHydrogenRadius_mm;
  expect_model(mesh, {across, kMoleculeDepth_mm, kMoleculeHeight_mm}, 0.3);
}

TEST(FigureModels, Groups) {
  for (const double scale : {1.0, kSecondGroupScale}) {
    const std::vector<Mesh> group = group_models(scale);
    ASSERT_EQ(group.size(), 4U);
    double volume = 0;
    for (std::size_t i = 0; i < group.size(); ++i) {
      const RoundSize size = std::array{kLargeCup, kSmallCup, kLargeCrystal, kSmallCrystal}[i];
      const Vec3 wanted(2 * size.radius_mm, 2 * size.radius_mm, size.height_mm);
      expect_model(group[i], scale * wanted, 1e-9);
      EXPECT_EQ(pieces_by_euler(group[i]), 1);
      volume += volume_mm3(group[i]);
    }
    // what was sliced when the sizes were chosen
    EXPECT_NEAR(volume, 13.1e3 * std::pow(scale, 3), 0.02 * 13.1e3 * std::pow(scale, 3));
  }
}

TEST(FigureModels, Bunny) {
  PACKMERGER_TEST_MODEL(installed, "bunny");
  EXPECT_EQ(installed.triangles.size(), 3674U);
  const Mesh mesh = bunny_model();
  EXPECT_NEAR(bounding_box(mesh).sizes().maxCoeff(), 141.6, 1e-9);
  EXPECT_NEAR(bounding_box(mesh).sizes().z(), 138, 1);
  EXPECT_NEAR(bounding_box(mesh).min().z(), 0, 1e-9);
}

TEST(SolidRowsOfTableOne, Sphere) {
  const Estimate e = standing(sphere_model());
  EXPECT_NEAR(e.time_s, 22980, 2298);
  EXPECT_NEAR(e.support_g, 110, 11);
}

TEST(SolidRowsOfTableOne, Bunny) {
  PACKMERGER_TEST_MODEL(installed, "bunny");
  EXPECT_EQ(installed.triangles.size(), 3674U);
  const Mesh mesh = bunny_model();
  const Estimate e = standing(mesh);
  EXPECT_NEAR(e.time_s, 49380, 4938);
  EXPECT_NEAR(e.support_g, 351, 35.1);
}

TEST(SolidRowsOfTableOne, Molecule) {
  const Estimate e = standing(molecule_model());
  EXPECT_NEAR(e.time_s, 57300, 5730);
  EXPECT_NEAR(e.support_g, 264, 26.4);
}

}  // namespace
}  // namespace packmerger::bench
