#include "pack/anywhere/solid_place.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <tuple>

namespace packmerger {
namespace {

constexpr int kSamePlace_cells = 4;
constexpr int kLookEvery = 8;  // meetings, before asking whether all heights are taken

auto rank(const SolidSpot& spot) {
  return std::tuple(spot.cost, spot.top, spot.rotation, spot.y, spot.x);
}

// What was found in all rotations so far.
class Found {
 public:
  Found(double give_up_above, std::size_t most) : give_up_above_(give_up_above), most_(most) {}

  // Whether a place of at least this cost and this top may still be told: places are looked at in
  // the order in which they win ties.
  bool wanted(double cost, int top) const {
    if (cost > give_up_above_) return false;
    const SolidSpot* worst = open_ ? &*open_ : nullptr;
    if (covered_.size() == most_ && most_ > 0 &&
        (worst == nullptr || rank(covered_.back()) < rank(*worst)))
      worst = &covered_.back();
    return worst == nullptr || std::tie(cost, top) < std::tie(worst->cost, worst->top);
  }

  // Whether it was taken.
  bool add(const SolidSpot& spot) {
    if (spot.cost > give_up_above_ || (open_ && !(rank(spot) < rank(*open_)))) return false;
    if (spot.open) {
      open_ = spot;
      std::erase_if(covered_, [&](const SolidSpot& other) { return rank(spot) < rank(other); });
      return true;
    }
    if (most_ == 0) return false;
    const auto near = std::find_if(covered_.begin(), covered_.end(), [&](const SolidSpot& other) {
      return other.rotation == spot.rotation && std::abs(other.x - spot.x) < kSamePlace_cells &&
             std::abs(other.y - spot.y) < kSamePlace_cells;
    });
    if (near != covered_.end()) {
      if (rank(*near) < rank(spot)) return false;
      covered_.erase(near);
    }
    const auto less = [](const SolidSpot& a, const SolidSpot& b) { return rank(a) < rank(b); };
    covered_.insert(std::upper_bound(covered_.begin(), covered_.end(), spot, less), spot);
    if (covered_.size() > most_) covered_.pop_back();
    return true;
  }

  std::vector<SolidSpot> all() const {
    std::vector<SolidSpot> spots = covered_;
    if (open_) spots.push_back(*open_);
    return spots;
  }

 private:
  double give_up_above_;
  std::size_t most_;
  std::optional<SolidSpot> open_;
  std::vector<SolidSpot> covered_;  // below something, best first
};

// All positions of one rotation.
class Scan {
 public:
  Scan(const SolidTray& tray, const TrayMeasure& before, const SolidPart& part, int rotation,
       double volume_mm3, const Cost& cost, Found& found)
      : tray_(tray), part_(part), rotation_(rotation), cost_(cost), found_(found) {
    after_ = before;
    after_.material_mm3 += volume_mm3;
    after_.parts += 1;
    // At 0 degrees a part takes the place of support at most; at others, it may prop what is above.
    least_support_mm3_ =
        tray.grid().support_angle <= 0 ? std::max(0.0, before.support_mm3 - 1.05 * volume_mm3) : 0;
    support_mm3_ = before.support_mm3;
  }

  void run(const SolidRules& rules) {
    const Range xs = positions(0, rules.x);
    const Range ys = positions(1, rules.y);
    if (xs.empty() || ys.empty()) return;
    least_x_ = least_growth(xs, tray_.contents(), part_.box, tray_.grid().cell_mm, 0);
    least_y_ = least_growth(ys, tray_.contents(), part_.box, tray_.grid().cell_mm, 1);
    limit();
    for (int y = ys.first; y <= ys.last; ++y)
      for (int x = xs.first; x <= xs.last && highest_ >= 0; ++x)
        if (part_.barred.empty() || !part_.barred.at(x, y)) look_at(x, y);
  }

 private:
  Range positions(int axis, const Range& asked) const {
    const SolidGrid& grid = tray_.grid();
    const Range inside = inside_tray(part_.box, grid.build_mm, grid.cell_mm, axis);
    // Beside a wall the bare plate may not be free.
    const Range useful = part_.barred.empty()
                             ? up_to_bare_plate(tray_.contents(), grid.cell_mm, grid.growth(), axis)
                             : kAllCells;
    return intersection(intersection(inside, useful), asked);
  }

  TrayMeasure measure(int x, int y, int z, double support_mm3) const {
    const SolidGrid& grid = tray_.grid();
    const Vec3 at(x * grid.cell_mm, y * grid.cell_mm, z * grid.unit_mm);
    TrayMeasure measure = after_;
    measure.size_mm = size_with(tray_.contents(), part_.box, at);
    measure.support_mm3 = support_mm3;
    return measure;
  }

  bool worth_it(int x, int y, int z) const {
    return found_.wanted(cost_.lower_bound(measure(x, y, z, least_support_mm3_)), z + part_.rise);
  }

  // The highest z worth looking at anywhere, below 0 where none is: costs never fall with z.
  void limit() {
    int low = -1;
    int high = tray_.grid().ceiling() - part_.rise + 1;
    while (high - low > 1) {
      const int middle = (low + high) / 2;
      (worth_it(least_x_, least_y_, middle) ? low : high) = middle;
    }
    highest_ = low;
    shift_ = 0;
    while ((highest_ >> shift_) >= TakenHeights::kCount) ++shift_;
  }

  void look_at(int x, int y) {
    const int shift = shift_;
    const int count = (highest_ >> shift) + 1;
    TakenHeights taken;
    int calls = 0;
    bool all = false;
    tray_.meetings(part_.reach, x, y, [&](int low, int high) {
      taken.take_between(low, high, shift);
      if (++calls % kLookEvery == 0) all = taken.all(count);
      return !all;
    });
    if (all) return;
    for (int k = taken.next_free(0); k < count;) {
      const FreeHeights free = stretch(x, y, k << shift);
      if (worth_it(x, y, free.low)) rate(x, y, free);
      if (free.high == kUpAndAway) return;
      const int above = (free.high >> shift) + 1;
      if (above >= count) return;
      k = taken.next_free(above);
    }
  }

  // The heights at which the part is free round one of them.
  FreeHeights stretch(int x, int y, int z) const {
    FreeHeights free{0, kUpAndAway};
    tray_.meetings(part_.reach, x, y, [&](int low, int high) {
      if (high <= z) free.low = std::max(free.low, high);
      if (low >= z) free.high = std::min(free.high, low);
      return true;
    });
    return free;
  }

  void rate(int x, int y, const FreeHeights& free) {
    SolidSpot spot{rotation_, x, y, free.low, free.low + part_.rise, 0, free.high == kUpAndAway};
    const double added_mm3 = tray_.added_support_mm3(part_, x, y, spot.z);
    spot.cost = cost_.evaluate(measure(x, y, spot.z, std::max(0.0, support_mm3_ + added_mm3)));
    if (found_.add(spot)) limit();
  }

  const SolidTray& tray_;
  const SolidPart& part_;
  int rotation_;
  const Cost& cost_;
  Found& found_;
  TrayMeasure after_;
  double least_support_mm3_ = 0;
  double support_mm3_ = 0;
  int least_x_ = 0;
  int least_y_ = 0;
  int highest_ = -1;
  int shift_ = 0;
};

}  // namespace

std::vector<SolidSpot> solid_spots(const SolidTray& tray, const TrayMeasure& before,
                                   std::span<const SolidPart* const> rotations, double volume_mm3,
                                   const Cost& cost, const SolidRules& rules) {
  Found found(rules.give_up_above, rules.most);
  for (std::size_t i = 0; i < rotations.size(); ++i)
    Scan(tray, before, *rotations[i], static_cast<int>(i), volume_mm3, cost, found).run(rules);
  return found.all();
}

}  // namespace packmerger
