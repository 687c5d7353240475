#include "pack/drop/place.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>
#include <vector>

#include "pack/drop/fall.h"
#include "pack/drop/pooled_field.h"
#include "pack/drop/rating.h"

namespace packmerger {
namespace {

constexpr double kRounding = 1e-12;  // of a cost: bounds and costs may round differently

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

  std::optional<PooledField> pooled;  // of the tray; made when it is asked for
  std::vector<FallBlock> group_blocks;
  std::vector<HeightCell> group_cells;
  std::vector<Height> group_heights;

  std::optional<Spot> best;
  double dearest = std::numeric_limits<double>::infinity();  // that is still worth a look

  std::vector<FallBlock> blocks;
  std::vector<Range> xs;  // of the block with the same heights
  std::vector<int> ys;
  std::vector<Height> heights;
  std::vector<std::int64_t> sums;

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
    least_x_ = least_growth(xs_, tray.contents, part.box, spec.grid.cell_mm, 0);
    least_y_ = least_growth(ys_, tray.contents, part.box, spec.grid.cell_mm, 1);
    bound_ = least_bound(xs_, ys_, 0, 0);
  }

  bool possible() const { return !xs_.empty() && !ys_.empty() && part_.rise <= spec_.ceiling(); }
  // No position costs less.
  double bound() const { return bound_; }

  void run(Hunt& hunt) {
    limits_.assign(static_cast<std::size_t>(blocks_of_row()), highest_);
    hunt.blocks.clear();
    bound_groups(hunt);
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
    // Beside a wall the bare plate may not be free.
    const Range useful = part_.barred.empty()
                             ? up_to_bare_plate(tray_.contents, cell_mm, spec_.grid.growth(), axis)
                             : kAllCells;
    return intersection(intersection(inside, useful), asked);
  }

  // The bound at the best of these positions.
  double least_bound(const Range& xs, const Range& ys, Height z, std::int64_t waste) const {
    double least = std::numeric_limits<double>::infinity();
    const Range x = where_least(xs, least_x_);
    const Range y = where_least(ys, least_y_);
    for (int row = y.first; row <= y.last; ++row)
      for (int column = x.first; column <= x.last; ++column)
        least = std::min(least, rating_.bound(column, row, z, waste));
    return least;
  }

  // Of a range: where the contents grow least, given where they do so of all; one of the two.
  static Range where_least(const Range& range, int least) {
    return {std::clamp(least - 1, range.first, range.last),
            std::clamp(least, range.first, range.last)};
  }

  int blocks_of_row() const { return (xs_.count() + kFallPositions - 1) / kFallPositions; }

  // The greatest height at which one of the positions is worth a look; -1: none is. It is sought
  // from a known one on, which is about the same.
  int limit(const Hunt& hunt, const Range& xs, const Range& ys, int known) const {
    if (!hunt.best) return highest_;
    const auto worth_it = [&](int z) {
      return least_bound(xs, ys, static_cast<Height>(z), 0) <= hunt.dearest;
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

  int groups_of_row() const { return (xs_.count() + kPool - 1) / kPool; }
  // Heights of groups from one row of groups to the next: whole blocks.
  int group_stride() const {
    return (groups_of_row() + kFallPositions - 1) / kFallPositions * kFallPositions;
  }

  // Bounds the heights at groups of positions by a few cells of the part on the pooled field.
  void bound_groups(Hunt& hunt) {
    const int rows = (ys_.count() + kPool - 1) / kPool;
    hunt.group_heights.assign(static_cast<std::size_t>(rows * group_stride()), 0);
    if (!hunt.best || blocks_of_row() * ys_.count() < kManyBlocks) return;
    if (!hunt.pooled) hunt.pooled.emplace(tray_.upper);
    hunt.group_cells.clear();
    for (std::size_t i = 0; i < (part_.reach.size() + kCellsOfGroups - 1) / kCellsOfGroups; ++i)
      hunt.group_cells.push_back(hunt.pooled->cell(part_.reach[i], xs_.first));
    hunt.group_blocks.clear();
    int known = highest_;
    for (int row = 0; row < rows; ++row) {
      Height* of_row = &hunt.group_heights[static_cast<std::size_t>(row * group_stride())];
      std::fill(of_row + groups_of_row(), of_row + group_stride(), kNoPosition);
      const int y = ys_.first + row * kPool;
      const Range ys{y, std::min(y + kPool - 1, ys_.last)};
      for (int group = 0; group < groups_of_row(); group += kFallPositions) {
        const int x = xs_.first + group * kPool;
        const Range xs{x, std::min(x + kFallPositions * kPool - 1, xs_.last)};
        known = limit(hunt, xs, ys, known);
        if (known >= 0)
          hunt.group_blocks.push_back(
              {hunt.pooled->row(y) + group, of_row + group, static_cast<Height>(known)});
        else
          std::fill_n(of_row + group, kFallPositions, kNoPosition);
      }
    }
    fall(hunt.group_blocks, hunt.pooled->stride(), hunt.group_cells);
  }

  void add_block(Hunt& hunt, int block, int y) {
    static_assert(kFallPositions % kPool == 0);
    const int first = xs_.first + block * kFallPositions;
    const Range xs{first, std::min(first + kFallPositions - 1, xs_.last)};
    const Height* groups = &hunt.group_heights[static_cast<std::size_t>(
        (y - ys_.first) / kPool * group_stride() + block * kFallPositions / kPool)];
    const Height least = *std::min_element(groups, groups + kFallPositions / kPool);
    if (least > highest_) return;
    int& known = limits_[static_cast<std::size_t>(block)];
    known = limit(hunt, xs, {y, y}, known);
    if (known < least) return;
    const std::size_t index = hunt.blocks.size();
    Height* heights = &hunt.heights[index * kFallPositions];
    for (int i = 0; i < kFallPositions; ++i) heights[i] = groups[i / kPool];
    std::fill_n(heights + xs.count(), kFallPositions - xs.count(), kNoPosition);
    if (!part_.barred.empty()) {
      for (int i = 0; i < xs.count(); ++i)
        if (part_.barred.at(first + i, y)) heights[i] = kNoPosition;
    }
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
      return least_bound(xs, {y, y}, z, waste) <= hunt.dearest;
    };
    std::int64_t& limit = waste_limit_;
    while (limit < kMostWaste && worth_it(limit)) limit += limit / 4 + 1;
    while (limit > 0 && !worth_it(limit / 2)) limit /= 2;
    while (limit > 0 && !worth_it(limit - limit / 16 - 1)) limit -= limit / 16 + 1;
    return limit;
  }

  void rate(Hunt& hunt, const FallBlock& block, const std::int64_t* sums) {
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

  static constexpr int kManyBlocks = 64;            // with fewer, groups take longer than they save
  static constexpr std::size_t kCellsOfGroups = 8;  // one of so many: the decisive ones
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
  int least_y_ = 0;
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
