#include "bench/packing_table/hull_part.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "fixtures/block_solid.h"

namespace packmerger::bench {
namespace {

constexpr double kLength_mm = 60, kWidth_mm = 31;
constexpr double kSheer_mm = 16;  // height of the hull's edge
constexpr double kBow_mm = 36;    // from here on the hull narrows

// Lines of the grid. Every wall, the window and the door begin and end at one of them.
const std::vector<double> kAlong{0,  2.5, 8,    14, 16.5, 21, 25,   28,
                                 34, 36,  38.5, 44, 49,   54, 57.5, 60};
const std::vector<double> kAcross{0, 2.5, 6, 8.5, 12, 19, 22.5, 25, 28.5, 31};
const std::vector<double> kUp{0, 2.5, 4.5, 10, 16, 22, 31, 33.1, 37.5, 48};

// Between two lines of the grid.
bool within(const std::vector<double>& lines, int cell, double from, double to) {
  const auto at = static_cast<std::size_t>(cell);
  return lines[at] >= from && lines[at + 1] <= to;
}

struct Room {
  double x0, x1, y0, y1, z0, z1;
};

constexpr Room kHull{0, 60, 0, 31, 0, 16};
constexpr Room kHold{2.5, 57.5, 2.5, 28.5, 4.5, 16};
constexpr Room kCabin{14, 38.5, 6, 25, 4.5, 37.5};
constexpr Room kInside{16.5, 36, 8.5, 22.5, 4.5, 33.1};
constexpr Room kWindow{21, 34, 6, 25, 22, 31};
constexpr Room kDoor{14, 16.5, 12, 19, 4.5, 31};
constexpr Room kChimney{21, 28, 12, 19, 37.5, 48};

bool is_in(const Room& room, int i, int j, int k) {
  return within(kAlong, i, room.x0, room.x1) && within(kAcross, j, room.y0, room.y1) &&
         within(kUp, k, room.z0, room.z1);
}

bool is_matter(int i, int j, int k) {
  const auto in = [&](const Room& room) { return is_in(room, i, j, k); };
  if (in(kChimney)) return true;
  if (in(kCabin)) return !in(kInside) && !in(kWindow) && !in(kDoor);
  return in(kHull) && !in(kHold);
}

Vec3 boat_like(const Vec3& point) {
  const double towards_bow = std::max(0.0, point.x() - kBow_mm) / (kLength_mm - kBow_mm);
  const double above_keel = std::min(1.0, point.z() / kSheer_mm);
  const double wide = (1 - 0.8 * towards_bow * towards_bow) * (0.65 + 0.35 * above_keel);
  return {point.x(), kWidth_mm / 2 + wide * (point.y() - kWidth_mm / 2), point.z()};
}

}  // namespace

Mesh hull_part() {
  return closed_mesh(fixtures::block_solid(kAlong, kAcross, kUp, is_matter, boat_like));
}

}  // namespace packmerger::bench
