// V_s, the support volume of the paper's section 3, taken as matter: along every vertical line the
// empty lengths below a facet that needs support, down to the first matter below (another part or
// the same one) or the tray, inner cavities included.
//
// A second estimator beside the packer's: it reads the meshes themselves along a regular set of
// vertical lines and knows no height field. Corners are first rounded in x and y to 2^-28 of the
// contents' extent (about a nanometre on a tray), so that which facets a line meets is decided in
// whole numbers: lines through edges and corners need no special case, and a closed mesh is always
// entered as often as it is left.
#pragma once

#include <functional>
#include <vector>

#include "model/mesh.h"

namespace packmerger {

struct SupportMeasure {
  double volume_mm3 = 0;     // V_s
  double interface_mm2 = 0;  // where support touches the facets it holds, seen from above
  // Of these, what lies below level facets: many slicers bridge those instead.
  double level_volume_mm3 = 0;
  double level_interface_mm2 = 0;
};

// parts: closed meshes in tray coordinates (mm, z = 0 the plate); they may touch,
// overlap and hold cavities: matter is their union. What lies below the plate counts for nothing.
// support_angle: radians in [0, π/2]; a facet needs support when its normal points down by more
// than this below the horizontal (0: every down-facing facet; a facet at the angle itself needs
// none). About a million lines are read: a sphere is right within 0.01 %.
// Deterministic on any number of threads.
SupportMeasure support_measure(const std::vector<const Mesh*>& parts, double support_angle);

// V_s alone.
double support_volume_mm3(const std::vector<const Mesh*>& parts, double support_angle);

// Whether a facet with this normal (any length) needs support.
bool needs_support(const Vec3& normal, double support_angle);

// One empty length below a facet that needs support.
struct SupportSpan {
  int column = 0;      // of the grid
  double low_mm = 0;   // z of the matter or the tray below
  double high_mm = 0;  // z of the facet above; high_mm > low_mm
  bool level = false;  // that facet lies within 5° of the horizontal
};

// The box of the contents seen from above, divided into equal, nearly square cells; one vertical
// line stands in the middle of each.
struct SupportGrid {
  Vec2 low = Vec2::Zero();      // the box's corner, mm
  Vec2 cell_mm = Vec2::Zero();  // column c covers low.x + cell_mm.x · [c, c + 1], rows likewise
  int columns = 0;
  int rows = 0;
};

// The grid of about `lines` lines that just covers the parts. No rows and columns when there is
// nothing to cover.
SupportGrid support_grid(const std::vector<const Mesh*>& parts, int lines);

// Calls visit(row, spans) once for each row, from any thread and in any order; spans are sorted by
// column, then height. grid: as support_grid() made it for these parts.
void for_each_support_row(
    const std::vector<const Mesh*>& parts, const SupportGrid& grid, double support_angle,
    const std::function<void(int row, const std::vector<SupportSpan>& spans)>& visit);

}  // namespace packmerger
