#include "pack/lattice/lattice_layout.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/parallel.h"
#include "pack/lattice/lattice.h"

namespace packmerger {
namespace {

// Cut faces of segments stand at any angle to the model's axes. With many parts, twice the
// rotations cost more rounds than they are worth.
constexpr std::size_t kFewParts = 16;
constexpr int kMostStarts = 4;              // of a shape
constexpr double kAlike = 0.12;             // of two rotations' matrices: five degrees apart
constexpr int kMostMovedUnits = 3;          // where the lattice changes
constexpr double kRounding = 1e-9;          // mm
constexpr double kTwinUnits = 0.1;          // by which the heights of twins may differ
constexpr std::uint64_t kStepsOfCell = 10;  // of a drawing

std::size_t index(int part) { return static_cast<std::size_t>(part); }

}  // namespace

LatticeLayout::LatticeLayout(FreeParts parts, const Vec2& base_mm, const Plate& plate,
                             double apart_mm, const std::vector<Pose>& start)
    : parts_(std::move(parts)),
      apart_mm_(apart_mm),
      base_mm_(base_mm),
      grid_(lattice_for(parts_.shapes, base_mm, apart_mm, 1)),
      bare_(tray_with_walls(grid_, plate, apart_mm)),
      tray_(bare_),
      puts_(parts_.shapes.size()),
      placed_(parts_.shapes.size(), 0) {
  std::vector<int> starts;  // by shape
  for (std::size_t i = 0; i < parts_.shapes.size(); ++i) {
    const Shape* shape = parts_.shapes[i];
    const auto known = std::find(different_.begin(), different_.end(), shape);
    shape_of_.push_back(static_cast<std::size_t>(known - different_.begin()));
    if (known == different_.end()) {
      different_.push_back(shape);
      ways_.push_back(parts_.rotations);
      starts.push_back(0);
    }
    if (starts[shape_of_.back()]++ < kMostStarts) add_ways(shape_of_.back(), start[i].linear());
  }
}

void LatticeLayout::add_ways(std::size_t shape, const Mat3& start) {
  std::vector<Mat3>& ways = ways_[shape];
  const auto add = [&ways](const Mat3& way) {
    if (std::none_of(ways.begin(), ways.end(),
                     [&](const Mat3& known) { return (known - way).norm() < kAlike; }))
      ways.push_back(way);
  };
  if (parts_.shapes.size() > kFewParts)
    add(start);
  else
    for (const Mat3& rotation : parts_.rotations) add(rotation * start);
}

// Rotations that the lattice cannot tell from an earlier one are dropped, at the first drawing.
bool LatticeLayout::draw(double limit_mm, const std::function<bool()>& is_over, Effort& effort) {
  grid_ = lattice_for(parts_.shapes, base_mm_, apart_mm_, limit_mm);
  take_all();
  const bool first = drawn_.empty();
  drawn_.resize(different_.size());
  std::atomic<bool> is_whole = true;
  parallel_tasks(different_.size(), [&](std::size_t s) {
    std::vector<BitPart> parts(ways_[s].size());
    parallel_tasks(parts.size(), [&](std::size_t way) {
      if (!is_whole || is_over())
        is_whole = false;
      else
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
                   std::abs(other.height_mm - parts[way].height_mm) < kTwinUnits * grid_.unit_mm &&
                   other.runs == parts[way].runs;
          });
      if (is_twin) continue;
      kept.push_back(ways_[s][way]);
      drawn_[s].push_back(std::move(parts[way]));
    }
    ways_[s] = std::move(kept);
  });
  for (const std::vector<BitPart>& ways : drawn_)
    for (const BitPart& part : ways)
      effort.spend(static_cast<std::uint64_t>(part.width) * static_cast<std::uint64_t>(part.depth) *
                   static_cast<std::uint64_t>(part.height_mm / grid_.unit_mm + 1) * kStepsOfCell);
  return is_whole;
}

void LatticeLayout::put(int part, const Put& put) {
  puts_[index(part)] = put;
  tray_.fill(drawn(part, put.way), put.place.x, put.place.y, put.place.z);
  placed_[index(part)] = 1;
}

void LatticeLayout::take(int part) {
  const auto& [way, place] = puts_[index(part)];
  tray_.clear(drawn(part, way), place.x, place.y, place.z);
  placed_[index(part)] = 0;
}

void LatticeLayout::take_all() {
  tray_ = bare_;
  std::fill(placed_.begin(), placed_.end(), 0);
}

std::vector<LatticeLayout::Put> LatticeLayout::nearest(const std::vector<Pose>& poses) const {
  std::vector<Put> puts(puts_.size());
  for (std::size_t i = 0; i < puts.size(); ++i) {
    const std::vector<BitPart>& ways = drawn_[shape_of_[i]];
    const auto turned = [&](const BitPart& way) {
      return (way.rotation - poses[i].linear()).norm();
    };
    const auto way =
        std::min_element(ways.begin(), ways.end(),
                         [&](const BitPart& a, const BitPart& b) { return turned(a) < turned(b); });
    const Vec3 at = poses[i].translation() - way->origin + Vec3::Constant(apart_mm_ / 2);
    const auto cell = [](double mm, double size_mm) {
      return static_cast<int>(std::lround(mm / size_mm));
    };
    puts[i].way = static_cast<std::size_t>(way - ways.begin());
    puts[i].place = {
        std::clamp(cell(at.x(), grid_.cell_mm), 0, std::max(0, grid_.columns - way->width)),
        std::clamp(cell(at.y(), grid_.cell_mm), 0, std::max(0, grid_.rows - way->depth)),
        cell(at.z(), grid_.unit_mm)};
  }
  return puts;
}

void LatticeLayout::put_nearest(const std::vector<Put>& puts, double old_unit_mm, double limit_mm) {
  take_all();
  std::vector<int> parts(puts.size());
  std::iota(parts.begin(), parts.end(), 0);
  std::stable_sort(parts.begin(), parts.end(),
                   [&](int a, int b) { return puts[index(a)].place.z < puts[index(b)].place.z; });
  for (const int part : parts) {
    Put put = puts[index(part)];
    puts_[index(part)] = put;
    const BitPart& bits = drawn(part, put.way);
    if (bits.runs.empty() || put.place.x + bits.width > grid_.columns ||
        put.place.y + bits.depth > grid_.rows)
      continue;
    const double wanted = put.place.z * old_unit_mm / grid_.unit_mm;
    const std::uint64_t taken = tray_.taken(bits, put.place.x, put.place.y);
    double nearest = kMostMovedUnits;
    int chosen = -1;
    for (int z = 0; z < kHeights; ++z) {
      if (((taken >> z) & 1) != 0 || z * grid_.unit_mm + bits.height_mm > limit_mm + kRounding)
        continue;
      if (std::abs(z - wanted) >= nearest) continue;
      nearest = std::abs(z - wanted);
      chosen = z;
    }
    if (chosen < 0) continue;
    put.place.z = chosen;
    this->put(part, put);
  }
}

double LatticeLayout::top_mm(int part) const {
  const auto& [way, place] = puts_[index(part)];
  return place.z * grid_.unit_mm + drawn(part, way).height_mm;
}

double LatticeLayout::highest_mm() const {
  double highest = 0;
  for (std::size_t i = 0; i < puts_.size(); ++i)
    highest = std::max(highest, top_mm(static_cast<int>(i)));
  return highest;
}

Pose LatticeLayout::pose(int part) const {
  const auto& [way, place] = puts_[index(part)];
  const BitPart& bits = drawn(part, way);
  Pose pose = Pose::Identity();
  pose.linear() = bits.rotation;
  pose.translation() =
      bits.origin - Vec3::Constant(apart_mm_ / 2) +
      Vec3(place.x * grid_.cell_mm, place.y * grid_.cell_mm, place.z * grid_.unit_mm);
  return pose;
}

std::vector<int> LatticeLayout::unplaced() const {
  std::vector<int> parts;
  for (std::size_t i = 0; i < placed_.size(); ++i)
    if (placed_[i] == 0) parts.push_back(static_cast<int>(i));
  return parts;
}

}  // namespace packmerger
