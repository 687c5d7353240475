#include "pack/place.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <vector>

#include "pack/fall.h"

namespace packmerger {
namespace {

constexpr double kTolerance_mm = 1e-9;
constexpr double kRounding = 1e-12;  // of a cost: bounds and costs may round differently

// One part in one rotation over one tray: what its positions cost.
class Rating {
 public:
  Rating(const TrayState& tray, const RotatedPart& part, double volume_mm3, const TraySpec& spec)
      : part_(part), spec_(spec), empty_(tray.parts == 0) {
    before_ = tray.measure();
    before_.support_mm3 += part.inside_support_mm3;
    before_.material_mm3 += volume_mm3;
    before_.parts += 1;
    low_ = tray.contents.min();
    high_ = tray.contents.max();
  }

  // waste: units, summed over the cells.
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
  std::int64_t waste(Height z, std::int32_t horizon) const {
    return static_cast<std::int64_t>(part_.hang.size()) * z + part_.hang_sum - horizon;
  }

  // The position in a range at which the contents grow least along an axis: there or one before.
  int least_growth(const Range& range, int axis) const {
    if (empty_) return range.first;
    const double at = (low_[axis] - part_.box.min()[axis]) / spec_.grid.cell_mm;
    return std::clamp(static_cast<int>(std::ceil(std::clamp(at, -1e6, 1e6))), range.first,
                      range.last);
  }

 private:
  TrayMeasure measure(int x, int y, Height z, std::int64_t waste) const {
    const Vec3 at(x * spec_.grid.cell_mm, y * spec_.grid.cell_mm, z * spec_.grid.unit_mm);
    Vec3 low = part_.box.min() + at;
    Vec3 high = part_.box.max() + at;
    if (!empty_) {
      low = low.cwiseMin(low_);
      high = high.cwiseMax(high_);
    }
    TrayMeasure measure = before_;
    measure.size_mm = Vec3(high.x() - low.x(), high.y() - low.y(), high.z());
    measure.support_mm3 += waste_mm3(waste);
    return measure;
  }

  const RotatedPart& part_;
  const TraySpec& spec_;
  TrayMeasure before_;
  Vec3 low_;
  Vec3 high_;
  bool empty_;
};

// The largest value in [0, most] that passes, given that 0 does and that none passes above one that
// does not.
template <typename Passes>
std::int64_t largest(std::int64_t most, const Passes& passes) {
  std::int64_t low = 0;
  std::int64_t high = most;
  while (low < high) {
    const std::int64_t middle = (low + high + 1) / 2;
    if (passes(middle))
      low = middle;
    else
      high = middle - 1;
  }
  return low;
}

auto rank(const Spot& spot) { return std::tuple(spot.cost, spot.z, spot.y, spot.x, spot.rotation); }

// All positions of one rotation.
class Scan {
 public:
  Scan(const TrayState& tray, const RotatedPart& part, int rotation, double volume_mm3,
       const TraySpec& spec, const PlaceRules& rules, std::optional<Spot>& best)
      : tray_(tray),
        part_(part),
        rotation_(rotation),
        spec_(spec),
        rules_(rules),
        best_(best),
        rating_(tray, part, volume_mm3, spec) {}

  void run() {
    const Range xs =
        intersection(intersection(inside_tray(part_, spec_, 0), reachable(0)), rules_.x);
    const Range ys =
        intersection(intersection(inside_tray(part_, spec_, 1), reachable(1)), rules_.y);
    if (xs.empty() || ys.empty() || part_.rise > spec_.ceiling()) return;
    least_x_ = rating_.least_growth(xs, 0);
    least_y_ = rating_.least_growth(ys, 1);
    least_x_range_ = xs;
    least_y_range_ = ys;
    limit();
    for (int y = ys.first; y <= ys.last && highest_ >= 0; ++y) {
      if (best_ && least_bound(y, 0, 0) > dearest_) continue;
      scan_row(xs, y);
    }
  }

 private:
  // Up to the first position beside all contents: from there on the part stands on the bare plate,
  // costs no less and loses every tie.
  Range reachable(int axis) const {
    if (tray_.parts == 0) return {0, 0};
    const double end = tray_.contents.max()[axis] / spec_.grid.cell_mm;
    return {0, static_cast<int>(std::ceil(end)) + spec_.growth()};
  }

  // The bound at the best column, in row y.
  double least_bound(int y, Height z, std::int64_t waste) const {
    const int before = std::max(least_x_ - 1, least_x_range_.first);
    return std::min(rating_.bound(least_x_, y, z, waste), rating_.bound(before, y, z, waste));
  }

  bool worth_it(Height z, std::int64_t waste) const {
    const int before = std::max(least_y_ - 1, least_y_range_.first);
    return least_bound(least_y_, z, waste) <= dearest_ || least_bound(before, z, waste) <= dearest_;
  }

  // The height and the waste above which no position costs less than the best; highest_ < 0: none
  // does.
  void limit() {
    highest_ = rules_.on_plate_only ? 0 : spec_.ceiling() - part_.rise;
    most_waste_ = static_cast<std::int64_t>(part_.hang.size()) * spec_.ceiling();
    if (!best_) return;
    dearest_ = best_->cost + kRounding * std::abs(best_->cost);
    if (!worth_it(0, 0)) {
      highest_ = -1;
      return;
    }
    highest_ = static_cast<int>(
        largest(highest_, [&](std::int64_t z) { return worth_it(static_cast<Height>(z), 0); }));
    most_waste_ = largest(most_waste_, [&](std::int64_t waste) { return worth_it(0, waste); });
  }

  void scan_row(const Range& xs, int y) {
    const int count = xs.count();
    heights_.resize(static_cast<std::size_t>(count) + kFallReadAhead);
    fall(tray_.upper.origin(), tray_.upper.stride(), part_.reach, xs.first, y, 0,
         static_cast<Height>(highest_), heights_.data(), count);
    for (int i = 0; i < count;) {
      if (heights_[static_cast<std::size_t>(i)] > highest_) {
        ++i;
        continue;
      }
      int end = i + 1;
      while (end < count && end - i < kRun && heights_[static_cast<std::size_t>(end)] <= highest_)
        ++end;
      rate(xs.first, y, i, end);
      i = end;
    }
  }

  void rate(int first, int y, int begin, int end) {
    sum_field(tray_.surface.origin(), tray_.surface.stride(), part_.hang, first + begin, y, sums_,
              end - begin);
    for (int i = begin; i < end; ++i) {
      const Height z = heights_[static_cast<std::size_t>(i)];
      if (z > highest_) continue;
      const std::int64_t waste = rating_.waste(z, sums_[i - begin]);
      if (waste > most_waste_) continue;
      Spot here{rotation_, first + i, y, z, 0, 0};
      here.cost = rating_.cost(here.x, y, z, waste);
      if (best_ && !(rank(here) < rank(*best_))) continue;
      here.support_mm3 = part_.inside_support_mm3 + rating_.waste_mm3(waste);
      const bool cheaper = !best_ || here.cost < best_->cost;
      best_ = here;
      if (cheaper) limit();
    }
  }

  static constexpr int kRun = 64;

  const TrayState& tray_;
  const RotatedPart& part_;
  int rotation_;
  const TraySpec& spec_;
  const PlaceRules& rules_;
  std::optional<Spot>& best_;
  Rating rating_;
  int least_x_ = 0;
  int least_y_ = 0;
  Range least_x_range_;
  Range least_y_range_;
  int highest_ = 0;
  std::int64_t most_waste_ = 0;
  double dearest_ = 0;  // that is still worth rating
  std::vector<Height> heights_;
  std::int32_t sums_[kRun + kFallReadAhead];
};

}  // namespace

Range intersection(const Range& a, const Range& b) {
  return {std::max(a.first, b.first), std::min(a.last, b.last)};
}

Range inside_tray(const RotatedPart& part, const TraySpec& spec, int axis) {
  const double room = spec.build_mm[axis] - part.box.max()[axis] + kTolerance_mm;
  return {0, static_cast<int>(std::floor(room / spec.grid.cell_mm))};
}

std::optional<Spot> best_spot(const TrayState& tray, std::span<const RotatedPart* const> rotations,
                              double volume_mm3, const TraySpec& spec, const PlaceRules& rules) {
  std::optional<Spot> best;
  for (std::size_t i = 0; i < rotations.size(); ++i)
    Scan(tray, *rotations[i], static_cast<int>(i), volume_mm3, spec, rules, best).run();
  return best;
}

}  // namespace packmerger
