#include "pack/height_field.h"

#include <algorithm>
#include <cmath>

#include "pack/kernel.h"

namespace packmerger {
namespace {

// Coarse positions are rounded outwards, and parts' blocks stand out over the part.
constexpr int kCoarseBorder = 4;

int cells_along(double length_mm, double grid_mm) {
  return std::max(1, static_cast<int>(std::ceil(length_mm / grid_mm - 1e-7)));
}

int blocks_along(int cells, int coarse) { return (cells + coarse - 1) / coarse; }

}  // namespace

CellField::CellField(int width, int height, int border, float empty)
    : width_(width),
      height_(height),
      border_(border),
      stride_(width + 2 * border),
      values_(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(height + 2 * border) +
                  kReadAhead,
              empty) {}

HeightField::HeightField(const Vec3& build_mm, double grid_mm, int block, int growth)
    : coarse(block),
      upper(cells_along(build_mm.x(), grid_mm), cells_along(build_mm.y(), grid_mm), growth + 1,
            kBarePlate),
      surface(upper.width(), upper.height(), growth + 1, 0),
      coarse_upper(blocks_along(upper.width(), block), blocks_along(upper.height(), block),
                   kCoarseBorder + growth / block, kBarePlate),
      coarse_surface(coarse_upper.width(), coarse_upper.height(), kCoarseBorder + growth / block,
                     0) {}

void HeightField::add(const RotatedPart& part, int x, int y, double z) {
  const float lift = static_cast<float>(z);
  int x0 = upper.width();
  int x1 = -1;
  int y0 = upper.height();
  int y1 = -1;
  for (const MapCell& cell : part.top) {
    const int column = x + cell.x;
    const int row = y + cell.y;
    float& height = upper.at(column, row);
    height = std::max(height, lift + cell.value);
    x0 = std::min(x0, column);
    x1 = std::max(x1, column);
    y0 = std::min(y0, row);
    y1 = std::max(y1, row);
  }
  for (const MapCell& cell : part.roof) {
    float& height = surface.at(x + cell.x, y + cell.y);
    height = std::max(height, lift + cell.value);
  }
  const float share = 1.0F / static_cast<float>(coarse * coarse);
  for (int row = y0 / coarse; row <= y1 / coarse; ++row)
    for (int column = x0 / coarse; column <= x1 / coarse; ++column) {
      float highest = kBarePlate;
      float sum = 0;
      for (int j = row * coarse; j < std::min((row + 1) * coarse, upper.height()); ++j)
        for (int i = column * coarse; i < std::min((column + 1) * coarse, upper.width()); ++i) {
          highest = std::max(highest, upper.at(i, j));
          sum += surface.at(i, j);
        }
      coarse_upper.at(column, row) = highest;
      coarse_surface.at(column, row) = sum * share;
    }
}

TrayMeasure TrayState::measure() const {
  if (parts == 0) return {};
  Vec3 size = contents.sizes();
  size.z() = contents.max().z();
  return {size, support_mm3, material_mm3, parts};
}

}  // namespace packmerger
