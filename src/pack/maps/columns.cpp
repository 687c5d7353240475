#include "pack/maps/columns.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace packmerger {
namespace {

// Vertical facets must not count as overhanging because of rounding.
constexpr double kNormalTolerance = 1e-6;

// Twice the signed area of (a, b, p). The same bits for (b, a, p) with the other sign, so that two
// triangles sharing an edge never both miss or both claim a line that passes through it.
double side(const Vec2& a, const Vec2& b, const Vec2& p) {
  const bool swapped = std::tie(b.x(), b.y()) < std::tie(a.x(), a.y());
  const Vec2& from = swapped ? b : a;
  const Vec2& to = swapped ? a : b;
  const double area =
      (to.x() - from.x()) * (p.y() - from.y()) - (to.y() - from.y()) * (p.x() - from.x());
  return swapped ? -area : area;
}

// Of a counter-clockwise triangle's edges, those that own the points exactly on them.
bool owns_its_points(const Vec2& a, const Vec2& b) {
  return a.y() > b.y() || (a.y() == b.y() && a.x() > b.x());
}

bool covers(const std::array<Vec2, 3>& corner, const Vec2& p) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec2& a = corner[i];
    const Vec2& b = corner[(i + 1) % 3];
    const double where = side(a, b, p);
    if (where < 0 || (where == 0 && !owns_its_points(a, b))) return false;
  }
  return true;
}

void add_crossings(const std::array<Vec3, 3>& corner, double step, double normal_limit, int surface,
                   std::vector<Crossing>& crossings) {
  const Vec3 normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
  if (normal.z() == 0) return;
  std::array<Vec2, 3> flat{corner[0].head<2>(), corner[1].head<2>(), corner[2].head<2>()};
  if (normal.z() < 0) std::swap(flat[1], flat[2]);
  const bool needs_support = normal.z() < normal_limit * normal.norm();
  const Vec2 low = flat[0].cwiseMin(flat[1]).cwiseMin(flat[2]) / step;
  const Vec2 high = flat[0].cwiseMax(flat[1]).cwiseMax(flat[2]) / step;
  for (int j = static_cast<int>(std::ceil(low.y() - 0.5)); j + 0.5 <= high.y(); ++j)
    for (int i = static_cast<int>(std::ceil(low.x() - 0.5)); i + 0.5 <= high.x(); ++i) {
      const Vec2 p((i + 0.5) * step, (j + 0.5) * step);
      if (!covers(flat, p)) continue;
      const Vec2 away = p - corner[0].head<2>();
      const double z = corner[0].z() - (normal.x() * away.x() + normal.y() * away.y()) / normal.z();
      crossings.push_back(
          {j, i, z, normal.z() < 0, needs_support, surface, -normal.head<2>() / normal.z()});
    }
}

}  // namespace

double support_normal_limit(double support_angle) {
  return -std::sin(support_angle) - kNormalTolerance;
}

std::vector<Crossing> sorted_crossings(const std::vector<Mesh>& surfaces, double step_mm,
                                       double support_angle) {
  const double limit = support_normal_limit(support_angle);
  std::vector<Crossing> crossings;
  for (std::size_t i = 0; i < surfaces.size(); ++i)
    for (const auto& [a, b, c] : surfaces[i].triangles())
      add_crossings({surfaces[i].points()[static_cast<std::size_t>(a)],
                     surfaces[i].points()[static_cast<std::size_t>(b)],
                     surfaces[i].points()[static_cast<std::size_t>(c)]},
                    step_mm, limit, static_cast<int>(i), crossings);
  // Of two crossings at one height the way out comes first: touching matter leaves no void.
  std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) {
    return std::tie(a.row, a.column, a.z, a.enters) < std::tie(b.row, b.column, b.z, b.enters);
  });
  return crossings;
}

void for_each_void(const std::vector<Crossing>& sorted, double plate_mm, const OnVoid& on_void) {
  for (std::size_t i = 0; i < sorted.size();) {
    const int row = sorted[i].row;
    const int column = sorted[i].column;
    const Crossing* floor = nullptr;
    int depth = 0;
    for (; i < sorted.size() && sorted[i].row == row && sorted[i].column == column; ++i) {
      const Crossing& crossing = sorted[i];
      const double height_mm = crossing.z - (floor != nullptr ? floor->z : plate_mm);
      if (crossing.enters && depth == 0 && crossing.needs_support && height_mm > 0)
        on_void(floor, crossing, height_mm);
      depth += crossing.enters ? 1 : -1;
      floor = &crossing;
    }
  }
}

ColumnSupport column_support(const std::vector<Mesh>& surfaces, double step_mm,
                             double support_angle, double plate_mm) {
  ColumnSupport lengths;
  for_each_void(sorted_crossings(surfaces, step_mm, support_angle), plate_mm,
                [&](const Crossing* floor, const Crossing&, double height_mm) {
                  (floor == nullptr ? lengths.below : lengths.inside) += height_mm;
                });
  const double cell = step_mm * step_mm;
  return {lengths.below * cell, lengths.inside * cell};
}

}  // namespace packmerger
