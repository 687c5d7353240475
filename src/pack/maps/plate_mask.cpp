#include "pack/maps/plate_mask.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace packmerger {
namespace {

// The cells over a wall, row by row.
class TakenCells {
 public:
  TakenCells(const Plate& plate, const Vec3& build_mm, double cell_mm, bool bounds)
      : cell_mm_(cell_mm),
        bounds_(bounds),
        columns_(cells_along(build_mm.x(), cell_mm)),
        taken_(static_cast<std::size_t>(cells_along(build_mm.y(), cell_mm)),
               std::vector<char>(static_cast<std::size_t>(columns_), 0)) {
    take_outside(plate.hull());
    for (const Polygon& area : plate.barred()) {
      if (bounds_) take_border(area);
      take_inside(area);
    }
  }

  std::vector<std::vector<Range>> runs() const {
    std::vector<std::vector<Range>> rows(taken_.size());
    for (std::size_t y = 0; y < taken_.size(); ++y)
      for (int x = 0; x < columns_; ++x) {
        if (!taken_[y][static_cast<std::size_t>(x)]) continue;
        if (!rows[y].empty() && rows[y].back().last == x - 1)
          rows[y].back().last = x;
        else
          rows[y].push_back({x, x});
      }
    return rows;
  }

 private:
  void take(std::size_t row, int first, int last) {
    for (int x = std::max(first, 0); x <= std::min(last, columns_ - 1); ++x)
      taken_[row][static_cast<std::size_t>(x)] = 1;
  }

  double middle(std::size_t row) const { return (static_cast<double>(row) + 0.5) * cell_mm_; }

  // A cell is free where its farthest corner, or its centre, lies within every side.
  void take_outside(const Polygon& hull) {
    const double half = bounds_ ? cell_mm_ / 2 : 0;
    for (std::size_t i = 0; i < hull.size(); ++i) {
      const Vec2 side = hull[(i + 1) % hull.size()] - hull[i];
      const Vec2 outward = Vec2(side.y(), -side.x()).normalized();
      const double farther = half * (std::abs(outward.x()) + std::abs(outward.y()));
      const double offset = outward.dot(hull[i]) - farther + kWallTolerance_mm / 2;
      for (std::size_t row = 0; row < taken_.size(); ++row) {
        const double left = offset - outward.y() * middle(row);  // outward.x · x may be so much
        if (outward.x() == 0) {
          if (left < 0) take(row, 0, columns_ - 1);
          continue;
        }
        const double last = std::clamp(left / outward.x() / cell_mm_ - 0.5, -2.0, columns_ + 2.0);
        if (outward.x() > 0)
          take(row, static_cast<int>(std::floor(last)) + 1, columns_ - 1);
        else
          take(row, 0, static_cast<int>(std::ceil(last)) - 1);
      }
    }
  }

  void take_inside(const Polygon& area) {
    const auto box = bounding_box(area);
    for (std::size_t row = row_at(box.min().y()); row < taken_.size(); ++row) {
      const double y = middle(row);
      if (y > box.max().y()) return;
      std::vector<double> crossings;
      for (std::size_t i = 0; i < area.size(); ++i) {
        const Vec2& a = area[i];
        const Vec2& b = area[(i + 1) % area.size()];
        if ((a.y() > y) != (b.y() > y))
          crossings.push_back(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
      }
      std::sort(crossings.begin(), crossings.end());
      for (std::size_t i = 0; i + 1 < crossings.size(); i += 2)
        take(row, column_of(crossings[i], 0.5), column_of(crossings[i + 1], -0.5));
    }
  }

  // The first cell whose centre is at x or beyond, or the last one whose centre is not beyond it.
  int column_of(double x, double towards) const {
    const double at = std::clamp(x / cell_mm_ - 0.5, -2.0, columns_ + 2.0);
    return static_cast<int>(towards > 0 ? std::ceil(at) : std::floor(at));
  }

  std::size_t row_at(double y) const {
    return static_cast<std::size_t>(
        std::clamp(std::floor(y / cell_mm_), 0.0, static_cast<double>(taken_.size())));
  }

  // Cells that the border passes, where it does more than touch them.
  void take_border(const Polygon& area) {
    for (std::size_t i = 0; i < area.size(); ++i) {
      Vec2 a = area[i];
      Vec2 b = area[(i + 1) % area.size()];
      if (a.y() > b.y()) std::swap(a, b);
      for (std::size_t row = row_at(a.y() - cell_mm_); row < taken_.size(); ++row) {
        const double low = static_cast<double>(row) * cell_mm_;
        if (low > b.y()) break;
        const auto x_at = [&](double y) {
          if (b.y() - a.y() <= 0) return y <= a.y() ? a.x() : b.x();
          return a.x() + std::clamp((y - a.y()) / (b.y() - a.y()), 0.0, 1.0) * (b.x() - a.x());
        };
        const bool level = b.y() - a.y() <= 0;
        const double from = level ? a.x() : x_at(low);
        const double to = level ? b.x() : x_at(low + cell_mm_);
        const auto [left, right] = std::minmax(from, to);
        const auto cell = [&](double x) {
          return static_cast<int>(
              std::clamp(std::floor(x / cell_mm_), -1.0, static_cast<double>(columns_)));
        };
        for (int x = std::max(0, cell(left) - 1); x <= std::min(columns_ - 1, cell(right)); ++x)
          if (overlaps(area, x, row)) take(row, x, x);
      }
    }
  }

  bool overlaps(const Polygon& area, int x, std::size_t row) const {
    const Vec2 low(x * cell_mm_, static_cast<double>(row) * cell_mm_);
    const std::array<Vec2, 4> corners{low, low + Vec2(cell_mm_, 0), low + Vec2(cell_mm_, cell_mm_),
                                      low + Vec2(0, cell_mm_)};
    if (contains(area, low + Vec2(cell_mm_ / 2, cell_mm_ / 2))) return true;
    for (const Vec2& corner : area)
      if ((corner - low).minCoeff() > kWallTolerance_mm / 2 &&
          (corners[2] - corner).minCoeff() > kWallTolerance_mm / 2)
        return true;
    for (std::size_t i = 0; i < 4; ++i)
      if (depth_within(area, corners[i], corners[(i + 1) % 4]) > kWallTolerance_mm / 2) return true;
    return false;
  }

  double cell_mm_;
  bool bounds_;
  int columns_;
  std::vector<std::vector<char>> taken_;
};

}  // namespace

PlateMask::PlateMask(const Plate& plate, const Vec3& build_mm, double cell_mm, bool bounds)
    : build_mm_(build_mm), cell_mm_(cell_mm) {
  if (!plate.is_whole()) rows_ = TakenCells(plate, build_mm, cell_mm, bounds).runs();
}

BarredPositions PlateMask::barred(std::vector<FootCell> footprint, const Box3& box) const {
  if (empty()) return {};
  const Range xs = inside_tray(box, build_mm_, cell_mm_, 0);
  const Range ys = inside_tray(box, build_mm_, cell_mm_, 1);
  if (xs.empty() || ys.empty()) return {};
  std::sort(footprint.begin(), footprint.end(), [](const FootCell& a, const FootCell& b) {
    return std::tie(a.y, a.x) < std::tie(b.y, b.x);
  });
  BarredPositions barred(xs, ys);
  bool any = false;
  std::vector<int> begun(static_cast<std::size_t>(xs.count()) + 1);
  for (int y = ys.first; y <= ys.last; ++y) {
    std::fill(begun.begin(), begun.end(), 0);
    for (std::size_t i = 0; i < footprint.size();) {
      std::size_t end = i + 1;
      while (end < footprint.size() && footprint[end].y == footprint[i].y &&
             footprint[end].x <= footprint[end - 1].x + 1)
        ++end;
      const int row = y + footprint[i].y;
      if (row >= 0 && row < static_cast<int>(rows_.size()))
        for (const Range& taken : rows_[static_cast<std::size_t>(row)]) {
          const Range hit =
              intersection(xs, {taken.first - footprint[end - 1].x, taken.last - footprint[i].x});
          if (hit.empty()) continue;
          ++begun[static_cast<std::size_t>(hit.first - xs.first)];
          --begun[static_cast<std::size_t>(hit.last + 1 - xs.first)];
        }
      i = end;
    }
    int over = 0;
    for (int x = xs.first; x <= xs.last; ++x) {
      over += begun[static_cast<std::size_t>(x - xs.first)];
      barred.at(x, y) = over > 0 ? 1 : 0;
      any = any || over > 0;
    }
  }
  return any ? barred : BarredPositions();
}

}  // namespace packmerger
