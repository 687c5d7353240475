#include "printers/layers/support_volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "base/parallel.h"

namespace packmerger {
namespace {

constexpr int kVolumeLines = 1 << 20;
constexpr int kBandRows = 8;  // rows one task reads
constexpr double kHalfUnitsPerExtent = 0x1p29;
constexpr double kLevelTangent = 0.0875;  // of 5°
constexpr double kSineTolerance = 1e-6;   // so that a facet at the support angle itself needs none

// x and y of a corner in whole half-units: corners are even, lines odd, so no line meets a corner.
// Up to 2^29, so that products of differences fit 64 bits with room to spare.
using Whole = std::array<std::int64_t, 2>;

struct Facet {
  std::array<Whole, 3> corner;
  std::array<double, 3> z_mm;
  std::int64_t twice_area;  // signed: positive seen from above counter-clockwise (an upper facet)
  bool supported;           // needs support, if matter is entered here
  bool level;
};

struct Crossing {
  int column;
  double z_mm;
  int step;  // +1 enters matter from below, −1 leaves it
  bool supported;
  bool level;
};

// Where a line meets the facets' plane coordinates.
struct Rounding {
  Vec2 origin = Vec2::Zero();
  double per_mm = 0;  // half-units

  Whole corner(const Vec3& point) const {
    const auto even = [&](double mm) {
      return 2 * static_cast<std::int64_t>(std::llround(mm * per_mm / 2));
    };
    return {even(point.x() - origin.x()), even(point.y() - origin.y())};
  }
  std::int64_t line(double mm_from_origin) const {
    return 2 * static_cast<std::int64_t>(std::floor(mm_from_origin * per_mm / 2)) + 1;
  }
};

// Twice the area of (from, to, point). The same number, sign apart, from both sides of an edge.
std::int64_t side(const Whole& from, const Whole& to, const Whole& point) {
  return (to[0] - from[0]) * (point[1] - from[1]) - (to[1] - from[1]) * (point[0] - from[0]);
}

// Whether the point lies left of the edge; one that lies on the edge belongs to the same one of
// the two facets that share it, whichever of them asks.
bool left_of(const Whole& from, const Whole& to, const Whole& point) {
  return from < to ? side(from, to, point) > 0 : side(to, from, point) <= 0;
}

std::vector<Facet> facets_of(const std::vector<const Mesh*>& parts, const Rounding& rounding,
                             double support_angle) {
  std::vector<Facet> facets;
  for (const Mesh* part : parts) {
    for (std::size_t i = 0; i < part->n_triangles(); ++i) {
      const auto [a, b, c] = part->corners(i);
      const Vec3 normal = (b - a).cross(c - a);
      Facet facet{{rounding.corner(a), rounding.corner(b), rounding.corner(c)},
                  {a.z(), b.z(), c.z()},
                  0,
                  needs_support(normal, support_angle),
                  normal.head<2>().norm() < kLevelTangent * -normal.z()};
      facet.twice_area = side(facet.corner[0], facet.corner[1], facet.corner[2]);
      if (facet.twice_area != 0) facets.push_back(facet);
    }
  }
  return facets;
}

// Facets by the bands of rows they reach into: those of band b are order[first[b]..first[b+1]).
struct Bands {
  std::vector<std::size_t> first;
  std::vector<int> order;
};

class Reader {
 public:
  Reader(const std::vector<const Mesh*>& parts, const SupportGrid& grid, double support_angle)
      : grid_(grid) {
    const double extent = std::max(grid.columns * grid.cell_mm.x(), grid.rows * grid.cell_mm.y());
    rounding_ = {grid.low, kHalfUnitsPerExtent / extent};
    facets_ = facets_of(parts, rounding_, support_angle);
    for (int column = 0; column < grid.columns; ++column)
      x_.push_back(rounding_.line((column + 0.5) * grid.cell_mm.x()));
    for (int row = 0; row < grid.rows; ++row)
      y_.push_back(rounding_.line((row + 0.5) * grid.cell_mm.y()));
    sort_into_bands();
  }

  int bands() const { return (grid_.rows + kBandRows - 1) / kBandRows; }

  // Calls visit(row, crossings) for each row of a band; crossings by column, then height.
  template <typename Visit>
  void read_band(int band, const Visit& visit) const {
    std::array<std::vector<Crossing>, kBandRows> crossings;
    const int first_row = band * kBandRows;
    const int end_row = std::min(first_row + kBandRows, grid_.rows);
    for (std::size_t i = bands_.first[band]; i < bands_.first[band + 1]; ++i) {
      const Facet& facet = facets_[bands_.order[i]];
      for (int row = first_row; row < end_row; ++row) cross(facet, row, crossings[row - first_row]);
    }
    for (int row = first_row; row < end_row; ++row) {
      std::vector<Crossing>& found = crossings[row - first_row];
      std::stable_sort(found.begin(), found.end(), [](const Crossing& a, const Crossing& b) {
        return a.column != b.column ? a.column < b.column : a.z_mm < b.z_mm;
      });
      visit(row, found);
    }
  }

 private:
  // Rows [first, end) whose lines may meet the facet.
  std::pair<int, int> rows_of(const Facet& facet) const {
    const auto [low, high] =
        std::minmax({facet.corner[0][1], facet.corner[1][1], facet.corner[2][1]});
    return {static_cast<int>(std::lower_bound(y_.begin(), y_.end(), low) - y_.begin()),
            static_cast<int>(std::upper_bound(y_.begin(), y_.end(), high) - y_.begin())};
  }

  void sort_into_bands() {
    bands_.first.assign(bands() + 1, 0);
    const auto for_bands = [&](const Facet& facet, const auto& use) {
      const auto [first, end] = rows_of(facet);
      if (first < end)
        for (int band = first / kBandRows; band <= (end - 1) / kBandRows; ++band) use(band);
    };
    for (const Facet& facet : facets_)
      for_bands(facet, [&](int band) { ++bands_.first[band + 1]; });
    for (int band = 0; band < bands(); ++band) bands_.first[band + 1] += bands_.first[band];
    bands_.order.resize(bands_.first.back());
    std::vector<std::size_t> next = bands_.first;
    for (int i = 0; i < static_cast<int>(facets_.size()); ++i)
      for_bands(facets_[i], [&](int band) { bands_.order[next[band]++] = i; });
  }

  // Adds the crossings of one row's lines with one facet.
  void cross(const Facet& facet, int row, std::vector<Crossing>& found) const {
    const auto& [a, b, c] = facet.corner;
    const std::int64_t y = y_[row];
    // the facet's reach in x along this row, widened by a line on either side: the exact test
    // decides
    double low = INFINITY;
    double high = -INFINITY;
    for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}}) {
      if ((from[1] < y) == (to[1] < y)) continue;
      const double along = static_cast<double>(y - from[1]) / static_cast<double>(to[1] - from[1]);
      const double x = static_cast<double>(from[0]) + along * static_cast<double>(to[0] - from[0]);
      low = std::min(low, x);
      high = std::max(high, x);
    }
    if (low > high) return;
    const double per_line = grid_.cell_mm.x() * rounding_.per_mm;
    const int first = std::max(0, static_cast<int>(std::floor(low / per_line - 0.5)) - 1);
    const int last =
        std::min(grid_.columns - 1, static_cast<int>(std::ceil(high / per_line - 0.5)) + 1);
    const bool upper = facet.twice_area > 0;
    for (int column = first; column <= last; ++column) {
      const Whole point{x_[column], y};
      if (left_of(a, b, point) != upper || left_of(b, c, point) != upper ||
          left_of(c, a, point) != upper)
        continue;
      const double area = static_cast<double>(facet.twice_area);
      const double u = static_cast<double>(side(b, c, point)) / area;
      const double v = static_cast<double>(side(c, a, point)) / area;
      const double z = u * facet.z_mm[0] + v * facet.z_mm[1] + (1 - u - v) * facet.z_mm[2];
      found.push_back({column, z, upper ? -1 : 1, facet.supported, facet.level});
    }
  }

  SupportGrid grid_;
  Rounding rounding_;
  std::vector<Facet> facets_;
  std::vector<std::int64_t> x_;
  std::vector<std::int64_t> y_;
  Bands bands_;
};

// The empty lengths of one row, from its crossings by column and height.
std::vector<SupportSpan> spans_of(const std::vector<Crossing>& crossings) {
  std::vector<SupportSpan> spans;
  int column = -1;
  int depth = 0;        // how many parts the line is inside of
  double floor_mm = 0;  // top of the matter below, or the tray
  for (const Crossing& crossing : crossings) {
    if (crossing.column != column) {
      column = crossing.column;
      depth = 0;
      floor_mm = 0;
    }
    if (depth == 0 && crossing.step > 0 && crossing.supported && crossing.z_mm > floor_mm)
      spans.push_back({column, floor_mm, crossing.z_mm, crossing.level});
    depth += crossing.step;
    if (depth == 0) floor_mm = std::max(floor_mm, crossing.z_mm);
  }
  return spans;
}

void add(const SupportSpan& span, double cell_mm2, SupportMeasure& sum) {
  const double volume_mm3 = (span.high_mm - span.low_mm) * cell_mm2;
  sum.volume_mm3 += volume_mm3;
  sum.interface_mm2 += cell_mm2;
  if (!span.level) return;
  sum.level_volume_mm3 += volume_mm3;
  sum.level_interface_mm2 += cell_mm2;
}

}  // namespace

bool needs_support(const Vec3& normal, double support_angle) {
  return -normal.z() > (std::sin(support_angle) + kSineTolerance) * normal.norm();
}

SupportGrid support_grid(const std::vector<const Mesh*>& parts, int lines) {
  Box3 box;
  for (const Mesh* part : parts) box.extend(bounding_box(*part));
  SupportGrid grid;
  if (box.isEmpty()) return grid;
  const Vec2 size = box.sizes().head<2>();
  if (size.x() <= 0 || size.y() <= 0) return grid;
  const auto share = [&](double along, double across) {
    return std::clamp(static_cast<int>(std::ceil(std::sqrt(lines * along / across))), 1, lines);
  };
  grid.low = box.min().head<2>();
  grid.columns = share(size.x(), size.y());
  grid.rows = share(size.y(), size.x());
  grid.cell_mm = {size.x() / grid.columns, size.y() / grid.rows};
  return grid;
}

void for_each_support_row(
    const std::vector<const Mesh*>& parts, const SupportGrid& grid, double support_angle,
    const std::function<void(int row, const std::vector<SupportSpan>& spans)>& visit) {
  if (grid.rows == 0) return;
  const Reader reader(parts, grid, support_angle);
  parallel_for(static_cast<std::size_t>(reader.bands()), [&](std::size_t band) {
    reader.read_band(static_cast<int>(band), [&](int row, const std::vector<Crossing>& crossings) {
      visit(row, spans_of(crossings));
    });
  });
}

SupportMeasure support_measure(const std::vector<const Mesh*>& parts, double support_angle) {
  const SupportGrid grid = support_grid(parts, kVolumeLines);
  const double cell_mm2 = grid.cell_mm.prod();
  std::vector<SupportMeasure> rows(grid.rows);
  for_each_support_row(parts, grid, support_angle,
                       [&](int row, const std::vector<SupportSpan>& spans) {
                         for (const SupportSpan& span : spans) add(span, cell_mm2, rows[row]);
                       });
  SupportMeasure sum;
  for (const SupportMeasure& row : rows) {
    sum.volume_mm3 += row.volume_mm3;
    sum.interface_mm2 += row.interface_mm2;
    sum.level_volume_mm3 += row.level_volume_mm3;
    sum.level_interface_mm2 += row.level_interface_mm2;
  }
  return sum;
}

double support_volume_mm3(const std::vector<const Mesh*>& parts, double support_angle) {
  return support_measure(parts, support_angle).volume_mm3;
}

}  // namespace packmerger
