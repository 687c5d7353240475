#include "pack/free/height_bits.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace packmerger {
namespace {

constexpr double kRounding = 1e-4;  // cells
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
  std::vector<BitRun> runs;
  for (int y = 0; y < part.depth; ++y)
    for (int x = 0; x < part.width; ++x) {
      const Vec3 lowest =
          box.min() + Vec3((x + 0.5) * grid.cell_mm, (y + 0.5) * grid.cell_mm, 0.5 * grid.unit_mm);
      const Vec3f from = (back * lowest).cast<float>();
      int low = -1;
      for (int z = 0; z <= layers; ++z) {
        const bool matter =
            z < layers && shape.distances.at(from + static_cast<float>(z) * up) <= reach;
        if (matter && low < 0) low = z;
        if (matter || low < 0) continue;
        runs.push_back(run_of(x, y, low, z));
        low = -1;
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
