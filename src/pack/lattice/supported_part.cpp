#include "pack/lattice/supported_part.h"

#include <algorithm>

#include "pack/maps/columns.h"

namespace packmerger {
namespace {

void enter_spans(SupportedPart& part, const std::vector<Crossing>& crossings) {
  const int width = part.bits.width;
  const int cells = width * part.bits.depth;
  int next = 0;
  for (std::size_t i = 0; i < crossings.size();) {
    const int row = crossings[i].row;
    const int column = crossings[i].column;
    const int cell = row * width + column;
    const bool within = row >= 0 && column >= 0 && column < width && cell < cells;
    for (; within && next <= cell; ++next)
      part.first[static_cast<std::size_t>(next)] = static_cast<int>(part.spans.size());
    int depth = 0;
    for (; i < crossings.size() && crossings[i].row == row && crossings[i].column == column; ++i) {
      const Crossing& crossing = crossings[i];
      depth += crossing.enters ? 1 : -1;
      if (!within) continue;
      const auto z = static_cast<float>(crossing.z);
      if (crossing.enters && depth == 1)
        part.spans.push_back({z, z, crossing.needs_support});
      else if (!crossing.enters && depth == 0 && !part.spans.empty())
        part.spans.back().high = z;
    }
  }
  for (; next <= cells; ++next)
    part.first[static_cast<std::size_t>(next)] = static_cast<int>(part.spans.size());
}

void enter_blocks(SupportedPart& part, double cell_mm2, bool all_hang) {
  constexpr int kBlock = SupportedPart::kBlock;
  constexpr int kRead = SupportedPart::kBlocksRead;
  const int width = part.bits.width;
  const auto up_to = [](int count, int of) { return (count + of - 1) / of; };
  part.block_rows = up_to(part.bits.depth, kBlock);
  part.block_stride = up_to(up_to(width, kBlock), kRead) * kRead;
  part.block_cells.assign(static_cast<std::size_t>(part.block_rows * part.block_stride), 0);
  part.block_height.assign(part.block_cells.size(), 0);
  double matter_mm = 0;
  double inside_mm = 0;
  for (int y = 0; y < part.bits.depth; ++y)
    for (int x = 0; x < width; ++x) {
      const auto cell = static_cast<std::size_t>(y * width + x);
      const int first = part.first[cell];
      const int last = part.first[cell + 1] - 1;
      if (last < first) continue;
      for (int i = first; i <= last; ++i) {
        const MatterSpan& span = part.spans[static_cast<std::size_t>(i)];
        matter_mm += span.high - span.low;
        if (i > first && span.hangs)
          inside_mm += span.low - part.spans[static_cast<std::size_t>(i - 1)].high;
      }
      const MatterSpan& lowest = part.spans[static_cast<std::size_t>(first)];
      if (!all_hang && !lowest.hangs) continue;
      const auto block = static_cast<std::size_t>(y / kBlock * part.block_stride + x / kBlock);
      part.block_cells[block] += 1;
      part.block_height[block] +=
          all_hang ? part.spans[static_cast<std::size_t>(last)].high : lowest.low;
    }
  for (std::size_t i = 0; i < part.block_cells.size(); ++i)
    if (part.block_cells[i] > 0) part.block_height[i] /= part.block_cells[i];
  part.matter_mm3 = matter_mm * cell_mm2;
  part.own_mm3 = all_hang ? -part.matter_mm3 : inside_mm * cell_mm2;
}

}  // namespace

SupportedPart supported_part(const Shape& shape, const Mat3& rotation, const BitGrid& grid,
                             double apart_mm, double support_angle) {
  SupportedPart part;
  part.bits = bit_part(shape, rotation, grid, apart_mm);
  Pose standing = Pose::Identity();
  standing.linear() = rotation;
  standing.translation() = part.bits.origin - Vec3::Constant(apart_mm / 2);
  part.box = shape.surface.box(standing);
  part.first.assign(static_cast<std::size_t>(part.bits.width * part.bits.depth) + 1, 0);
  // The lattice's cells begin half of the room that parts keep outside of the tray.
  standing.translation() += Vec3(apart_mm / 2, apart_mm / 2, 0);
  enter_spans(part,
              sorted_crossings({transformed(shape.mesh, standing)}, grid.cell_mm, support_angle));
  enter_blocks(part, grid.cell_mm * grid.cell_mm, support_angle <= 0);
  return part;
}

}  // namespace packmerger
