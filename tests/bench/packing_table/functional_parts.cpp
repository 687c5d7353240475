#include "bench/packing_table/functional_parts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "base/random.h"
#include "bench/packing_table/solids.h"
#include "fixtures/block_solid.h"

namespace packmerger::bench {
namespace {

constexpr int kKinds = 8;

class Drawn {
 public:
  explicit Drawn(std::uint64_t seed) : random_(seed) {}

  double between(double least, double most) { return least + (most - least) * random_.unit(); }
  int count(int least, int most) {
    return least + static_cast<int>(random_.below(static_cast<std::size_t>(most - least + 1)));
  }

 private:
  Random random_;
};

// An L with a square hole through each leg.
Mesh bracket(Drawn& drawn) {
  const double leg = drawn.between(20, 46), other = drawn.between(18, 40);
  const double thick = drawn.between(3, 5), width = drawn.between(16, 30);
  const double hole = width / 4;
  const auto along = [&](double length) {
    const double middle = (thick + length) / 2;
    return std::vector<double>{0, thick, middle - hole / 2, middle + hole / 2, length};
  };
  return closed_mesh(fixtures::block_solid(along(leg),
                                           {0, (width - hole) / 2, (width + hole) / 2, width},
                                           along(other), [](int i, int j, int k) {
                                             if (i > 0 && k > 0) return false;
                                             return j != 1 || (i != 2 && k != 2);
                                           }));
}

// A U, open upwards.
Mesh channel(Drawn& drawn) {
  const double width = drawn.between(16, 32), leg = drawn.between(14, 28);
  const double thick = drawn.between(2.5, 4);
  return closed_mesh(fixtures::block_solid({0, thick, width - thick, width},
                                           {0, drawn.between(24, 52)}, {0, thick, leg},
                                           [](int i, int, int k) { return i != 1 || k == 0; }));
}

Mesh gear(Drawn& drawn) {
  const int teeth = drawn.count(10, 18);
  const double outer = drawn.between(9, 22);
  std::vector<Vec2> outline = circle(outer, 4 * teeth);
  for (std::size_t i = 0; i < outline.size(); ++i)
    if (i % 4 >= 2) outline[i] *= 1 - 2.2 / teeth;
  const double thick = drawn.between(5, 10);
  return prism(between(outline, circle(drawn.between(0.2, 0.35) * outer, 4 * teeth), true), thick);
}

Mesh tube(Drawn& drawn) {
  constexpr int kSides = 32;
  const double radius = drawn.between(7, 17);
  const double wall = drawn.between(2, 3.5);
  return prism(between(circle(radius, kSides), circle(radius - wall, kSides), true),
               drawn.between(18, 52));
}

struct BoxSize {
  double x, y, z, wall;
};

// Opens upwards.
Mesh open_box(const BoxSize& size) {
  return closed_mesh(fixtures::block_solid(
      {0, size.wall, size.x - size.wall, size.x}, {0, size.wall, size.y - size.wall, size.y},
      {0, size.wall, size.z}, [](int i, int j, int k) { return k == 0 || i != 1 || j != 1; }));
}

// A plate with a rim that goes into the box.
Mesh lid(const BoxSize& size) {
  constexpr double kPlay_mm = 0.3;
  constexpr double kRim_mm = 4;
  const auto lines = [&](double length) {
    const double first = size.wall + kPlay_mm;
    const double second = first + size.wall;
    return std::vector<double>{0, first, second, length - second, length - first, length};
  };
  const auto is_rim = [](int i, int j) {
    const bool inner = i == 2 && j == 2;
    return i >= 1 && i <= 3 && j >= 1 && j <= 3 && !inner;
  };
  return closed_mesh(
      fixtures::block_solid(lines(size.x), lines(size.y), {0, size.wall, size.wall + kRim_mm},
                            [&](int i, int j, int k) { return k == 0 || is_rim(i, j); }));
}

// A straight shank that goes on in an arc.
Mesh hook(Drawn& drawn) {
  constexpr int kSteps = 20;
  const double radius = drawn.between(7, 13), half = drawn.between(2, 3.2);
  const double shank = drawn.between(14, 26), turn = radians(drawn.between(180, 240));
  std::vector<Vec2> outer{Vec2(radius + half, shank)};
  std::vector<Vec2> inner{Vec2(radius - half, shank)};
  for (int i = 0; i <= kSteps; ++i) {
    const double angle = -turn * i / kSteps;
    const Vec2 out(std::cos(angle), std::sin(angle));
    outer.emplace_back((radius + half) * out);
    inner.emplace_back((radius - half) * out);
  }
  // it runs clockwise round its centre, so the outer curve lies to the left
  return prism(between(inner, outer, false), drawn.between(5, 12));
}

// A plate of square fields with a round hole in each.
Mesh hole_plate(Drawn& drawn) {
  constexpr int kOnSide = 4;
  const int columns = drawn.count(2, 4), rows = drawn.count(2, 3);
  const double field = drawn.between(9, 13.5), radius = field * drawn.between(0.25, 0.36);
  FlatFigure plate;
  std::map<std::pair<int, int>, int> shared;  // points on the fields' borders, in quarters of one
  const auto border_point = [&](int x, int y) {
    const auto [at, is_new] =
        shared.emplace(std::pair(x, y), static_cast<int>(plate.points.size()));
    if (is_new) plate.points.emplace_back(Vec2(x, y) * (field / kOnSide));
    return at->second;
  };
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const Vec2 centre = Vec2(column + 0.5, row + 0.5) * field;
      std::vector<int> outer, inner;
      const auto corner = [&](int x, int y) {
        outer.push_back(border_point(column * kOnSide + x, row * kOnSide + y));
        const Vec2 out =
            (plate.points[static_cast<std::size_t>(outer.back())] - centre).normalized();
        inner.push_back(static_cast<int>(plate.points.size()));
        plate.points.emplace_back(centre + radius * out);
      };
      for (int i = 0; i < kOnSide; ++i) corner(i, 0);
      for (int i = 0; i < kOnSide; ++i) corner(kOnSide, i);
      for (int i = 0; i < kOnSide; ++i) corner(kOnSide - i, kOnSide);
      for (int i = 0; i < kOnSide; ++i) corner(0, kOnSide - i);
      for (std::size_t i = 0; i < outer.size(); ++i) {
        const std::size_t next = (i + 1) % outer.size();
        plate.triangles.push_back({outer[i], outer[next], inner[next]});
        plate.triangles.push_back({outer[i], inner[next], inner[i]});
      }
    }
  return prism(plate, drawn.between(3, 6));
}

std::vector<Mesh> drawn_parts(Drawn& drawn) {
  std::vector<Mesh> parts;
  BoxSize box{};
  for (int i = 0; i < kFunctionalParts; ++i) switch (i % kKinds) {
      case 0:
        parts.push_back(bracket(drawn));
        break;
      case 1:
        parts.push_back(channel(drawn));
        break;
      case 2:
        parts.push_back(gear(drawn));
        break;
      case 3:
        parts.push_back(tube(drawn));
        break;
      case 4:
        box.x = drawn.between(24, 46);
        box.y = drawn.between(18, 34);
        box.z = drawn.between(12, 26);
        box.wall = drawn.between(1.8, 2.6);
        parts.push_back(open_box(box));
        break;
      case 5:
        parts.push_back(lid(box));
        break;
      case 6:
        parts.push_back(hook(drawn));
        break;
      default:
        parts.push_back(hole_plate(drawn));
    }
  return parts;
}

}  // namespace

std::vector<PackItem> functional_items(std::uint64_t seed) {
  Drawn drawn(seed);
  const std::vector<Mesh> parts = drawn_parts(drawn);
  double volume = 0;
  for (const Mesh& part : parts) volume += volume_mm3(part);
  const double scale = std::cbrt(kFunctionalVolume_mm3 / volume);
  std::vector<PackItem> items;
  for (const Mesh& part : parts) {
    PackItem item;
    item.surface = scaled(part, scale);
    item.volume_mm3 = volume_mm3(item.surface);
    item.model = static_cast<int>(items.size());
    items.push_back(std::move(item));
  }
  return items;
}

}  // namespace packmerger::bench
