#include "pack/drop/tray_state.h"

#include <algorithm>

#include "pack/drop/fall.h"

namespace packmerger {
HeightField::HeightField(int width, int height, int border, Height empty)
    : border_(border),
      stride_(width + 2 * border),
      rows_(height + 2 * border),
      values_(static_cast<std::size_t>(stride_) * static_cast<std::size_t>(rows_) + kFallReadAhead,
              empty) {}

TrayState::TrayState(const TraySpec& spec)
    : upper(spec.columns(), spec.rows(), spec.grid.growth() + 1, kBarePlate),
      surface(spec.columns(), spec.rows(), spec.grid.growth() + 1, 0) {}

void TrayState::put(const RotatedPart& part, int x, int y, Height z, double added_mm3,
                    double volume_mm3, const TraySpec& spec) {
  for (const HeightCell& cell : part.top) {
    Height& height = upper.at(x + cell.x, y + cell.y);
    height = std::max(height, static_cast<Height>(z + cell.value));
  }
  for (const HeightCell& cell : part.roof) {
    Height& height = surface.at(x + cell.x, y + cell.y);
    height = std::max(height, static_cast<Height>(z + cell.value));
  }
  const Vec3 at(x * spec.grid.cell_mm, y * spec.grid.cell_mm, z * spec.grid.unit_mm);
  contents.extend(Vec3(part.box.min() + at));
  contents.extend(Vec3(part.box.max() + at));
  support_mm3 += added_mm3;
  material_mm3 += volume_mm3;
  ++parts;
}

TrayMeasure TrayState::measure() const {
  if (parts == 0) return {};
  const Vec3 size = contents.sizes();
  return {Vec3(size.x(), size.y(), contents.max().z()), support_mm3, material_mm3, parts};
}

}  // namespace packmerger
