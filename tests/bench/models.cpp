#include "bench/models.h"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/error.h"
#include "bench/balls_and_sticks.h"
#include "fixtures/models.h"
#include "unit/pack/shapes.h"
#include "unit/printers/shapes.h"

namespace packmerger::bench {
namespace {

constexpr int kRoundSides = 64;
constexpr int kArchStations = 48;  // of the half ring

TriangleSoup moved(TriangleSoup soup, const Pose& pose) {
  for (Vec3& point : soup.points) point = pose * point;
  return soup;
}

TriangleSoup on_the_plate(TriangleSoup soup) {
  Box3 box;
  for (const Vec3& point : soup.points) box.extend(point);
  return moved(std::move(soup), Pose(Eigen::Translation3d(0, 0, -box.min().z())));
}

TriangleSoup cup(const RoundSize& size) {
  const auto [r, h] = size;
  return to_soup(shapes::cup(r, h, kCupWall_mm, kRoundSides));
}

TriangleSoup crystal(const RoundSize& size) {
  constexpr double kFoot = 0.2;  // of the radius
  const auto [r, h] = size;
  return to_soup(shapes::revolved({{0, 0}, {kFoot * r, 0}, {r, h / 2}, {0, h}}, 8));
}

}  // namespace

Mesh sphere_model() {
  return closed_mesh(on_the_plate(fixtures::sphere(kSphereDiameter_mm / 2, 5)));
}

Mesh arch_model() {
  const double outer = kArchWidth_mm / 2;
  const double inner = outer - kArchRib_mm;
  const double spring = kArchHeight_mm - outer;  // where the legs end and the half ring begins
  struct Station {
    double x, z, drop;  // of the ring's middle plane: direction from the centre, and how far down
  };
  std::vector<Station> stations{{1, 0, spring}};
  for (int i = 0; i <= kArchStations; ++i) {
    const double angle = std::numbers::pi * i / kArchStations;
    stations.push_back({std::cos(angle), std::sin(angle), 0});
  }
  stations.push_back({-1, 0, spring});

  TriangleSoup soup;
  for (const auto& [x, z, drop] : stations)
    for (const auto& [radius, y] :
         {std::pair{inner, 0.0}, std::pair{outer, 0.0}, std::pair{outer, kArchDepth_mm},
          std::pair{inner, kArchDepth_mm}})
      soup.points.emplace_back(radius * x, y, radius * z + spring - drop);
  const auto last = static_cast<int>(stations.size()) - 1;
  for (int station = 0; station < last; ++station)
    for (int corner = 0; corner < 4; ++corner) {
      const int a = 4 * station + corner, b = 4 * station + (corner + 1) % 4;
      soup.triangles.push_back({a, b, b + 4});
      soup.triangles.push_back({a, b + 4, a + 4});
    }
  soup.triangles.push_back({0, 2, 1});
  soup.triangles.push_back({0, 3, 2});
  soup.triangles.push_back({4 * last, 4 * last + 1, 4 * last + 2});
  soup.triangles.push_back({4 * last, 4 * last + 2, 4 * last + 3});
  return closed_mesh(soup);
}

Mesh molecule_model() {
  // A methyl's hydrogens stand 120° apart round y, one of them on top, and point a third of a
  // stick's length outwards. The height gives the length of their sticks, the depth that of the
  // carbons'.
  const double round = 2 * std::numbers::sqrt2 / 3;
  const double to_hydrogen = (kMoleculeHeight_mm - 2 * kHydrogenRadius_mm) / (1.5 * round);
  const double to_carbon = kMoleculeDepth_mm / 2 - kHydrogenRadius_mm - to_hydrogen / 3;
  std::vector<Ball> balls{{Vec3::Zero(), kZincRadius_mm}};
  std::vector<Stick> sticks;
  for (const double side : {-1.0, 1.0}) {
    const auto carbon = static_cast<int>(balls.size());
    balls.push_back({Vec3(0, side * to_carbon, 0), kCarbonRadius_mm});
    sticks.push_back({0, carbon});
    for (int i = 0; i < 3; ++i) {
      const double angle = radians(90 + 120 * i);
      const Vec3 way(round * std::cos(angle), side / 3, round * std::sin(angle));
      sticks.push_back({carbon, static_cast<int>(balls.size())});
      balls.push_back({balls[carbon].centre + to_hydrogen * way, kHydrogenRadius_mm});
    }
  }
  constexpr double kSpacing_mm = 2;
  return closed_mesh(on_the_plate(balls_and_sticks(balls, sticks, kStickRadius_mm, kSpacing_mm)));
}

Mesh table_model() {
  return printed::table(kTableSide_mm, kTableHeight_mm, kTableTop_mm, kTableLeg_mm, Vec3::Zero());
}

std::vector<Mesh> group_models(double scale) {
  std::vector<Mesh> group;
  for (TriangleSoup& piece :
       std::array{cup(kLargeCup), cup(kSmallCup), crystal(kLargeCrystal), crystal(kSmallCrystal)}) {
    for (Vec3& point : piece.points) point *= scale;
    group.push_back(closed_mesh(piece));
  }
  return group;
}

Mesh bunny_model() {
  auto soup = fixtures::load_test_model("bunny");
  if (!soup)
    throw Error(Fault::kUnavailable, "The npm package \"bunny\" is not installed",
                "Run npm ci in the project's folder.");
  for (Vec3& point : soup->points) point = Vec3(point.x(), -point.z(), point.y());
  return closed_mesh(fixtures::scaled_to(std::move(*soup), kBunnyLongest_mm));
}

}  // namespace packmerger::bench
