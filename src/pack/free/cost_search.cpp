#include "pack/free/cost_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "base/parallel.h"
#include "pack/lattice/lattice.h"

namespace packmerger {
namespace {

constexpr int kNearby = 2;         // cells: what the lattice finds too close is put so far aside
constexpr int kNearbyHeights = 4;  // units
constexpr std::size_t kMostWays = 200;  // of a shape
constexpr std::size_t kMostOut = 3;     // in a round
constexpr double kNearShare = 0.7;      // of the rounds take neighbours
constexpr std::size_t kWaysTried = 12;
constexpr std::size_t kBetterWays = 24;    // of these half of them
constexpr double kNoise = 0.003;           // of the cost, at most: on what a way costs
constexpr double kAccepted = 0.004;        // of the cost, at most: that a round may lose
constexpr std::size_t kRoundsAstray = 60;  // without a better layout, before it goes back
constexpr double kWorthTelling = 1e-5;     // of the cost: what patience calls cheaper
constexpr double kPreferred = 1e-7;        // of the cost, a cell: of equal places the first
constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

CostSearch::CostSearch(const PackProblem& problem, CostedParts parts,
                       const std::vector<Pose>& start, double limit_mm, double apart_mm,
                       std::uint64_t seed, std::function<bool()> is_over)
    : problem_(problem),
      parts_(std::move(parts)),
      apart_mm_(apart_mm),
      limit_mm_(limit_mm + apart_mm),
      random_(seed),
      is_over_(std::move(is_over)),
      grid_(lattice_for(parts_.shapes, problem.build_mm.head<2>(), apart_mm, limit_mm_)),
      tray_(tray_with_walls(grid_, problem.plate, apart_mm)),
      columns_(grid_),
      drawn_(parts_.shapes.size()),
      puts_(parts_.shapes.size()),
      placed_(parts_.shapes.size(), 0) {
  for (std::size_t i = 0; i < start.size(); ++i) {
    const auto first = std::find(parts_.shapes.begin(), parts_.shapes.end(), parts_.shapes[i]);
    shape_of_.push_back(static_cast<std::size_t>(first - parts_.shapes.begin()));
  }
  begin(start);
}

// The start, as nearly as the lattice has it; what has no room there is put where it is cheapest.
void CostSearch::begin(const std::vector<Pose>& start) {
  std::vector<std::size_t> homeless;
  for (std::size_t i = 0; i < start.size(); ++i)
    if (!put_near(i, start[i])) homeless.push_back(i);
  for (const std::size_t part : homeless) put_back(part, 0);
  here_ = worth();
  best_ = puts_;
  lowest_ = here_.left_out == 0 ? here_.cost : kInfinity;
}

// In the way it is in, which is entered as one more way of its shape where there is none like it.
bool CostSearch::put_near(std::size_t part, const Pose& start) {
  std::vector<Mat3>& ways = parts_.ways[shape_of_[part]];
  const Mat3& rotation = start.linear();
  const auto same = std::find_if(ways.begin(), ways.end(), [&](const Mat3& way) {
    return (way - rotation).cwiseAbs().maxCoeff() < 1e-9;
  });
  auto way = static_cast<std::size_t>(same - ways.begin());
  if (same == ways.end() && ways.size() < kMostWays) {
    ways.push_back(rotation);
  } else if (same == ways.end()) {
    const auto further = [&](const Mat3& a, const Mat3& b) {
      return (a - rotation).norm() < (b - rotation).norm();
    };
    way = static_cast<std::size_t>(std::min_element(ways.begin(), ways.end(), further) -
                                   ways.begin());
  }
  puts_[part].way = way;
  draw(part, {way});
  const BitPart& bits = drawn(part, way).bits;
  if (bits.runs.empty()) return false;
  const Vec3 wanted = start.translation() - bits.origin + Vec3::Constant(apart_mm_ / 2);
  const Vec3 cells(wanted.x() / grid_.cell_mm, wanted.y() / grid_.cell_mm,
                   wanted.z() / grid_.unit_mm);
  std::tuple<double, int, int, int> nearest{kInfinity, 0, 0, 0};
  for (int dy = -kNearby; dy <= kNearby; ++dy)
    for (int dx = -kNearby; dx <= kNearby; ++dx) {
      const int x = static_cast<int>(std::lround(cells.x())) + dx;
      const int y = static_cast<int>(std::lround(cells.y())) + dy;
      if (x < 0 || y < 0 || x + bits.width > grid_.columns || y + bits.depth > grid_.rows) continue;
      const std::uint64_t taken = tray_.taken(bits, x, y);
      for (int z = 0; z < kHeights && z * grid_.unit_mm + bits.height_mm <= limit_mm_; ++z) {
        if (((taken >> z) & 1) != 0 || std::abs(z - cells.z()) > kNearbyHeights) continue;
        const double aside = (at({x, y, z}) - wanted).norm();
        nearest = std::min(nearest, {aside, z, y, x});
      }
    }
  const auto& [aside, z, y, x] = nearest;
  if (aside == kInfinity) return false;
  enter(part, {way, {x, y, z}});
  return true;
}

void CostSearch::run(std::size_t patience) {
  std::size_t idle = 0;
  std::size_t astray = 0;
  double told = lowest_;
  while (idle < patience && !is_over_()) {
    ++idle;
    ++astray;
    if (round()) {
      astray = 0;
      if (!(lowest_ >= told * (1 - kWorthTelling))) {
        told = lowest_;
        idle = 0;
      }
    } else if (astray > kRoundsAstray && lowest_ < kInfinity) {
      astray = 0;
      take_over(best_, std::vector<char>(best_.size(), 1));
      here_ = worth();
    }
  }
}

// Whether the layout became the cheapest so far.
bool CostSearch::round() {
  const std::vector<Put> puts = puts_;
  const std::vector<char> placed = placed_;
  std::vector<std::size_t> out = chosen();
  for (const std::size_t part : out)
    if (placed_[part] != 0) take(part);
  std::vector<std::pair<double, std::size_t>> order;
  for (const std::size_t part : out)
    order.emplace_back(-parts_.shapes[part]->volume_mm3 * (0.3 + random_.unit()), part);
  std::sort(order.begin(), order.end());
  const double noise = kNoise * here_.cost * random_.unit();
  std::size_t left_out = 0;
  for (const auto& [key, part] : order)
    if (!put_back(part, noise) && ++left_out > here_.left_out) break;
  const double allowed = kAccepted * random_.unit() * random_.unit();
  const Worth now = worth();
  if (now.left_out < here_.left_out ||
      (now.left_out == here_.left_out && now.cost <= here_.cost * (1 + allowed)))
    here_ = now;
  else
    take_over(puts, placed);
  if (here_.left_out > 0 || here_.cost >= lowest_) return false;
  lowest_ = here_.cost;
  best_ = puts_;
  return true;
}

// What is taken out in a round: what has no place, and some more.
std::vector<std::size_t> CostSearch::chosen() {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < puts_.size(); ++i)
    if (placed_[i] == 0) out.push_back(i);
  const std::size_t wanted = std::min(puts_.size(), out.size() + 1 + random_.below(kMostOut));
  const std::size_t first = random_.below(puts_.size());
  const bool near = random_.unit() < kNearShare;
  const Vec3 middle = pose(first, puts_[first]).translation();
  std::vector<std::pair<double, std::size_t>> rated;
  for (std::size_t i = 0; i < puts_.size(); ++i) {
    const double chance = random_.unit();
    if (placed_[i] == 0) continue;
    rated.emplace_back(
        near ? (pose(i, puts_[i]).translation() - middle).norm() * (0.5 + chance) : chance, i);
  }
  std::sort(rated.begin(), rated.end());
  for (std::size_t k = 0; k < rated.size() && out.size() < wanted; ++k)
    out.push_back(rated[k].second);
  return out;
}

// Puts a part where the tray becomes cheapest, in one of some ways; noise: money.
bool CostSearch::put_back(std::size_t part, double noise) {
  const std::vector<std::size_t> ways = some_ways(part);
  draw(part, ways);
  columns_.pool();
  std::vector<CostedPlace> found(ways.size());
  parallel_tasks(ways.size(), [&](std::size_t k) {
    const SupportedPart& one = drawn(part, ways[k]);
    cheaper_place(tray_, columns_, one, place_costs(one), grid_.unit_mm, found[k]);
  });
  double least = kInfinity;
  std::size_t chosen = ways.size();
  for (std::size_t k = 0; k < ways.size(); ++k) {
    const double malus = noise * random_.unit();
    if (found[k].cost == kInfinity) continue;
    const SupportedPart& one = drawn(part, ways[k]);
    const Vec3 moved = at(found[k].place);
    Box3 box = contents_;
    box.extend(one.box.translated(moved));
    const double support = columns_.support_mm3() +
                           columns_.added_mm3(one, found[k].place.x, found[k].place.y, moved.z());
    const double cost =
        malus +
        cost_with(box, support, material_mm3_ + parts_.shapes[part]->volume_mm3, standing_ + 1);
    if (cost >= least) continue;
    least = cost;
    chosen = k;
  }
  if (chosen == ways.size()) return false;
  enter(part, {ways[chosen], found[chosen].place});
  return true;
}

// The one it was in, and others, the better ones more often.
std::vector<std::size_t> CostSearch::some_ways(std::size_t part) {
  const std::size_t all = parts_.ways[shape_of_[part]].size();
  std::vector<std::size_t> ways{puts_[part].way};
  for (std::size_t k = 1; k < std::min(kWaysTried, all); ++k) {
    const std::size_t among = random_.below(2) == 0 ? all : std::min(all, kBetterWays);
    const std::size_t way = random_.below(among);
    if (std::find(ways.begin(), ways.end(), way) == ways.end()) ways.push_back(way);
  }
  return ways;
}

PlaceCosts CostSearch::place_costs(const SupportedPart& part) const {
  const double support = columns_.support_mm3();
  const auto cost = [&](const Vec3& moved, int axis) {
    Box3 box = contents_;
    const Box3 there = part.box.translated(moved);
    if (box.isEmpty()) return 0.0;
    box.min()[axis] = std::min(box.min()[axis], there.min()[axis]);
    box.max()[axis] = std::max(box.max()[axis], there.max()[axis]);
    return cost_with(box, support, material_mm3_, standing_);
  };
  const double now = cost_with(contents_, support, material_mm3_, standing_);
  PlaceCosts costs;
  costs.per_mm3 = (cost_with(contents_, support + 1000, material_mm3_, standing_) - now) / 1000;
  const double preferred = kPreferred * now;
  // Where all around is bare, places further out are no better.
  const auto is_far = [&](const Vec3& moved, int axis) {
    if (axis == 2 || contents_.isEmpty() || !problem_.plate.is_whole()) return false;
    const Box3 there = part.box.translated(moved);
    const double far_mm = there.sizes()[axis] + apart_mm_;
    return there.min()[axis] > contents_.max()[axis] + far_mm ||
           there.max()[axis] < contents_.min()[axis] - far_mm;
  };
  const auto along = [&](int places, int axis) {
    std::vector<double> list;
    for (int k = 0; k < places; ++k) {
      BitPlace place;
      (axis == 0 ? place.x : axis == 1 ? place.y : place.z) = k;
      const double one = is_far(at(place), axis) ? kInfinity : cost(at(place), axis);
      list.push_back(std::max(0.0, one - now) + preferred * k);
    }
    return list;
  };
  costs.by_column = along(grid_.columns - part.bits.width + 1, 0);
  costs.by_row = along(grid_.rows - part.bits.depth + 1, 1);
  costs.by_height = along(
      static_cast<int>(std::floor((limit_mm_ - part.bits.height_mm) / grid_.unit_mm + 1e-6)) + 1,
      2);
  return costs;
}

void CostSearch::draw(std::size_t part, const std::vector<std::size_t>& ways) {
  auto& known = drawn_[shape_of_[part]];
  std::vector<std::size_t> missing;
  for (const std::size_t way : ways)
    if (known.try_emplace(way).second) missing.push_back(way);
  parallel_tasks(missing.size(), [&](std::size_t k) {
    known.at(missing[k]) = std::make_unique<SupportedPart>(
        supported_part(*parts_.shapes[part], parts_.ways[shape_of_[part]][missing[k]], grid_,
                       apart_mm_, problem_.support_angle));
  });
}

const SupportedPart& CostSearch::drawn(std::size_t part, std::size_t way) const {
  return *drawn_[shape_of_[part]].at(way);
}

void CostSearch::enter(std::size_t part, const Put& put) {
  const SupportedPart& one = drawn(part, put.way);
  const Vec3 moved = at(put.place);
  tray_.fill(one.bits, put.place.x, put.place.y, put.place.z);
  columns_.put(one, static_cast<int>(part), put.place.x, put.place.y, moved.z());
  puts_[part] = put;
  placed_[part] = 1;
  note_contents();
}

void CostSearch::take(std::size_t part) {
  const auto& [way, place] = puts_[part];
  const SupportedPart& one = drawn(part, way);
  tray_.clear(one.bits, place.x, place.y, place.z);
  columns_.take(one, static_cast<int>(part), place.x, place.y);
  placed_[part] = 0;
  note_contents();
}

void CostSearch::take_over(const std::vector<Put>& puts, const std::vector<char>& placed) {
  const auto stays = [&](std::size_t i) {
    const BitPlace& a = puts_[i].place;
    const BitPlace& b = puts[i].place;
    return placed_[i] != 0 && placed[i] != 0 && puts_[i].way == puts[i].way &&
           std::tie(a.x, a.y, a.z) == std::tie(b.x, b.y, b.z);
  };
  std::vector<std::size_t> moving;
  for (std::size_t i = 0; i < puts.size(); ++i)
    if (!stays(i)) moving.push_back(i);
  for (const std::size_t i : moving)
    if (placed_[i] != 0) take(i);
  for (const std::size_t i : moving) {
    puts_[i] = puts[i];
    if (placed[i] != 0) enter(i, puts[i]);
  }
}

void CostSearch::note_contents() {
  contents_ = Box3();
  material_mm3_ = 0;
  standing_ = 0;
  for (std::size_t i = 0; i < puts_.size(); ++i) {
    if (placed_[i] == 0) continue;
    contents_.extend(drawn(i, puts_[i].way).box.translated(at(puts_[i].place)));
    material_mm3_ += parts_.shapes[i]->volume_mm3;
    ++standing_;
  }
}

Vec3 CostSearch::at(const BitPlace& place) const {
  return {place.x * grid_.cell_mm, place.y * grid_.cell_mm, place.z * grid_.unit_mm};
}

Pose CostSearch::pose(std::size_t part, const Put& put) const {
  const BitPart& bits = drawn(part, put.way).bits;
  Pose pose = Pose::Identity();
  pose.linear() = bits.rotation;
  pose.translation() = bits.origin - Vec3::Constant(apart_mm_ / 2) + at(put.place);
  return pose;
}

double CostSearch::cost_with(const Box3& box, double support_mm3, double material_mm3,
                             int parts) const {
  if (box.isEmpty()) return 0;
  TrayMeasure measure;
  measure.size_mm = Vec3(box.sizes().x(), box.sizes().y(), box.max().z());
  measure.support_mm3 = std::max(0.0, support_mm3);
  measure.material_mm3 = material_mm3;
  measure.parts = parts;
  return problem_.cost.evaluate(measure);
}

CostSearch::Worth CostSearch::worth() const {
  return {puts_.size() - static_cast<std::size_t>(standing_),
          cost_with(contents_, columns_.support_mm3(), material_mm3_, standing_)};
}

std::vector<Pose> CostSearch::poses() const {
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < best_.size(); ++i) poses.push_back(pose(i, best_[i]));
  return poses;
}

}  // namespace packmerger
