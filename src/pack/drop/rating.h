// What the positions of one part in one rotation cost over one tray.
#pragma once

#include <algorithm>
#include <cstdint>

#include "pack/drop/tray_state.h"

namespace packmerger {

// x, y: cells; z: units; waste: units summed over the cells.
class Rating {
 public:
  Rating(const TrayState& tray, const RotatedPart& part, double volume_mm3, const TraySpec& spec)
      : part_(part), spec_(spec), contents_(tray.contents) {
    before_ = tray.measure();
    before_.support_mm3 += part.inside_support_mm3;
    before_.material_mm3 += volume_mm3;
    before_.parts += 1;
  }

  double cost(int x, int y, Height z, std::int64_t waste) const {
    return spec_.cost->evaluate(measure(x, y, z, waste));
  }
  // No cost at this position is less, however it falls there.
  double bound(int x, int y, Height z, std::int64_t waste) const {
    return spec_.cost->lower_bound(measure(x, y, z, waste));
  }

  double waste_mm3(std::int64_t waste) const {
    return static_cast<double>(std::max<std::int64_t>(0, waste)) *
           (spec_.grid.cell_mm * spec_.grid.cell_mm * spec_.grid.unit_mm);
  }

  // The waste where the part's cells that need support hang over a horizon of this sum.
  std::int64_t waste(Height z, std::int64_t horizon) const {
    return static_cast<std::int64_t>(part_.hang.size()) * z + part_.hang_sum - horizon;
  }

 private:
  TrayMeasure measure(int x, int y, Height z, std::int64_t waste) const {
    const Vec3 at(x * spec_.grid.cell_mm, y * spec_.grid.cell_mm, z * spec_.grid.unit_mm);
    TrayMeasure measure = before_;
    measure.size_mm = size_with(contents_, part_.box, at);
    measure.support_mm3 += waste_mm3(waste);
    return measure;
  }

  const RotatedPart& part_;
  const TraySpec& spec_;
  TrayMeasure before_;
  const Box3& contents_;
};

}  // namespace packmerger
