#include "pack/free/limit_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace packmerger {
namespace {

constexpr double kLeastShrink = 0.005;  // of the height, to the next limit
constexpr double kMostShrink = 0.03;
constexpr std::size_t kFewRounds = 100;  // after which the limit falls further than the last time
constexpr double kDrawAgain = 0.93;      // when the limit fell by so much
constexpr int kGreedyStarts = 6;
constexpr std::uint64_t kGreedySteps = 1'000'000'000;  // after which none begins
constexpr std::size_t kMostOthers = 5;                 // taken out in a round
constexpr double kNearShare = 0.7;                     // of the rounds take neighbours
constexpr double kWaysShare = 0.6;                     // of the rotations are tried
constexpr double kNoise_mm = 2;
constexpr double kSlope = 0.02;    // mm a cell
constexpr double kGrowth = 1.003;  // of the weight of what found no place, a round
constexpr double kMostWeight = 50;
constexpr double kAboutSame = 1 + 1e-9;
constexpr double kRounding = 1e-9;        // mm
constexpr std::uint64_t kStepsOfRun = 3;  // that lower_place looks at
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::size_t index(int part) { return static_cast<std::size_t>(part); }

}  // namespace

LimitSearch::LimitSearch(FreeParts parts, const Vec2& base_mm, const Plate& plate, double apart_mm,
                         const std::vector<Pose>& start, double start_height_mm, std::uint64_t seed,
                         std::function<bool()> is_over, Effort& effort)
    : base_mm_(base_mm),
      apart_mm_(apart_mm),
      random_(seed),
      is_over_(std::move(is_over)),
      effort_(effort),
      layout_(std::move(parts), base_mm, plate, apart_mm, start),
      is_drawn_(layout_.draw(start_height_mm + apart_mm, is_over_, effort_)),
      limit_mm_(start_height_mm + apart_mm),
      drawn_for_mm_(limit_mm_),
      shrink_(kLeastShrink),
      weight_(start.size(), 1) {
  for (int part = 0; part < static_cast<int>(start.size()); ++part)
    size_.push_back(layout_.shape(part).volume_mm3 * layout_.shape(part).radius_mm);
  if (is_drawn_) begin(start);
}

// The best of some layouts that are put together at once, or what the given one is on the lattice.
void LimitSearch::begin(const std::vector<Pose>& start) {
  std::vector<LatticeLayout::Put> best;
  double height = limit_mm_;
  const std::uint64_t began = effort_.spent();
  for (int i = 0; i < kGreedyStarts && effort_.spent() < began + kGreedySteps; ++i) {
    if (!greedy(i == 0)) continue;
    const double top = layout_.highest_mm();
    if (top >= height) continue;
    height = top;
    best = layout_.puts();
  }
  if (best.empty()) {
    layout_.put_nearest(layout_.nearest(start), layout_.grid().unit_mm, limit_mm_);
    return;
  }
  layout_.take_all();
  for (int part = 0; part < static_cast<int>(best.size()); ++part)
    layout_.put(part, best[index(part)]);
}

bool LimitSearch::greedy(bool largest_first) {
  layout_.take_all();
  std::vector<double> keys;
  for (const double size : size_)
    keys.push_back(size * (1 + (largest_first ? 0 : 0.7 * random_.unit())));
  std::vector<int> order(keys.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return keys[index(a)] > keys[index(b)]; });
  return std::all_of(order.begin(), order.end(),
                     [&](int part) { return !is_over_() && put_back(part, 0, 1e-3, 1.1e-3, 1); });
}

bool LimitSearch::next(const std::function<bool()>& is_over) {
  while (is_drawn_ && !layout_.unplaced().empty()) {
    if (is_over_() || is_over()) return false;
    round();
  }
  return is_drawn_;
}

void LimitSearch::round() {
  ++rounds_;
  std::vector<int> taken = layout_.unplaced();
  std::vector<char> is_taken(layout_.size(), 0);
  double lacking = 0;
  for (const int part : taken) {
    const auto i = index(part);
    is_taken[i] = 1;
    lacking += weight_[i] * layout_.shape(part).volume_mm3;
  }
  const int wanted = taken[random_.below(taken.size())];
  const std::vector<int> others = neighbours(1 + random_.below(kMostOthers), is_taken);
  for (const int part : others) layout_.take(part);
  taken.insert(taken.end(), others.begin(), others.end());
  const std::vector<LatticeLayout::Put> before = layout_.puts();

  const std::size_t order = random_.below(3);
  std::vector<double> keys(layout_.size(), 0);
  for (const int part : taken) {
    const auto i = index(part);
    if (order == 0)
      keys[i] = size_[i] * weight_[i];
    else if (order == 1)
      keys[i] = size_[i] * (0.4 + random_.unit());
    else
      keys[i] = part == wanted ? kInfinity : size_[i] * (0.5 + random_.unit());
  }
  std::stable_sort(taken.begin(), taken.end(),
                   [&](int a, int b) { return keys[index(a)] > keys[index(b)]; });
  // A part must not fall back to where it was.
  const auto slope = [this] {
    const double steep = kSlope * random_.unit();
    return random_.below(2) == 0 ? steep : -steep;
  };
  const double per_column_mm = slope();
  const double per_row_mm = slope();
  double left_out = 0;
  bool kept = true;
  for (const int part : taken) {
    if (put_back(part, kNoise_mm * random_.unit(), per_column_mm, per_row_mm, kWaysShare)) continue;
    const auto i = index(part);
    left_out += weight_[i] * layout_.shape(part).volume_mm3;
    kept = left_out <= lacking * kAboutSame;
    if (!kept) break;
  }
  if (!kept) {
    for (const int part : taken)
      if (layout_.is_placed(part)) layout_.take(part);
    for (const int part : others) layout_.put(part, before[index(part)]);
  }
  double heaviest = 0;
  for (std::size_t i = 0; i < weight_.size(); ++i) {
    if (!layout_.is_placed(static_cast<int>(i))) weight_[i] *= kGrowth;
    heaviest = std::max(heaviest, weight_[i]);
  }
  if (heaviest > kMostWeight)
    for (double& weight : weight_) weight = std::max(1.0, weight / 5);
}

std::vector<int> LimitSearch::neighbours(std::size_t count, const std::vector<char>& taken) {
  std::vector<std::pair<double, int>> rated;
  // One after the other: compilers differ in which argument of a call they draw first.
  Vec3 point;
  point.z() = random_.unit() * limit_mm_;
  point.y() = random_.unit() * base_mm_.y();
  point.x() = random_.unit() * base_mm_.x();
  const bool near = random_.unit() < kNearShare;
  for (std::size_t i = 0; i < layout_.size(); ++i) {
    if (taken[i] != 0) continue;
    const double chance = random_.unit();
    const int part = static_cast<int>(i);
    rated.emplace_back(
        near ? (layout_.pose(part).translation() - point).norm() * (0.6 + 0.8 * chance) : chance,
        part);
  }
  count = std::min(count, rated.size());
  std::partial_sort(rated.begin(), rated.begin() + static_cast<std::ptrdiff_t>(count), rated.end());
  std::vector<int> chosen;
  for (std::size_t k = 0; k < count; ++k) chosen.push_back(rated[k].second);
  return chosen;
}

bool LimitSearch::put_back(int part, double noise_mm, double per_column_mm, double per_row_mm,
                           double share) {
  const std::size_t ways = layout_.ways(part);
  const std::size_t first = random_.below(ways);
  RatedPlace best{{}, kInfinity};
  std::size_t best_way = 0;
  for (std::size_t k = 0; k < ways; ++k) {
    if (k > 0 && share < 1 && random_.unit() > share) continue;
    const std::size_t way = (first + k) % ways;
    const double malus_mm = noise_mm > 0 ? noise_mm * random_.unit() : 0;
    if (layout_.lower(part, way,
                      {limit_mm_, layout_.grid().unit_mm, malus_mm, per_column_mm, per_row_mm},
                      best))
      best_way = way;
  }
  effort_.spend(kStepsOfRun * best.looked);
  if (best.rating_mm == kInfinity) return false;
  layout_.put(part, {best_way, best.place});
  return true;
}

void LimitSearch::lower_limit() {
  const double height = layout_.highest_mm();
  shrink_ = rounds_ < kFewRounds ? std::min(kMostShrink, 2 * shrink_) : kLeastShrink;
  rounds_ = 0;
  limit_mm_ = height * (1 - shrink_);
  std::fill(weight_.begin(), weight_.end(), 1.0);
  if (height < kDrawAgain * drawn_for_mm_) {
    drawn_for_mm_ = height;
    const double old_unit_mm = layout_.grid().unit_mm;
    const std::vector<LatticeLayout::Put> puts = layout_.puts();
    is_drawn_ = layout_.draw(height, is_over_, effort_);
    if (is_drawn_) layout_.put_nearest(puts, old_unit_mm, limit_mm_);
    return;
  }
  for (int part = 0; part < static_cast<int>(layout_.size()); ++part)
    if (layout_.top_mm(part) > limit_mm_ + kRounding) layout_.take(part);
}

void LimitSearch::take_out(const std::vector<int>& parts) {
  for (const int part : parts)
    if (layout_.is_placed(part)) layout_.take(part);
}

double LimitSearch::height_mm() const { return layout_.highest_mm() - apart_mm_; }

std::vector<Pose> LimitSearch::poses() const {
  std::vector<Pose> poses;
  for (int part = 0; part < static_cast<int>(layout_.size()); ++part)
    poses.push_back(layout_.pose(part));
  return poses;
}

}  // namespace packmerger
