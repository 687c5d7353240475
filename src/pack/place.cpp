#include "pack/place.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>
#include <vector>

#include "pack/fall.h"

namespace packmerger {
namespace {

constexpr double kRounding = 1e-12;  // of a cost: bounds and costs may round differently

// One part in one rotation over one tray: what its positions cost.
class Rating {
 public:
  Rating(const TrayState& tray, const RotatedPart& part, double volume_mm3, const TraySpec& spec)
      : part_(part), spec_(spec), contents_(tray.contents) {
    before_ = tray.measure();
    before_.support_mm3 += part.inside_support_mm3;
    before_.material_mm3 += volume_mm3;
    before_.parts += 1;
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

auto rank(const Spot& spot) {
  return std::tuple(spot.cost, spot.top, spot.z, spot.y, spot.x, spot.rotation);
}

// The best of all rotations so far, and the blocks of positions that are looked at together: those
// that come after them know what they found.
struct Hunt {
  static constexpr std::size_t kMostBlocks = 64;

  Hunt()
      : xs(kMostBlocks),
        ys(kMostBlocks),
        heights(kMostBlocks * kFallPositions),
        sums(kMostBlocks * kFallPositions) {
    blocks.reserve(kMostBlocks);
  }

  std::optional<Spot> best;
  double dearest = std::numeric_limits<double>::infinity();  // that is still worth a look

  std::vector<FallBlock> blocks;
  std::vector<Range> xs;  // of the block with the same heights
  std::vector<int> ys;
  std::vector<Height> heights;
  std::vector<std::int32_t> sums;

  std::size_t index_of(const FallBlock& block) const {
    return static_cast<std::size_t>(block.heights - heights.data()) / kFallPositions;
  }

  void offer(const Spot& spot) {
    best = spot;
    dearest = spot.cost + kRounding * std::abs(spot.cost);
  }
};

// All positions of one rotation.
class Scan {
 public:
  Scan(const TrayState& tray, const RotatedPart& part, int rotation, double volume_mm3,
       const TraySpec& spec, const PlaceRules& rules)
      : tray_(tray),
        part_(part),
        rotation_(rotation),
        spec_(spec),
        rating_(tray, part, volume_mm3, spec),
        xs_(positions(0, rules.x)),
        ys_(positions(1, rules.y)),
        highest_(rules.on_plate_only ? 0 : spec.ceiling() - part.rise) {
    if (!possible()) return;
    const int y = least_growth(ys_, tray.contents, part.box, spec.grid.cell_mm, 1);
    least_x_ = least_growth(xs_, tray.contents, part.box, spec.grid.cell_mm, 0);
    bound_ =
        std::min(least_bound(xs_, y, 0, 0), least_bound(xs_, std::max(y - 1, ys_.first), 0, 0));
  }

  bool possible() const { return !xs_.empty() && !ys_.empty() && part_.rise <= spec_.ceiling(); }
  // No position costs less.
  double bound() const { return bound_; }

  void run(Hunt& hunt) {
    limits_.assign(static_cast<std::size_t>(blocks_of_row()), highest_);
    hunt.blocks.clear();
    for (int y = ys_.first; y <= ys_.last; ++y)
      for (int block = 0; block < blocks_of_row(); ++block) {
        add_block(hunt, block, y);
        if (hunt.blocks.size() == Hunt::kMostBlocks) rate(hunt);
      }
    if (!hunt.blocks.empty()) rate(hunt);
  }

 private:
  Range positions(int axis, const Range& asked) const {
    const double cell_mm = spec_.grid.cell_mm;
    const Range inside = inside_tray(part_.box, spec_.build_mm, cell_mm, axis);
    return intersection(
        intersection(inside, up_to_bare_plate(tray_.contents, cell_mm, spec_.grid.growth(), axis)),
        asked);
  }

  // The bound at the best of these columns, in row y.
  double least_bound(const Range& xs, int y, Height z, std::int64_t waste) const {
    const int x = std::clamp(least_x_, xs.first, xs.last);
    const int before = std::clamp(least_x_ - 1, xs.first, xs.last);
    const double bound = rating_.bound(x, y, z, waste);
    return before == x ? bound : std::min(bound, rating_.bound(before, y, z, waste));
  }

  int blocks_of_row() const { return (xs_.count() + kFallPositions - 1) / kFallPositions; }

  // The greatest height at which a position of the block is worth a look; -1: none is. It is sought
  // from the one of the row before on, which is about the same.
  int limit(const Hunt& hunt, const Range& xs, int y, int known) const {
    if (!hunt.best) return highest_;
    const auto worth_it = [&](int z) {
      return least_bound(xs, y, static_cast<Height>(z), 0) <= hunt.dearest;
    };
    int low = -1;             // worth it, or below all
    int high = highest_ + 1;  // not worth it, or above all
    const bool rising = known < 0 || worth_it(known);
    (rising ? low : high) = known;
    for (int step = 1; low + 1 < high; step *= 2) {
      const int next = rising ? std::min(low + step, high - 1) : std::max(high - step, low + 1);
      const bool passes = worth_it(next);
      (passes ? low : high) = next;
      if (passes != rising) break;
    }
    while (low + 1 < high) {
      const int middle = low + (high - low) / 2;
      (worth_it(middle) ? low : high) = middle;
    }
    return low;
  }

  void add_block(Hunt& hunt, int block, int y) {
    const int first = xs_.first + block * kFallPositions;
    const Range xs{first, std::min(first + kFallPositions - 1, xs_.last)};
    int& known = limits_[static_cast<std::size_t>(block)];
    known = limit(hunt, xs, y, known);
    if (known < 0) return;
    const std::size_t index = hunt.blocks.size();
    Height* heights = &hunt.heights[index * kFallPositions];
    std::fill_n(heights, xs.count(), Height{0});
    std::fill_n(heights + xs.count(), kFallPositions - xs.count(), kNoPosition);
    hunt.blocks.push_back({&tray_.upper.origin()[y * tray_.upper.stride() + first], heights,
                           static_cast<Height>(known)});
    hunt.xs[index] = xs;
    hunt.ys[index] = y;
  }

  void rate(Hunt& hunt) {
    hunt.blocks.resize(fall(hunt.blocks, tray_.upper.stride(), part_.reach));
    for (FallBlock& block : hunt.blocks) {
      const std::size_t index = hunt.index_of(block);
      block.field =
          &tray_.surface.origin()[hunt.ys[index] * tray_.surface.stride() + hunt.xs[index].first];
    }
    sum_field(hunt.blocks, tray_.surface.stride(), part_.hang, hunt.sums.data());
    for (std::size_t b = 0; b < hunt.blocks.size(); ++b)
      rate(hunt, hunt.blocks[b], &hunt.sums[b * kFallPositions]);
    hunt.blocks.clear();
  }

  // With more waste than this, no position of the block that lies at z or higher is worth a look.
  // Sought from the last one on, which is about the same, and to a sixteenth.
  std::int64_t waste_limit(const Hunt& hunt, const Range& xs, int y, Height z) {
    const auto worth_it = [&](std::int64_t waste) {
      return least_bound(xs, y, z, waste) <= hunt.dearest;
    };
    std::int64_t& limit = waste_limit_;
    while (limit < kMostWaste && worth_it(limit)) limit += limit / 4 + 1;
    while (limit > 0 && !worth_it(limit / 2)) limit /= 2;
    while (limit > 0 && !worth_it(limit - limit / 16 - 1)) limit -= limit / 16 + 1;
    return limit;
  }

  void rate(Hunt& hunt, const FallBlock& block, const std::int32_t* sums) {
    const std::size_t index = hunt.index_of(block);
    const Range& xs = hunt.xs[index];
    const Height lowest = *std::min_element(block.heights, block.heights + xs.count());
    std::int64_t most_waste = kMostWaste;
    if (hunt.best) most_waste = waste_limit(hunt, xs, hunt.ys[index], lowest);
    for (int i = 0; i < xs.count(); ++i) {
      const Height z = block.heights[i];
      if (z > block.give_up_above) continue;
      const std::int64_t waste = rating_.waste(z, sums[i]);
      if (waste > most_waste) continue;
      Spot here{
          rotation_, xs.first + i, hunt.ys[index], z, 0, 0, static_cast<Height>(z + part_.rise)};
      here.cost = rating_.cost(here.x, here.y, z, waste);
      if (hunt.best && !(rank(here) < rank(*hunt.best))) continue;
      here.support_mm3 = part_.inside_support_mm3 + rating_.waste_mm3(waste);
      hunt.offer(here);
    }
  }

  static constexpr Height kNoPosition = std::numeric_limits<Height>::max();
  static constexpr std::int64_t kMostWaste = std::int64_t{1} << 40;

  const TrayState& tray_;
  const RotatedPart& part_;
  int rotation_;
  const TraySpec& spec_;
  Rating rating_;
  Range xs_;
  Range ys_;
  int highest_;
  int least_x_ = 0;
  double bound_ = 0;
  std::vector<int> limits_;  // by block of a row
  std::int64_t waste_limit_ = kMostWaste;
};

}  // namespace

std::optional<Spot> best_spot(const TrayState& tray, std::span<const RotatedPart* const> rotations,
                              double volume_mm3, const TraySpec& spec, const PlaceRules& rules) {
  std::vector<Scan> scans;
  scans.reserve(rotations.size());
  for (std::size_t i = 0; i < rotations.size(); ++i)
    scans.emplace_back(tray, *rotations[i], static_cast<int>(i), volume_mm3, spec, rules);
  // The most promising first: what they find rules out most of the others.
  std::vector<Scan*> order;
  for (Scan& scan : scans)
    if (scan.possible()) order.push_back(&scan);
  std::stable_sort(order.begin(), order.end(),
                   [](const Scan* a, const Scan* b) { return a->bound() < b->bound(); });
  Hunt hunt;
  for (Scan* scan : order)
    if (scan->bound() <= hunt.dearest) scan->run(hunt);
  return hunt.best;
}

}  // namespace packmerger
