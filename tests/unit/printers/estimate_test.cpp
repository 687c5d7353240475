#include "printers/estimate/estimate.h"
#include "printers/price.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/error.h"
#include "fixtures/profiles.h"
#include "printers/estimate/fdm_toolpath.h"
#include "printers/estimate/linear_estimate.h"
#include "printers/estimate/polyjet.h"
#include "shapes.h"

namespace packmerger {
namespace {

using printed::box;
using printed::tray_of;

Estimate of(const Profile& profile, std::vector<Mesh> parts, const Assembly& assembly = {}) {
  return estimate(profile, {tray_of(std::move(parts))}, assembly, Progress());
}

Mesh standing_bunny(const TriangleSoup& bunny, double height_mm) {
  TriangleSoup soup = printed::with_holes_filled(bunny);
  for (Vec3& p : soup.points) p = Vec3(p.x(), -p.z(), p.y());
  const Mesh mesh = closed_mesh(soup);
  const Box3 at = bounding_box(mesh);
  return printed::scaled(printed::moved(mesh, -at.min()), height_mm / at.sizes().z());
}

TEST(Polyjet, LayerByHand) {
  const Profile profile = fixtures::plain_polyjet();
  const auto layer_s = [&](double x_mm, double y_mm) {
    PrintTerms terms;
    terms.by = Estimator::kPolyjet;
    terms.trays = 0;
    terms.layers = 1;
    add_passes(terms, profile.polyjet, 1, x_mm, y_mm);
    return time_of(profile, terms);
  };
  EXPECT_DOUBLE_EQ(layer_s(20, 10), 1 + 1 * (2 + 2));
  EXPECT_DOUBLE_EQ(layer_s(20, 10.1), 1 + 2 * (2 + 2));
  EXPECT_DOUBLE_EQ(layer_s(0, 0), 1 + 1 * 2);  // an empty layer is one pass
}

TEST(Polyjet, BoxByHand) {
  // 20 × 25 × 10 mm, 4 mm above the plate: 28 layers of 3 swaths, support included
  const Estimate e = of(fixtures::plain_polyjet(), {box(Vec3(5, 5, 4), Vec3(25, 30, 14))});
  EXPECT_NEAR(e.time_s, 60 + 28 * (1 + 3 * (2 + 0.1 * 20)), 0.5);
  EXPECT_NEAR(e.support_mm3, 20 * 25 * 4, 1e-3);
  EXPECT_NEAR(e.support_g, 2.0 * 2, 1e-6);
  EXPECT_NEAR(e.model_mm3, 5000 * 1.5, 1e-6);
  EXPECT_NEAR(e.model_g, 7.5 * 1.2, 1e-9);
  EXPECT_EQ(e.source, EstimateSource::kModel);
  EXPECT_EQ(e.trays, 1);
}

TEST(Powder, BoxByHand) {
  // 5 cm³ 4 mm above the floor: 28 layers, and a bed of 140 cm³
  const Estimate e = of(fixtures::plain_powder(), {box(Vec3(5, 5, 4), Vec3(25, 30, 14))});
  EXPECT_NEAR(e.time_s, 1000 + 28 * 10, 1e-6);
  EXPECT_EQ(e.support_mm3, 0);
  EXPECT_NEAR(e.model_g, 5, 1e-9);
  EXPECT_NEAR(e.support_g, 0.5 * (5 + 135 * 0.5) - 5, 1e-9);
}

TEST(Powder, WhereEnoughIsFusedNothingIsLost) {
  const Estimate e = of(fixtures::plain_powder(), {box(Vec3(5, 5, 1), Vec3(95, 95, 99))});
  EXPECT_EQ(e.support_g, 0);
}

TEST(Powder, ABedIsAsWideAsItsPlate) {
  Profile profile = fixtures::plain_powder();
  profile.plate_mm = {{0, 0}, {100, 0}, {0, 100}};
  const Estimate e = of(profile, {box(Vec3(5, 5, 4), Vec3(25, 30, 14))});
  EXPECT_NEAR(e.support_g, 0.5 * (5 + 65 * 0.5) - 5, 1e-9);
}

TEST(Polyjet, SolidSphereOfTableOne) {
  const Estimate e = of(fixtures::shipped_profile("objet30"), {printed::resting_sphere(40)});
  EXPECT_NEAR(e.time_s, 22980, 2298);
  EXPECT_NEAR(e.support_g, 110, 11);
}

TEST(Polyjet, SolidBunnyOfTableOne) {
  PACKMERGER_TEST_MODEL(bunny, "stanford-bunny.obj");
  const Estimate e = of(fixtures::shipped_profile("objet30"), {standing_bunny(bunny, 138)});
  EXPECT_NEAR(e.time_s, 49380, 4938);
  EXPECT_NEAR(e.support_g, 351, 35);
}

TEST(Deposition, BoxByHand) {
  // 1000 mm³ 8 mm above the plate: support 100 · 8 of which a quarter is laid; 36 layers
  const Estimate e = of(fixtures::plain_deposition(), {box(Vec3(0, 0, 8), Vec3(10, 10, 18))});
  EXPECT_NEAR(e.support_mm3, 800, 1e-3);
  EXPECT_NEAR(e.time_s, 100 + (1000 + 200) / 1.0 + 36 * 10, 1e-2);
  EXPECT_NEAR(e.model_g, 1.0, 1e-9);
  EXPECT_NEAR(e.support_g, 0.2 * 2.0, 1e-6);
}

TEST(Deposition, ArchOfThePaper) {
  // 167 cm³ of model and 60.6 cm³ of support, 14 h 18 min: here a slab of as much matter in the air
  Profile profile = fixtures::shipped_profile("uprint-plus");
  profile.fdm.support_fill_fraction = 1;
  const double side = std::sqrt(167000 / 80.0);
  const double lift = 60600 / (side * side);
  const Estimate e = of(profile, {box(Vec3(0, 0, lift), Vec3(side, side, lift + 80))});
  EXPECT_NEAR(e.time_s, 51480, 0.25 * 51480);
}

TEST(Toolpath, BeadIsARectangleWithRoundEnds) {
  FdmSettings settings;
  settings.line_width_mm = 0.45;
  const Bead one = bead(settings, 0.2);
  EXPECT_NEAR(one.spacing_mm, 0.45 - 0.2 * (1 - std::numbers::pi / 4), 1e-12);
  // a rectangle w − h by h and a circle of diameter h
  EXPECT_NEAR(one.area_mm2, 0.25 * 0.2 + std::numbers::pi * 0.01, 1e-12);
}

Layer square_layer(double side) {
  Layer layer;
  Contour contour{side * side, 4 * side, {}};
  contour.box.extend(Vec2(0, 0));
  contour.box.extend(Vec2(side, side));
  layer.contours = {contour};
  layer.area_mm2 = contour.area_mm2;
  layer.perimeter_mm = contour.perimeter_mm;
  return layer;
}

TEST(Toolpath, LayerByHand) {
  const FdmSettings settings;
  const double sp = bead(settings, 0.2).spacing_mm;
  const LayerPath path = layer_path(settings, 0.2, square_layer(40), 0);
  const double inner = 1600 - 1.5 * sp * 160;
  EXPECT_NEAR(path.external_mm, 160, 1e-9);
  EXPECT_NEAR(path.internal_mm, 160, 1e-9);
  EXPECT_NEAR(path.sparse_mm, inner * 0.1 / sp, 1e-9);
  EXPECT_EQ(path.solid_mm, 0);
  // mean chord π A / P
  EXPECT_NEAR(path.fill_lines, path.sparse_mm / (std::numbers::pi * inner / 160), 1e-9);
}

TEST(Toolpath, SmallIslandsAndExposedLayersAreSolid) {
  const FdmSettings settings;
  const double sp = bead(settings, 0.2).spacing_mm;
  const LayerPath small = layer_path(settings, 0.2, square_layer(8), 0);
  EXPECT_EQ(small.sparse_mm, 0);
  EXPECT_NEAR(small.solid_mm, (64 - 1.5 * sp * 32) / sp, 1e-9);
  const LayerPath roof = layer_path(settings, 0.2, square_layer(40), 1600);
  EXPECT_EQ(roof.sparse_mm, 0);
  const LayerPath wall = layer_path(settings, 0.2, square_layer(0.5), 0);
  EXPECT_EQ(wall.total_mm(), wall.external_mm + wall.internal_mm);
}

TEST(Toolpath, HolesBelongToTheIslandAroundThem) {
  // a frame: its matter alone is filled, and it is thin enough to be solid
  const FdmSettings settings;
  Layer layer = square_layer(40);
  Contour hole{-36.0 * 36, 4 * 36, {}};
  hole.box.extend(Vec2(2, 2));
  hole.box.extend(Vec2(38, 38));
  layer.contours.push_back(hole);
  const double sp = bead(settings, 0.2).spacing_mm;
  const LayerPath path = layer_path(settings, 0.2, layer, 0);
  const double inner = 1600 - 1296 - 1.5 * sp * (160 + 144);
  EXPECT_NEAR((path.solid_mm + path.sparse_mm / settings.infill_fraction) * sp, inner, 1e-6);
}

TEST(Toolpath, TimeByHandAndStretchedWhereShort) {
  FdmSettings settings;  // 40 and 80 mm/s, 2000 mm/s², 15 mm/s, k 0.22, at least 12 s or 24 mm/s
  LayerPath path;
  path.external_mm = 4000;
  path.internal_mm = 8000;
  path.fill_lines = 100;
  EXPECT_NEAR(layer_time_s(settings, path), 1.22 * (100 + 100 + 100 * 65.0 * 65 / (80 * 2000)),
              1e-9);
  path = {};
  path.external_mm = 48;
  EXPECT_NEAR(layer_time_s(settings, path), 2, 1e-12);  // 24 mm/s
  path.external_mm = 400;  // 12.2 s at 40 mm/s and k: nothing to stretch
  EXPECT_NEAR(layer_time_s(settings, path), 12.2, 1e-12);
  path.external_mm = 320;  // 9.76 s, 13.3 s at 24 mm/s: stretched to 12
  EXPECT_NEAR(layer_time_s(settings, path), 12, 1e-12);
  settings.speed_mm_s = 10;  // slower than the jerk: no turn costs anything
  path = {};
  path.fill_lines = 7;
  EXPECT_EQ(layer_time_s(settings, path), 0);
}

TEST(Toolpath, ExposedAreas) {
  FdmSettings settings;  // 4 solid layers
  const Mesh cube = box(Vec3(0, 0, 0), Vec3(10, 10, 4));
  const std::vector<double> exposed = exposed_areas(settings, 0.2, {&cube}, 20);
  for (int layer = 0; layer < 20; ++layer)
    EXPECT_NEAR(exposed[layer], layer < 4 || layer >= 16 ? 100 : 0, 1e-9) << layer;
  // a slope that recedes by less than the shells within the depth asks for nothing
  const Mesh steep = printed::frustum(10, 9, 4, Vec3(20, 20, 0));
  const std::vector<double> slopes = exposed_areas(settings, 0.2, {&steep}, 20);
  EXPECT_NEAR(slopes[10], 0, 1e-9);
}

TEST(Toolpath, LevelFacetsAreBridged) {
  Profile profile = fixtures::plain_toolpath();
  const std::vector<Mesh> table{printed::table(40, 30, 4, 5, Vec3(10, 10, 0))};
  profile.fdm.level_support_fraction = 1;
  const Estimate held = of(profile, table);
  profile.fdm.level_support_fraction = 0;
  const Estimate bridged = of(profile, table);
  EXPECT_EQ(held.support_mm3, bridged.support_mm3);  // V_s stays V_s
  EXPECT_GT(held.support_g, 1);
  EXPECT_NEAR(bridged.support_g, 0, 1e-9);
  EXPECT_NEAR(held.time_s - bridged.time_s,
              support_time_s(profile.fdm, 0.2, (1600 - 100) * 26, 1500), 40);
}

TEST(Estimate, TraysAddUp) {
  for (const Profile& profile :
       {fixtures::plain_polyjet(), fixtures::plain_deposition(), fixtures::plain_toolpath()}) {
    const Tray a = tray_of({box(Vec3(5, 5, 4), Vec3(25, 30, 14))});
    const Tray b = tray_of({printed::resting_sphere(12, 3)});
    const Estimate both = estimate(profile, {a, b}, {3, 2}, Progress());
    const Estimate one = estimate(profile, {a}, {}, Progress());
    const Estimate other = estimate(profile, {b}, {}, Progress());
    EXPECT_NEAR(both.time_s, one.time_s + other.time_s, 1e-6);
    EXPECT_NEAR(both.model_g, one.model_g + other.model_g, 1e-9);
    EXPECT_NEAR(both.support_g, one.support_g + other.support_g, 1e-9);
    EXPECT_NEAR(both.support_mm3, one.support_mm3 + other.support_mm3, 1e-9);
    EXPECT_EQ(both.trays, 2);
    EXPECT_EQ(both.parts, 3);
  }
}

TEST(Estimate, BothTurnsAreThoseOfATurnedTray) {
  Pose quarter = Pose::Identity();
  quarter.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  for (const Profile& profile : {fixtures::plain_polyjet(), fixtures::plain_toolpath()}) {
    const Mesh part = box(Vec3(5, 5, 4), Vec3(25, 70, 14));
    Mesh turned = transformed(part, quarter);
    turned = printed::moved(turned, Vec3(80, 0, 0));
    const BothTurns both = estimate_both_turns(profile, {tray_of({part})}, Assembly{}, Progress());
    EXPECT_EQ(both.straight.time_s, of(profile, {part}).time_s);
    const Estimate told = both.turned, known = of(profile, {turned});
    EXPECT_NEAR(told.time_s, known.time_s, 1e-6 * known.time_s);
    EXPECT_NEAR(told.cost, known.cost, 1e-6 * known.cost);
    EXPECT_NEAR(told.support_mm3, known.support_mm3, 1e-3 * known.support_mm3);
  }
}

TEST(Estimate, NothingOnNoTray) {
  Profile profile = fixtures::plain_polyjet();
  const Estimate e = estimate(profile, {}, {0, 0}, Progress());
  EXPECT_EQ(e.time_s, 0);
  EXPECT_EQ(e.cost, 0);
}

TEST(Estimate, MaterialScalesWithTheCube) {
  for (const double scale : {0.5, 1.7, 3.0}) {
    for (const Profile& profile : {fixtures::plain_polyjet(), fixtures::plain_deposition()}) {
      const Mesh small = printed::resting_sphere(10, 3);
      const Mesh large = printed::scaled(small, scale);
      const Estimate a = of(profile, {small});
      const Estimate b = of(profile, {large});
      const double cube = scale * scale * scale;
      EXPECT_NEAR(b.model_g, a.model_g * cube, 1e-6 * b.model_g);
      EXPECT_NEAR(b.support_g, a.support_g * cube, 1e-3 * b.support_g);
      EXPECT_EQ(b.time_s > a.time_s, scale > 1);
    }
  }
}

TEST(Price, ByHand) {
  Profile profile;
  profile.cost = {.currency = "NOK",
                  .model_price_per_g = 2,
                  .support_price_per_g = 3,
                  .machine_price_per_h = 10,
                  .labour_price_per_h = 60,
                  .glue_min_per_joint = 1.5,
                  .clean_min_per_tray = 5};
  Estimate e;
  e.time_s = 1800;
  e.model_g = 7;
  e.support_g = 11;
  e.trays = 2;
  price(e, profile, {4, 6});
  EXPECT_EQ(e.parts, 4);
  EXPECT_DOUBLE_EQ(e.assembly_min, 9 + 10) << "gluing, and cleaning of two trays";
  EXPECT_DOUBLE_EQ(e.material_cost, 14 + 33);
  EXPECT_DOUBLE_EQ(e.machine_cost, 5);
  EXPECT_DOUBLE_EQ(e.hands_cost, 19);
  EXPECT_DOUBLE_EQ(e.cost, 14 + 33 + 5 + (9 + 10) * 1.0);
  EXPECT_EQ(e.currency, "NOK");
}

TEST(Estimate, RefusesAProfileItWouldDivideByZeroWith) {
  const auto fault_of = [](const Profile& profile) {
    try {
      of(profile, {box(Vec3(0, 0, 0), Vec3(1, 1, 1))});
    } catch (const Error& error) {
      EXPECT_FALSE(error.hint().empty());
      return error.fault();
    }
    return Fault::kInternal;
  };
  Profile profile = fixtures::plain_polyjet();
  profile.polyjet.swath_mm = 0;
  EXPECT_EQ(fault_of(profile), Fault::kBadProfile);
  profile = fixtures::plain_polyjet();
  profile.layer_mm = 0;
  EXPECT_EQ(fault_of(profile), Fault::kBadProfile);
  profile = fixtures::plain_deposition();
  profile.fdm.deposition_cm3_h = 0;
  EXPECT_EQ(fault_of(profile), Fault::kBadProfile);
  profile = fixtures::plain_toolpath();
  profile.fdm.speed_mm_s = -1;
  EXPECT_EQ(fault_of(profile), Fault::kBadProfile);
  profile = fixtures::plain_toolpath();
  profile.fdm.line_width_mm = 0.01;  // no bead of this layer is so narrow
  EXPECT_EQ(fault_of(profile), Fault::kBadProfile);
}

TEST(Estimate, CanBeInterrupted) {
  const std::atomic<bool> cancelled{true};
  EXPECT_THROW(estimate(fixtures::plain_polyjet(), {tray_of({printed::resting_sphere(5, 2)})}, {},
                        Progress({}, &cancelled)),
               Error);
}

}  // namespace
}  // namespace packmerger
