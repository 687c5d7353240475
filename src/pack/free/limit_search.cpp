#include "pack/free/limit_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/parallel.h"
#include "pack/free/lattice.h"

namespace packmerger {
namespace {

constexpr double kLeastShrink = 0.005;  // of the height, to the next limit
constexpr double kMostShrink = 0.03;
constexpr std::size_t kFewRounds = 100;  // after which the limit falls further than the last time
constexpr double kDrawAgain = 0.93;      // when the limit fell by so much
// Cut faces of segments stand at any angle to the model's axes. With many parts, twice the
// rotations cost more rounds than they are worth.
constexpr std::size_t kFewParts = 16;
constexpr int kGreedyStarts = 6;
constexpr int kMostMovedUnits = 3;      // where the lattice changes
constexpr std::size_t kMostOthers = 5;  // taken out in a round
constexpr double kNearShare = 0.7;      // of the rounds take neighbours
constexpr double kWaysShare = 0.6;      // of the rotations are tried
constexpr double kNoise_mm = 2;
constexpr double kSlope = 0.02;    // mm a cell
constexpr double kGrowth = 1.003;  // of the weight of what found no place, a round
constexpr double kMostWeight = 50;
constexpr double kAboutSame = 1 + 1e-9;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

LimitSearch::LimitSearch(FreeParts parts, const Vec2& base_mm, const Plate& plate, double apart_mm,
                         const std::vector<Pose>& start, double start_height_mm, std::uint64_t seed)
    : parts_(std::move(parts)),
      base_mm_(base_mm),
      apart_mm_(apart_mm),
      random_(seed),
      grid_(lattice_for(parts_.shapes, base_mm, apart_mm, start_height_mm + apart_mm)),
      bare_(tray_with_walls(grid_, plate, apart_mm)),
      tray_(bare_),
      limit_mm_(start_height_mm + apart_mm),
      drawn_for_mm_(limit_mm_),
      shrink_(kLeastShrink),
      puts_(parts_.shapes.size()),
      placed_(parts_.shapes.size(), 0),
      weight_(parts_.shapes.size(), 1) {
  for (std::size_t i = 0; i < parts_.shapes.size(); ++i) {
    const Shape* shape = parts_.shapes[i];
    const auto known = std::find(different_.begin(), different_.end(), shape);
    shape_of_.push_back(static_cast<std::size_t>(known - different_.begin()));
    if (known == different_.end()) {
      different_.push_back(shape);
      ways_.push_back(parts_.rotations);
    }
    std::vector<Mat3>& ways = ways_[shape_of_.back()];
    if (parts_.shapes.size() > kFewParts)
      ways.push_back(start[i].linear());
    else
      for (const Mat3& rotation : parts_.rotations) ways.push_back(rotation * start[i].linear());
    size_.push_back(shape->volume_mm3 * shape->radius_mm);
  }
  draw();
  begin(start);
}

// Rotations that the lattice cannot tell from an earlier one are dropped, at the first drawing.
void LimitSearch::draw() {
  const bool first = drawn_.empty();
  drawn_.resize(different_.size());
  parallel_tasks(different_.size(), [&](std::size_t s) {
    std::vector<BitPart> parts(ways_[s].size());
    parallel_tasks(parts.size(), [&](std::size_t way) {
      parts[way] = bit_part(*different_[s], ways_[s][way], grid_, apart_mm_);
    });
    if (!first) {
      drawn_[s] = std::move(parts);
      return;
    }
    std::vector<Mat3> kept;
    for (std::size_t way = 0; way < parts.size(); ++way) {
      const bool is_twin =
          std::any_of(drawn_[s].begin(), drawn_[s].end(), [&](const BitPart& other) {
            return other.width == parts[way].width && other.depth == parts[way].depth &&
                   std::abs(other.height_mm - parts[way].height_mm) < grid_.unit_mm / 10 &&
                   other.runs == parts[way].runs;
          });
      if (is_twin) continue;
      kept.push_back(ways_[s][way]);
      drawn_[s].push_back(std::move(parts[way]));
    }
    ways_[s] = std::move(kept);
  });
}

// The best of some layouts that are put together at once, or what the given one is on the lattice.
void LimitSearch::begin(const std::vector<Pose>& start) {
  std::vector<Put> best;
  double height = limit_mm_;
  for (int i = 0; i < kGreedyStarts; ++i) {
    if (!greedy(i == 0)) continue;
    const double top = highest_mm();
    if (top >= height) continue;
    height = top;
    best = puts_;
  }
  if (!best.empty()) {
    tray_ = bare_;
    puts_ = best;
    for (std::size_t i = 0; i < puts_.size(); ++i) fill(static_cast<int>(i));
    return;
  }
  std::vector<Put> puts(puts_.size());
  for (std::size_t i = 0; i < puts.size(); ++i) {
    const std::vector<BitPart>& ways = drawn_[shape_of_[i]];
    std::size_t nearest = 0;
    for (std::size_t way = 1; way < ways.size(); ++way)
      if ((ways[way].rotation - start[i].linear()).norm() <
          (ways[nearest].rotation - start[i].linear()).norm())
        nearest = way;
    const Vec3 at = start[i].translation() - ways[nearest].origin + Vec3::Constant(apart_mm_ / 2);
    const auto cell = [](double mm, double size_mm) {
      return static_cast<int>(std::lround(mm / size_mm));
    };
    puts[i] = {
        nearest,
        {std::clamp(cell(at.x(), grid_.cell_mm), 0,
                    std::max(0, grid_.columns - ways[nearest].width)),
         std::clamp(cell(at.y(), grid_.cell_mm), 0, std::max(0, grid_.rows - ways[nearest].depth)),
         cell(at.z(), grid_.unit_mm)}};
  }
  put_nearest(puts, grid_.unit_mm);
}

bool LimitSearch::greedy(bool largest_first) {
  tray_ = bare_;
  std::fill(placed_.begin(), placed_.end(), 0);
  std::vector<double> keys;
  for (const double size : size_)
    keys.push_back(size * (1 + (largest_first ? 0 : 0.7 * random_.unit())));
  std::vector<int> order(keys.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return keys[static_cast<std::size_t>(a)] > keys[static_cast<std::size_t>(b)];
  });
  return std::all_of(order.begin(), order.end(),
                     [&](int part) { return put_back(part, 0, 1e-3, 1.1e-3, 1); });
}

// Where they were, as high as they were or nearly so; what has no room there stays out.
void LimitSearch::put_nearest(const std::vector<Put>& puts, double old_unit_mm) {
  tray_ = bare_;
  std::fill(placed_.begin(), placed_.end(), 0);
  std::vector<int> parts(puts.size());
  std::iota(parts.begin(), parts.end(), 0);
  std::stable_sort(parts.begin(), parts.end(), [&](int a, int b) {
    return puts[static_cast<std::size_t>(a)].place.z < puts[static_cast<std::size_t>(b)].place.z;
  });
  for (const int part : parts) {
    Put put = puts[static_cast<std::size_t>(part)];
    puts_[static_cast<std::size_t>(part)] = put;
    const BitPart& bits = drawn(part, put.way);
    if (bits.runs.empty() || put.place.x + bits.width > grid_.columns ||
        put.place.y + bits.depth > grid_.rows)
      continue;
    const double wanted = put.place.z * old_unit_mm / grid_.unit_mm;
    const std::uint64_t taken = tray_.taken(bits, put.place.x, put.place.y);
    double nearest = kMostMovedUnits;
    int chosen = -1;
    for (int z = 0; z < kHeights; ++z) {
      if (((taken >> z) & 1) != 0 || z * grid_.unit_mm + bits.height_mm > limit_mm_ + 1e-9)
        continue;
      if (std::abs(z - wanted) >= nearest) continue;
      nearest = std::abs(z - wanted);
      chosen = z;
    }
    if (chosen < 0) continue;
    put.place.z = chosen;
    puts_[static_cast<std::size_t>(part)] = put;
    fill(part);
  }
}

bool LimitSearch::next(const std::function<bool()>& is_over) {
  while (!unplaced().empty()) {
    if (is_over()) return false;
    round();
  }
  return true;
}

void LimitSearch::round() {
  ++rounds_;
  std::vector<int> taken = unplaced();
  std::vector<char> is_taken(puts_.size(), 0);
  double lacking = 0;
  for (const int part : taken) {
    const auto i = static_cast<std::size_t>(part);
    is_taken[i] = 1;
    lacking += weight_[i] * parts_.shapes[i]->volume_mm3;
  }
  const int wanted = taken[random_.below(taken.size())];
  const std::vector<int> others = neighbours(1 + random_.below(kMostOthers), is_taken);
  for (const int part : others) clear(part);
  taken.insert(taken.end(), others.begin(), others.end());
  const std::vector<Put> before = puts_;

  const std::size_t order = random_.below(3);
  std::vector<double> keys(puts_.size(), 0);
  for (const int part : taken) {
    const auto i = static_cast<std::size_t>(part);
    if (order == 0)
      keys[i] = size_[i] * weight_[i];
    else if (order == 1)
      keys[i] = size_[i] * (0.4 + random_.unit());
    else
      keys[i] = part == wanted ? kInfinity : size_[i] * (0.5 + random_.unit());
  }
  std::stable_sort(taken.begin(), taken.end(), [&](int a, int b) {
    return keys[static_cast<std::size_t>(a)] > keys[static_cast<std::size_t>(b)];
  });
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
    const auto i = static_cast<std::size_t>(part);
    left_out += weight_[i] * parts_.shapes[i]->volume_mm3;
    kept = left_out <= lacking * kAboutSame;
    if (!kept) break;
  }
  if (!kept) {
    for (const int part : taken)
      if (placed_[static_cast<std::size_t>(part)] != 0) clear(part);
    puts_ = before;
    for (const int part : others) fill(part);
  }
  double heaviest = 0;
  for (std::size_t i = 0; i < weight_.size(); ++i) {
    if (placed_[i] == 0) weight_[i] *= kGrowth;
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
  for (std::size_t i = 0; i < puts_.size(); ++i) {
    if (taken[i] != 0) continue;
    const double chance = random_.unit();
    const int part = static_cast<int>(i);
    rated.emplace_back(near ? (middle(part) - point).norm() * (0.6 + 0.8 * chance) : chance, part);
  }
  count = std::min(count, rated.size());
  std::partial_sort(rated.begin(), rated.begin() + static_cast<std::ptrdiff_t>(count), rated.end());
  std::vector<int> chosen;
  for (std::size_t k = 0; k < count; ++k) chosen.push_back(rated[k].second);
  return chosen;
}

bool LimitSearch::put_back(int part, double noise_mm, double per_column_mm, double per_row_mm,
                           double share) {
  const auto i = static_cast<std::size_t>(part);
  const std::size_t ways = drawn_[shape_of_[i]].size();
  const std::size_t first = random_.below(ways);
  RatedPlace best{{}, kInfinity};
  std::size_t best_way = 0;
  for (std::size_t k = 0; k < ways; ++k) {
    if (k > 0 && share < 1 && random_.unit() > share) continue;
    const std::size_t way = (first + k) % ways;
    const double malus_mm = noise_mm > 0 ? noise_mm * random_.unit() : 0;
    if (lower_place(tray_, drawn(part, way),
                    {limit_mm_, grid_.unit_mm, malus_mm, per_column_mm, per_row_mm}, best))
      best_way = way;
  }
  if (best.rating_mm == kInfinity) return false;
  puts_[i] = {best_way, best.place};
  fill(part);
  return true;
}

void LimitSearch::lower_limit() {
  const double height = highest_mm();
  shrink_ = rounds_ < kFewRounds ? std::min(kMostShrink, 2 * shrink_) : kLeastShrink;
  rounds_ = 0;
  limit_mm_ = height * (1 - shrink_);
  std::fill(weight_.begin(), weight_.end(), 1.0);
  if (height < kDrawAgain * drawn_for_mm_) {
    drawn_for_mm_ = height;
    const double old_unit_mm = grid_.unit_mm;
    grid_.unit_mm = lattice_for(parts_.shapes, base_mm_, apart_mm_, height).unit_mm;
    draw();
    put_nearest(std::vector<Put>(puts_), old_unit_mm);
    return;
  }
  for (std::size_t i = 0; i < puts_.size(); ++i)
    if (top_mm(static_cast<int>(i)) > limit_mm_ + 1e-9) clear(static_cast<int>(i));
}

void LimitSearch::take_out(const std::vector<int>& parts) {
  for (const int part : parts)
    if (placed_[static_cast<std::size_t>(part)] != 0) clear(part);
}

void LimitSearch::fill(int part) {
  const auto i = static_cast<std::size_t>(part);
  const auto& [way, place] = puts_[i];
  tray_.fill(drawn(part, way), place.x, place.y, place.z);
  placed_[i] = 1;
}

void LimitSearch::clear(int part) {
  const auto i = static_cast<std::size_t>(part);
  const auto& [way, place] = puts_[i];
  tray_.clear(drawn(part, way), place.x, place.y, place.z);
  placed_[i] = 0;
}

const BitPart& LimitSearch::drawn(int part, std::size_t way) const {
  return drawn_[shape_of_[static_cast<std::size_t>(part)]][way];
}

double LimitSearch::top_mm(int part) const {
  const auto& [way, place] = puts_[static_cast<std::size_t>(part)];
  return place.z * grid_.unit_mm + drawn(part, way).height_mm;
}

double LimitSearch::highest_mm() const {
  double highest = 0;
  for (std::size_t i = 0; i < puts_.size(); ++i)
    highest = std::max(highest, top_mm(static_cast<int>(i)));
  return highest;
}

double LimitSearch::height_mm() const { return highest_mm() - apart_mm_; }

Vec3 LimitSearch::middle(int part) const { return pose(part).translation(); }

Pose LimitSearch::pose(int part) const {
  const auto& [way, place] = puts_[static_cast<std::size_t>(part)];
  const BitPart& bits = drawn(part, way);
  Pose pose = Pose::Identity();
  pose.linear() = bits.rotation;
  pose.translation() =
      bits.origin - Vec3::Constant(apart_mm_ / 2) +
      Vec3(place.x * grid_.cell_mm, place.y * grid_.cell_mm, place.z * grid_.unit_mm);
  return pose;
}

std::vector<Pose> LimitSearch::poses() const {
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < puts_.size(); ++i) poses.push_back(pose(static_cast<int>(i)));
  return poses;
}

std::vector<int> LimitSearch::unplaced() const {
  std::vector<int> parts;
  for (std::size_t i = 0; i < placed_.size(); ++i)
    if (placed_[i] == 0) parts.push_back(static_cast<int>(i));
  return parts;
}

}  // namespace packmerger
