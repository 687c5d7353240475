#include "pack/search/refine.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/parallel.h"

namespace packmerger {
namespace {

// The cells of `to` in which the part's corner lies within reach_mm of where it was.
Range window(int cell, double shift_from_mm, double shift_to_mm, double from_cell_mm,
             double to_cell_mm, double reach_mm) {
  // Both shifts place the same rotated model: the same place has equal cell · cell_mm + shift.
  const double at = (cell * from_cell_mm + shift_from_mm - shift_to_mm) / to_cell_mm;
  const double reach = reach_mm / to_cell_mm;
  if (std::isinf(reach)) return kAllCells;
  return {static_cast<int>(std::lround(at - reach)), static_cast<int>(std::lround(at + reach))};
}

using Rotations = std::map<const Part*, const RotatedPart*>;

Draft drafted(const Layout& layout, const Grid& from, const Grid& to, const Rotations& rotations,
              double reach_mm, bool stays_near) {
  Draft draft;
  for (const auto& tray : layout.trays) {
    Draft::Tray wanted;
    for (const Placed& placed : tray->placed) {
      const RotatedPart* was = placed.rotated;
      const RotatedPart* now = rotations.at(placed.part);
      if (!now) {
        wanted.tasks.push_back({placed.part});
        continue;
      }
      wanted.tasks.push_back(
          {placed.part, now,
           window(placed.x, was->shift.x(), now->shift.x(), from.cell_mm, to.cell_mm, reach_mm),
           window(placed.y, was->shift.y(), now->shift.y(), from.cell_mm, to.cell_mm, reach_mm),
           stays_near});
    }
    draft.trays.push_back(std::move(wanted));
  }
  return draft;
}

}  // namespace

Layout refined(const Layout& layout, const Grid& from, const Layouter& to, PartMaker& maker,
               const std::vector<double>& reaches_mm, bool stays_near) {
  Rotations rotations;  // nullptr where the part stands off the grid, or no longer fits
  for (const auto& tray : layout.trays)
    for (const Placed& placed : tray->placed)
      rotations[placed.part] = placed.rotated
                                   ? maker.rotated(*placed.part, placed.rotated->rotation,
                                                   placed.rotated->inside_support_mm3)
                                   : nullptr;
  const RotationChoice the_same = [&](const Part& part) {
    const RotatedPart* rotated = rotations.at(&part);
    return rotated ? std::vector{rotated} : std::vector<const RotatedPart*>{};
  };
  std::vector<Layout> layouts(reaches_mm.size());
  parallel_tasks(layouts.size(), [&](std::size_t i) {
    layouts[i] =
        *to.carried_out(drafted(layout, from, to.spec().grid, rotations, reaches_mm[i], stays_near),
                        the_same, std::numeric_limits<double>::infinity());
  });
  return *std::min_element(layouts.begin(), layouts.end(), is_better);
}

}  // namespace packmerger
