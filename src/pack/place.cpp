#include "pack/place.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <vector>

#include "pack/kernel.h"

namespace packmerger {
namespace {

constexpr double kTolerance_mm = 1e-9;
constexpr double kHeightSlack_mm = 1e-3;  // for heights in single precision
constexpr std::size_t kCandidatesPerRotation = 3;

struct Range {
  int first = 0;
  int last = -1;
  bool empty() const { return last < first; }
  int count() const { return last - first + 1; }
};

Range intersection(const Range& a, const Range& b) {
  return {std::max(a.first, b.first), std::min(a.last, b.last)};
}

// Positions along one axis at which the part lies within the tray.
Range inside_tray(const RotatedPart& part, const PlaceRules& rules, int axis) {
  return {static_cast<int>(std::ceil((-part.box.min()[axis] - kTolerance_mm) / rules.grid_mm)),
          static_cast<int>(std::floor(
              (rules.build_mm[axis] - part.box.max()[axis] + kTolerance_mm) / rules.grid_mm))};
}

// Positions at which the part is no further from the contents than it must be to lie beside them.
Range near_contents(const TrayState& tray, const RotatedPart& part, const PlaceRules& rules,
                    int axis) {
  const double grid = rules.grid_mm;
  return {
      static_cast<int>(std::floor(tray.contents.min()[axis] / grid)) - part.reach_high[axis] - 2,
      static_cast<int>(std::ceil(tray.contents.max()[axis] / grid)) - part.reach_low[axis] + 2};
}

int floor_division(int value, int divisor) {
  return value >= 0 ? value / divisor : -((divisor - 1 - value) / divisor);
}

// The fine range in blocks, rounded outwards.
Range in_blocks(const Range& fine, int coarse) {
  return {floor_division(fine.first, coarse), -floor_division(-fine.last, coarse)};
}

// One part in one rotation over one tray.
class Rating {
 public:
  Rating(const TrayState& tray, const Part& part, const RotatedPart& rotated,
         const PlaceRules& rules)
      : tray_(tray), rotated_(rotated), rules_(rules) {
    before_ = tray.measure();
    before_.support_mm3 += rotated.inside_support_mm3;
    before_.material_mm3 += part.volume_mm3;
    before_.parts += 1;
  }

  double floor() const { return -rotated_.box.min().z(); }
  bool too_high(double z) const {
    return z + rotated_.box.max().z() > rules_.build_mm.z() + kTolerance_mm;
  }

  double added_support(double z, double horizon_sum) const {
    const double cell = rules_.grid_mm * rules_.grid_mm;
    const double hung =
        static_cast<double>(rotated_.hang.size()) * z + rotated_.hang_sum - horizon_sum;
    return rotated_.inside_support_mm3 + std::max(0.0, hung) * cell;
  }

  TrayMeasure measure(int x, int y, double z, double horizon_sum) const {
    TrayMeasure measure = before_;
    grow(x, y, z, measure);
    measure.support_mm3 += added_support(z, horizon_sum) - rotated_.inside_support_mm3;
    return measure;
  }

  // No cost at this position, however high the part ends up, is less.
  double bound(int x, int y) const { return bound(x, y, floor()); }

  // A height in row y, between two columns, above which no cost is within the limit, or the part is
  // too high by more than `slack`.
  double highest_worth_it(Range columns, int y, int step, double limit, double slack) const {
    double low = floor();
    double high = rules_.build_mm.z() - rotated_.box.max().z() + slack;
    if (!std::isfinite(limit) || high <= low) return high;
    // The box grows least where the part lies within the contents' extent, or nearest to that.
    const double inside =
        tray_.parts == 0 ? 0 : (tray_.contents.min().x() - rotated_.box.min().x()) / rules_.grid_mm;
    const int before =
        std::clamp(static_cast<int>(std::floor(inside / step)), columns.first, columns.last);
    const int behind = std::clamp(before + 1, columns.first, columns.last);
    constexpr int kHalvings = 10;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = (low + high) / 2;
      const bool worth_it =
          bound(before * step, y, middle) <= limit || bound(behind * step, y, middle) <= limit;
      (worth_it ? low : high) = middle;
    }
    return high;
  }

  // Of the positions in `columns` of row y, those between the first and the last whose bound does
  // not exceed the limit. Bounds fall towards the contents and rise behind them.
  Range worth_trying(Range columns, int y, int step, double limit) const {
    while (!columns.empty() && bound(columns.first * step, y) > limit) ++columns.first;
    while (!columns.empty() && bound(columns.last * step, y) > limit) --columns.last;
    return columns;
  }

 private:
  double bound(int x, int y, double z) const {
    TrayMeasure measure = before_;
    grow(x, y, z, measure);
    return rules_.cost->lower_bound(measure);
  }

  void grow(int x, int y, double z, TrayMeasure& measure) const {
    const Vec3 at(x * rules_.grid_mm, y * rules_.grid_mm, z);
    Vec3 low = rotated_.box.min() + at;
    Vec3 high = rotated_.box.max() + at;
    if (tray_.parts > 0) {
      low = low.cwiseMin(tray_.contents.min());
      high = high.cwiseMax(tray_.contents.max());
    }
    measure.size_mm = Vec3(high.x() - low.x(), high.y() - low.y(), high.z());
  }

  const TrayState& tray_;
  const RotatedPart& rotated_;
  const PlaceRules& rules_;
  TrayMeasure before_;
};

struct Candidate {
  double cost = 0;
  double z = 0;
  int rotation = 0;
  int x = 0;  // blocks
  int y = 0;
};

bool operator<(const Candidate& a, const Candidate& b) {
  return std::tie(a.cost, a.z, a.y, a.x, a.rotation) < std::tie(b.cost, b.z, b.y, b.x, b.rotation);
}

// The best few, sorted.
class Shortlist {
 public:
  explicit Shortlist(std::size_t size) : size_(size) {}

  double limit() const {
    return best_.size() < size_ ? std::numeric_limits<double>::infinity() : best_.back().cost;
  }
  void offer(const Candidate& candidate) {
    if (best_.size() == size_ && !(candidate < best_.back())) return;
    best_.insert(std::upper_bound(best_.begin(), best_.end(), candidate), candidate);
    if (best_.size() > size_) best_.pop_back();
  }
  const std::vector<Candidate>& best() const { return best_; }

 private:
  std::size_t size_;
  std::vector<Candidate> best_;
};

struct Ranges {
  Range x;
  Range y;
};

Ranges fine_ranges(const TrayState& tray, const RotatedPart& part, const PlaceRules& rules) {
  Ranges ranges{inside_tray(part, rules, 0), inside_tray(part, rules, 1)};
  if (tray.parts == 0) {
    // Every place on an empty tray is as good as the corner.
    ranges.x.last = std::min(ranges.x.last, ranges.x.first);
    ranges.y.last = std::min(ranges.y.last, ranges.y.first);
    return ranges;
  }
  ranges.x = intersection(ranges.x, near_contents(tray, part, rules, 0));
  ranges.y = intersection(ranges.y, near_contents(tray, part, rules, 1));
  return ranges;
}

// slack: mm by which a coarse height may be above the tray's limit.
void rate_coarsely(const TrayState& tray, const Part& part, int rotation, double slack,
                   const PlaceRules& rules, Shortlist& shortlist) {
  const RotatedPart& rotated = (*part.rotations)[static_cast<std::size_t>(rotation)];
  const Ranges fine = fine_ranges(tray, rotated, rules);
  if (fine.x.empty() || fine.y.empty()) return;
  const int step = tray.field.coarse;
  const Rating rating(tray, part, rotated, rules);
  const Range xs = in_blocks(fine.x, step);
  const Range ys = in_blocks(fine.y, step);
  Shortlist own(kCandidatesPerRotation);
  std::vector<float> heights;
  std::vector<float> sums;
  for (int y = ys.first; y <= ys.last; ++y) {
    const double limit = std::min(shortlist.limit(), own.limit());
    const Range row = rating.worth_trying(xs, y * step, step, limit);
    if (row.empty()) continue;
    const float highest =
        static_cast<float>(rating.highest_worth_it(row, y * step, step, limit, slack));
    heights.resize(static_cast<std::size_t>(row.count()));
    fall(tray.field.coarse_upper, rotated.coarse_reach, row.first, y,
         static_cast<float>(rating.floor()), highest, heights);
    if (*std::min_element(heights.begin(), heights.end()) > highest) continue;
    sums.resize(heights.size());
    sum_field(tray.field.coarse_surface, rotated.coarse_hang, true, row.first, y, sums);
    for (std::size_t i = 0; i < heights.size(); ++i) {
      if (heights[i] > highest) continue;
      const double z = heights[i];
      const int x = row.first + static_cast<int>(i);
      const double cost = rules.cost->evaluate(rating.measure(x * step, y * step, z, sums[i]));
      own.offer({cost, z, rotation, x, y});
    }
  }
  for (const Candidate& candidate : own.best()) shortlist.offer(candidate);
}

bool better(const Spot& a, const Spot& b) {
  return std::tie(a.cost, a.z, a.y, a.x, a.rotation) < std::tie(b.cost, b.z, b.y, b.x, b.rotation);
}

void look_closely(const TrayState& tray, const Part& part, const Candidate& candidate,
                  const PlaceRules& rules, std::optional<Spot>& best) {
  const RotatedPart& rotated = (*part.rotations)[static_cast<std::size_t>(candidate.rotation)];
  const Ranges fine = fine_ranges(tray, rotated, rules);
  const int step = tray.field.coarse;
  const Range xs = intersection(fine.x, {(candidate.x - 1) * step, (candidate.x + 1) * step - 1});
  const Range ys = intersection(fine.y, {(candidate.y - 1) * step, (candidate.y + 1) * step - 1});
  const Rating rating(tray, part, rotated, rules);
  std::vector<float> heights;
  std::vector<float> sums;
  for (int y = ys.first; y <= ys.last; ++y) {
    const double limit = best ? best->cost : std::numeric_limits<double>::infinity();
    const Range row = rating.worth_trying(xs, y, 1, limit);
    if (row.empty()) continue;
    const float floor = static_cast<float>(rating.floor());
    const float highest =
        rules.on_plate_only
            ? floor
            : static_cast<float>(rating.highest_worth_it(row, y, 1, limit, rules.grid_mm));
    heights.resize(static_cast<std::size_t>(row.count()));
    fall(tray.field.upper, rotated.reach, row.first, y, floor, highest, heights);
    if (*std::min_element(heights.begin(), heights.end()) > highest) continue;
    sums.resize(heights.size());
    sum_field(tray.field.surface, rotated.hang, false, row.first, y, sums);
    for (std::size_t i = 0; i < heights.size(); ++i) {
      // On the plate the exact height counts, not its rounded copy.
      if (heights[i] > highest) continue;
      const double z = heights[i] <= floor ? rating.floor() : heights[i];
      if (rating.too_high(z)) continue;
      const int x = row.first + static_cast<int>(i);
      const Spot spot{candidate.rotation,
                      x,
                      y,
                      z,
                      rules.cost->evaluate(rating.measure(x, y, z, sums[i])),
                      rating.added_support(z, sums[i])};
      if (!best || better(spot, *best)) best = spot;
    }
  }
}

// The best of the spots round the best few coarse positions.
std::optional<Spot> best_promised(const TrayState& tray, const Part& part, double slack,
                                  const PlaceRules& rules) {
  // On an empty tray there is one position a rotation, so all of them are looked at.
  Shortlist shortlist(tray.parts == 0 ? part.rotations->size()
                                      : static_cast<std::size_t>(rules.candidates));
  for (int rotation = 0; rotation < static_cast<int>(part.rotations->size()); ++rotation)
    rate_coarsely(tray, part, rotation, slack, rules, shortlist);
  std::optional<Spot> best;
  for (const Candidate& candidate : shortlist.best())
    look_closely(tray, part, candidate, rules, best);
  return best;
}

// Every position in every rotation, the promising ones first, so that the others are soon out.
std::optional<Spot> look_everywhere(const TrayState& tray, const Part& part,
                                    const PlaceRules& rules) {
  const int step = tray.field.coarse;
  std::vector<Candidate> windows;
  for (int rotation = 0; rotation < static_cast<int>(part.rotations->size()); ++rotation) {
    const RotatedPart& rotated = (*part.rotations)[static_cast<std::size_t>(rotation)];
    const Ranges fine = fine_ranges(tray, rotated, rules);
    if (fine.x.empty() || fine.y.empty()) continue;
    const Rating rating(tray, part, rotated, rules);
    const Range xs = in_blocks(fine.x, step);
    const Range ys = in_blocks(fine.y, step);
    // A window reaches one block to each side, so every other block will do, and one more.
    for (int y = ys.first; y <= ys.last + 1; y += 2)
      for (int x = xs.first; x <= xs.last + 1; x += 2)
        windows.push_back({rating.bound(x * step, y * step), 0, rotation, x, y});
  }
  std::sort(windows.begin(), windows.end());
  std::optional<Spot> best;
  for (const Candidate& window : windows) look_closely(tray, part, window, rules, best);
  return best;
}

}  // namespace

std::optional<Spot> best_spot(const TrayState& tray, const Part& part, const PlaceRules& rules) {
  if (tray.closed) return std::nullopt;
  // Coarse heights do not tell what stands on the plate.
  if (rules.on_plate_only) return look_everywhere(tray, part, rules);
  // Coarse heights err by about a block's slope. Where all they promised is too high, it may be
  // that such promises kept out lesser ones that hold.
  std::optional<Spot> best =
      best_promised(tray, part, 2 * tray.field.coarse * rules.grid_mm, rules);
  if (!best && tray.parts > 0) best = best_promised(tray, part, kHeightSlack_mm, rules);
  if (!best && rules.thorough) best = look_everywhere(tray, part, rules);
  return best;
}

void put(TrayState& tray, const Part& part, const Spot& spot, double grid_mm) {
  const RotatedPart& rotated = (*part.rotations)[static_cast<std::size_t>(spot.rotation)];
  tray.field.add(rotated, spot.x, spot.y, spot.z);
  const Vec3 at(spot.x * grid_mm, spot.y * grid_mm, spot.z);
  tray.contents.extend(rotated.box.min() + at);
  tray.contents.extend(rotated.box.max() + at);
  tray.support_mm3 += spot.support_mm3;
  tray.material_mm3 += part.volume_mm3;
  tray.parts += 1;
}

}  // namespace packmerger
