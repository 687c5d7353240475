#include "pack/lattice/height_bits.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace packmerger {
namespace {

constexpr double kRounding = 1e-4;  // cells
// Of a pitch: by how much a distance may be wrong between the samples of its grid.
constexpr float kDoubt = 0.9F;
constexpr std::ptrdiff_t kReadAhead = 8;
constexpr std::array<int, 4> kStrides{8, 4, 2, 1};

BitRun run_of(int x, int y, int low, int high) {
  const auto length = static_cast<unsigned>(high - low);
  const int power = std::min(HeightBits::kPlanes - 1, static_cast<int>(std::bit_width(length)) - 1);
  return {static_cast<std::int16_t>(x), static_cast<std::int16_t>(y),
          static_cast<std::uint8_t>(low), static_cast<std::uint8_t>(high),
          static_cast<std::uint8_t>(power)};
}

// Spread over the part, and the long ones first: few of them rule out most places.
std::vector<BitRun> spread(const std::vector<BitRun>& runs) {
  std::vector<BitRun> ordered;
  std::vector<bool> taken(runs.size(), false);
  for (const int stride : kStrides) {
    const std::size_t first = ordered.size();
    for (std::size_t i = 0; i < runs.size(); ++i) {
      if (taken[i] || runs[i].x % stride != stride / 2 || runs[i].y % stride != stride / 2)
        continue;
      taken[i] = true;
      ordered.push_back(runs[i]);
    }
    std::stable_sort(
        ordered.begin() + static_cast<std::ptrdiff_t>(first), ordered.end(),
        [](const BitRun& a, const BitRun& b) { return a.high - a.low > b.high - b.low; });
  }
  return ordered;
}

// Which layers of a column hold matter. Distances tell how many layers on a surface can come at the
// soonest.
class Column {
 public:
  // up: one layer on, in the shape's frame.
  Column(const DistanceGrid& distances, const Vec3f& up, float unit_mm, float reach, int layers)
      : distances_(distances),
        up_(up),
        unit_mm_(unit_mm),
        reach_(reach),
        layers_(layers),
        doubt_(kDoubt * static_cast<float>(distances.pitch_mm())),
        parts_of_layer_(static_cast<int>(std::ceil(unit_mm / (2 * reach)))) {}

  // from: the middle of the lowest layer. By bit.
  std::uint64_t matter(const Vec3f& from) const {
    std::uint64_t bits = 0;
    int alike = 1;
    for (int z = 0; z <= layers_; z += alike) {
      const float here = lacking(from, static_cast<float>(z));
      alike = std::min(1 + sure_layers(here), std::max(1, layers_ - z));
      if (here <= 0)
        bits |= ((std::uint64_t{1} << alike) - 1) << z;
      else if (parts_of_layer_ > 1 && here < unit_mm_ + 2 * doubt_)
        bits |= thin_matter(from, z);
    }
    return bits & ((std::uint64_t{1} << layers_) - 1);
  }

 private:
  // Beyond the reach, at a height in layers; 0 and less: matter.
  float lacking(const Vec3f& from, float z) const { return distances_.at(from + z * up_) - reach_; }

  // How many more are of the same kind.
  int sure_layers(float lacking) const {
    if (lacking >= DistanceGrid::kFar - reach_) return 0;
    return std::max(0, static_cast<int>((std::abs(lacking) - doubt_) / unit_mm_));
  }

  // Below the middle of a layer, and above that of the one before: where neither holds any, what is
  // thinner counts in the layer in which most of it lies.
  std::uint64_t thin_matter(const Vec3f& from, int layer) const {
    if (lacking(from, static_cast<float>(layer - 1)) <= 0) return 0;
    float deepest = 0;
    std::uint64_t bit = 0;
    for (int k = 1; k < parts_of_layer_; ++k) {
      const float z =
          static_cast<float>(layer) - static_cast<float>(k) / static_cast<float>(parts_of_layer_);
      const float there = lacking(from, z);
      if (z < -0.5F || there > deepest || (there == deepest && bit != 0)) continue;
      deepest = there;
      bit = std::uint64_t{1} << std::min(static_cast<int>(z + 0.5F), layers_ - 1);
    }
    return bit;
  }

  const DistanceGrid& distances_;
  Vec3f up_;
  float unit_mm_;
  float reach_;
  int layers_;
  float doubt_;
  int parts_of_layer_;
};

}  // namespace

BitPart bit_part(const Shape& shape, const Mat3& rotation, const BitGrid& grid, double apart_mm) {
  Pose turn = Pose::Identity();
  turn.linear() = rotation;
  Box3 box = shape.surface.box(turn);
  const Vec3 growth = Vec3::Constant(apart_mm / 2);
  box = Box3(box.min() - growth, box.max() + growth);
  BitPart part;
  part.rotation = rotation;
  part.origin = -box.min();
  part.height_mm = box.sizes().z();
  const auto cells = [](double length_mm, double cell_mm) {
    return std::max(1, static_cast<int>(std::ceil(length_mm / cell_mm - kRounding)));
  };
  part.width = cells(box.sizes().x(), grid.cell_mm);
  part.depth = cells(box.sizes().y(), grid.cell_mm);
  const int layers = cells(box.sizes().z(), grid.unit_mm);
  if (layers >= kHeights) return part;
  const auto reach = static_cast<float>(apart_mm / 2 + kMatterReach * grid.cell_mm);
  const Mat3 back = rotation.transpose();
  const Vec3f up = (back * Vec3(0, 0, grid.unit_mm)).cast<float>();
  const Column column(shape.distances, up, static_cast<float>(grid.unit_mm), reach, layers);
  std::vector<BitRun> runs;
  for (int y = 0; y < part.depth; ++y)
    for (int x = 0; x < part.width; ++x) {
      const Vec3 lowest =
          box.min() + Vec3((x + 0.5) * grid.cell_mm, (y + 0.5) * grid.cell_mm, 0.5 * grid.unit_mm);
      const std::uint64_t matter = column.matter((back * lowest).cast<float>());
      for (int low = 0; low < layers;) {
        low += std::countr_zero(matter >> low);
        if (low >= layers) break;
        const int high = low + std::countr_one(matter >> low);
        runs.push_back(run_of(x, y, low, high));
        low = high;
      }
    }
  part.runs = spread(runs);
  return part;
}

HeightBits::HeightBits(const BitGrid& grid)
    : columns_(grid.columns), rows_(grid.rows), stride_(grid.columns + kReadAhead) {
  for (auto& plane : planes_)
    plane.assign(static_cast<std::size_t>(stride_ * rows_ + kReadAhead), 0);
}

void HeightBits::bar(int x, int y) {
  for (auto& plane : planes_) plane[static_cast<std::size_t>(y * stride_ + x)] = ~std::uint64_t{0};
}

void HeightBits::change(const BitPart& part, int x, int y, int z, bool filled) {
  for (const BitRun& run : part.runs) {
    const int length = run.high - run.low;
    const std::uint64_t bits = ((std::uint64_t{1} << length) - 1) << (run.low + z);
    const auto at = static_cast<std::size_t>((y + run.y) * stride_ + x + run.x);
    std::uint64_t word = filled ? planes_[0][at] | bits : planes_[0][at] & ~bits;
    planes_[0][at] = word;
    for (std::size_t k = 1; k < planes_.size(); ++k) {
      word |= word >> (std::size_t{1} << (k - 1));
      planes_[k][at] = word;
    }
  }
}

std::uint64_t HeightBits::taken(const BitPart& part, int x, int y) const {
  std::uint64_t taken = 0;
  for (const BitRun& run : part.runs) {
    const auto at = static_cast<std::size_t>((y + run.y) * stride_ + x + run.x);
    const std::uint64_t word = planes_[run.power][at];
    taken |= (word >> run.low) | (word >> (run.high - (1 << run.power)));
  }
  return taken;
}

}  // namespace packmerger
