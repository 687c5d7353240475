#include "pack/anywhere/solid_part.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include "pack/maps/columns.h"

namespace packmerger {
namespace {

// In cells: what reaches less far into a cell than this does not count as being in it, so that a
// box on the grid keeps to its cells.
constexpr double kCellTolerance = 1e-7;
constexpr double kRounding_units = 1e-6;

// The heights of one facet over one cell, mm.
struct Extent {
  int row;
  int column;
  double low;
  double high;
};

// A convex piece of a facet, x and y in cells. Clipped by four lines it has seven corners, or some
// more where rounding makes a sliver wind about a line.
struct Piece {
  std::array<Vec3, 16> corner;
  std::size_t count = 0;

  void add(const Vec3& point) { corner[count++] = point; }
};

// What of a piece lies on the side of a line on which sign · coordinate >= sign · limit.
Piece clipped(const Piece& piece, int axis, double limit, double sign) {
  Piece rest;
  for (std::size_t i = 0; i < piece.count; ++i) {
    const Vec3& from = piece.corner[i];
    const Vec3& to = piece.corner[(i + 1) % piece.count];
    const double inside = sign * (from[axis] - limit);
    const double next = sign * (to[axis] - limit);
    if (inside >= 0) rest.add(from);
    if ((inside > 0 && next < 0) || (inside < 0 && next > 0)) {
      rest.add(from + (to - from) * (inside / (inside - next)));
      rest.corner[rest.count - 1][axis] = limit;
    }
  }
  return rest;
}

int first_cell(double low) { return static_cast<int>(std::floor(low + kCellTolerance)); }
int last_cell(double high) { return static_cast<int>(std::ceil(high - kCellTolerance)) - 1; }

std::pair<double, double> limits(const Piece& piece, int axis) {
  double low = piece.corner[0][axis];
  double high = low;
  for (std::size_t i = 1; i < piece.count; ++i) {
    low = std::min(low, piece.corner[i][axis]);
    high = std::max(high, piece.corner[i][axis]);
  }
  return {low, high};
}

void add_extents(const Piece& facet, std::vector<Extent>& extents) {
  const auto [low_y, high_y] = limits(facet, 1);
  const int last_row = last_cell(high_y);
  for (int row = first_cell(low_y); row <= last_row; ++row) {
    const Piece strip = clipped(clipped(facet, 1, row, 1), 1, row + 1, -1);
    if (strip.count == 0) continue;
    const auto [low_x, high_x] = limits(strip, 0);
    const int first_column = first_cell(low_x);
    const int last_column = last_cell(high_x);
    for (int column = first_column; column <= last_column; ++column) {
      const Piece piece = first_column == last_column
                              ? strip
                              : clipped(clipped(strip, 0, column, 1), 0, column + 1, -1);
      if (piece.count == 0) continue;
      const auto [low, high] = limits(piece, 2);
      extents.push_back({row, column, low, high});
    }
  }
}

std::vector<Extent> sorted_extents(const std::vector<Mesh>& surfaces, double cell_mm) {
  std::vector<Extent> extents;
  for (const Mesh& surface : surfaces)
    for (const auto& triangle : surface.triangles()) {
      Piece facet;
      for (const int index : triangle) {
        const Vec3& point = surface.points()[static_cast<std::size_t>(index)];
        facet.add(Vec3(point.x() / cell_mm, point.y() / cell_mm, point.z()));
      }
      add_extents(facet, extents);
    }
  std::sort(extents.begin(), extents.end(), [](const Extent& a, const Extent& b) {
    return std::tie(a.row, a.column, a.low, a.high) < std::tie(b.row, b.column, b.low, b.high);
  });
  return extents;
}

SpanCell span_cell(int x, int y, double low, double high, bool hangs) {
  return {static_cast<std::int16_t>(x), static_cast<std::int16_t>(y), static_cast<Height>(low),
          static_cast<Height>(high), hangs};
}

// Heights at which no facet passes a cell are all matter or all empty there, and the line through
// the centre tells which.
std::vector<SpanCell> bounds(const std::vector<Extent>& extents,
                             const std::vector<Crossing>& crossings, double unit_mm) {
  std::vector<SpanCell> spans;
  std::size_t crossing = 0;
  for (std::size_t i = 0; i < extents.size();) {
    const int row = extents[i].row;
    const int column = extents[i].column;
    const auto before = [&](const Crossing& c) {
      return std::tie(c.row, c.column) < std::tie(row, column);
    };
    while (crossing < crossings.size() && before(crossings[crossing])) ++crossing;
    int depth = 0;
    double low = extents[i].low;
    double high = extents[i].high;
    const auto end_span = [&] {
      const double from = std::floor(low / unit_mm + kRounding_units);
      const double to = std::ceil(high / unit_mm - kRounding_units);
      if (!spans.empty() && spans.back().x == column && spans.back().y == row &&
          spans.back().high >= from)
        spans.back().high = std::max(spans.back().high, static_cast<Height>(to));
      else
        spans.push_back(span_cell(column, row, from, to, false));
    };
    for (; i < extents.size() && extents[i].row == row && extents[i].column == column; ++i) {
      if (extents[i].low > high) {
        const double middle = (high + extents[i].low) / 2;
        for (; crossing < crossings.size() && crossings[crossing].row == row &&
               crossings[crossing].column == column && crossings[crossing].z < middle;
             ++crossing)
          depth += crossings[crossing].enters ? 1 : -1;
        if (depth <= 0) {
          end_span();
          low = extents[i].low;
        }
      }
      high = std::max(high, extents[i].high);
    }
    end_span();
  }
  return spans;
}

std::vector<SpanCell> samples(const std::vector<Crossing>& crossings, double unit_mm) {
  std::vector<SpanCell> spans;
  int depth = 0;
  double low = 0;
  bool hangs = false;
  for (std::size_t i = 0; i < crossings.size(); ++i) {
    const Crossing& crossing = crossings[i];
    if (i == 0 || crossing.row != crossings[i - 1].row ||
        crossing.column != crossings[i - 1].column)
      depth = 0;
    if (crossing.enters && depth++ == 0) {
      low = crossing.z;
      hangs = crossing.needs_support;
      // Where two pieces of one part touch, matter goes on.
      if (!spans.empty() && spans.back().x == crossing.column && spans.back().y == crossing.row &&
          spans.back().high >= std::round(low / unit_mm)) {
        low = spans.back().low * unit_mm;
        hangs = spans.back().hangs;
        spans.pop_back();
      }
    } else if (!crossing.enters && --depth == 0) {
      spans.push_back(span_cell(crossing.column, crossing.row, std::round(low / unit_mm),
                                std::round(crossing.z / unit_mm), hangs));
    }
  }
  return spans;
}

// Joins what touches or overlaps; sorted by low.
void merge_spans(std::vector<SpanCell>& spans) {
  std::sort(spans.begin(), spans.end(),
            [](const SpanCell& a, const SpanCell& b) { return a.low < b.low; });
  std::size_t kept = 0;
  for (std::size_t i = 1; i < spans.size(); ++i) {
    if (spans[i].low <= spans[kept].high)
      spans[kept].high = std::max(spans[kept].high, spans[i].high);
    else
      spans[++kept] = spans[i];
  }
  spans.resize(spans.empty() ? 0 : kept + 1);
}

Outline outline_of(const std::vector<SpanCell>& cells) {
  Outline outline;
  if (cells.empty()) return outline;
  const auto [left, right] = std::minmax_element(
      cells.begin(), cells.end(), [](const SpanCell& a, const SpanCell& b) { return a.x < b.x; });
  outline.x0 = left->x;
  outline.y0 = cells.front().y;
  outline.width = right->x - left->x + 1;
  outline.height = cells.back().y - cells.front().y + 1;
  const auto count =
      static_cast<std::size_t>(outline.width) * static_cast<std::size_t>(outline.height);
  outline.low.assign(count, std::numeric_limits<Height>::max());
  outline.top.assign(count, std::numeric_limits<Height>::min());
  for (const SpanCell& cell : cells) {
    const auto at =
        static_cast<std::size_t>((cell.y - outline.y0) * outline.width + cell.x - outline.x0);
    outline.low[at] = std::min(outline.low[at], cell.low);
    outline.top[at] = std::max(outline.top[at], cell.high);
  }
  return outline;
}

}  // namespace

std::vector<SpanCell> grown(const std::vector<SpanCell>& cells, const SolidGrid& grid,
                            double radius_mm) {
  if (radius_mm <= 0 || cells.empty()) return cells;
  const int growth = static_cast<int>(std::ceil(radius_mm / grid.cell_mm));
  const auto [left, right] = std::minmax_element(
      cells.begin(), cells.end(), [](const SpanCell& a, const SpanCell& b) { return a.x < b.x; });
  const int x0 = left->x - growth;
  const int y0 = cells.front().y - growth;
  const int width = right->x + growth - x0 + 1;
  const int height = cells.back().y + growth - y0 + 1;
  std::vector<std::vector<SpanCell>> columns(static_cast<std::size_t>(width * height));
  for (int dy = -growth; dy <= growth; ++dy)
    for (int dx = -growth; dx <= growth; ++dx) {
      const double distance = std::hypot(apart_mm(dx, grid.cell_mm, grid.bounds),
                                         apart_mm(dy, grid.cell_mm, grid.bounds));
      if ((dx != 0 || dy != 0) && distance >= radius_mm) continue;
      const double reach = std::sqrt(radius_mm * radius_mm - distance * distance) / grid.unit_mm;
      const auto further = static_cast<Height>(grid.bounds ? std::ceil(reach) : std::round(reach));
      for (const SpanCell& cell : cells) {
        auto& column =
            columns[static_cast<std::size_t>((cell.y + dy - y0) * width + cell.x + dx - x0)];
        const auto low = static_cast<Height>(cell.low - further);
        const auto high = static_cast<Height>(cell.high + further);
        const auto overlapping = std::find_if(
            column.begin(), column.end(),
            [&](const SpanCell& known) { return known.low <= high && low <= known.high; });
        if (overlapping == column.end()) {
          column.push_back(span_cell(cell.x + dx, cell.y + dy, low, high, false));
        } else {
          overlapping->low = std::min(overlapping->low, low);
          overlapping->high = std::max(overlapping->high, high);
        }
      }
    }
  std::vector<SpanCell> result;
  for (std::vector<SpanCell>& column : columns) {
    merge_spans(column);
    result.insert(result.end(), column.begin(), column.end());
  }
  return result;
}

SolidPart solid_part(const std::vector<Mesh>& surfaces, const SolidGrid& grid) {
  SolidPart part;
  for (const Mesh& surface : surfaces)
    for (const Vec3& point : surface.points()) part.box.extend(point);
  part.rise = static_cast<Height>(std::ceil(part.box.max().z() / grid.unit_mm - kRounding_units));
  const std::vector<Crossing> crossings =
      sorted_crossings(surfaces, grid.cell_mm, grid.support_angle);
  part.centres = samples(crossings, grid.unit_mm);
  part.matter = grid.bounds
                    ? bounds(sorted_extents(surfaces, grid.cell_mm), crossings, grid.unit_mm)
                    : part.centres;
  part.outline = outline_of(part.matter);
  part.barred = grid.mask.barred(footprint_of(part.matter), part.box);
  part.reach = grown(part.matter, grid, grid.gap_mm);
  // From all over the part first, so that a scan soon knows that a position is not free.
  constexpr std::size_t kStride = 16;
  std::vector<SpanCell> spread;
  spread.reserve(part.reach.size());
  for (std::size_t from = 0; from < kStride; ++from)
    for (std::size_t i = from; i < part.reach.size(); i += kStride) spread.push_back(part.reach[i]);
  part.reach = std::move(spread);
  return part;
}

}  // namespace packmerger
