#include "pack/lattice/lattice.h"

#include <algorithm>
#include <cmath>

namespace packmerger {
namespace {

constexpr double kUnits = 62;        // of the limit
constexpr double kCellsAcross = 45;  // a part, on average
constexpr double kLeastCell_mm = 0.4;
constexpr double kMostCells = 40000;  // of the base

}  // namespace

BitGrid lattice_for(const std::vector<const Shape*>& shapes, const Vec2& base_mm, double apart_mm,
                    double limit_mm) {
  double across = 0;
  for (const Shape* shape : shapes) across += bounding_box(shape->mesh).sizes().maxCoeff();
  across /= static_cast<double>(shapes.size());
  BitGrid grid;
  grid.cell_mm =
      std::max({kLeastCell_mm, across / kCellsAcross, std::sqrt(base_mm.prod() / kMostCells)});
  grid.unit_mm = limit_mm / kUnits;
  const auto cells = [&](double length_mm) {
    return std::max(1, static_cast<int>(std::floor((length_mm + apart_mm) / grid.cell_mm + 1e-6)));
  };
  grid.columns = cells(base_mm.x());
  grid.rows = cells(base_mm.y());
  return grid;
}

HeightBits tray_with_walls(const BitGrid& grid, const Plate& plate, double apart_mm) {
  HeightBits tray(grid);
  if (plate.is_whole()) return tray;
  const double least_mm = kMatterReach * grid.cell_mm - apart_mm / 2;
  for (int y = 0; y < grid.rows; ++y)
    for (int x = 0; x < grid.columns; ++x) {
      const Vec2 centre = grid.cell_mm * Vec2(x + 0.5, y + 0.5) - Vec2::Constant(apart_mm / 2);
      if (plate.nearest_wall(centre).clearance_mm <= least_mm) tray.bar(x, y);
    }
  return tray;
}

}  // namespace packmerger
