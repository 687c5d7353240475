#include "pack/lattice/support_columns.h"

#include <algorithm>

namespace packmerger {
namespace {

constexpr int kBlock = SupportedPart::kBlock;

}  // namespace

SupportColumns::SupportColumns(const BitGrid& grid)
    : columns_(grid.columns),
      rows_(grid.rows),
      cell_mm2_(grid.cell_mm * grid.cell_mm),
      cells_(static_cast<std::size_t>(grid.columns * grid.rows)),
      // Parts read whole blocks of blocks beyond their last cell.
      pooled_stride_(grid.columns / kBlock + 1 + SupportedPart::kBlocksRead),
      pooled_(kBlock, std::vector<float>(
                          static_cast<std::size_t>(pooled_stride_ * (grid.rows + kBlock)), 0)) {}

double SupportColumns::voids_mm(const Column& column) {
  double sum = 0;
  float top = 0;
  for (const Standing& one : column) {
    if (one.span.hangs) sum += std::max(0.0F, one.span.low - top);
    top = std::max(top, one.span.high);
  }
  return sum;
}

void SupportColumns::entered(const SupportedPart& part, std::size_t cell, int number, float z_mm,
                             Column& column) const {
  for (int i = part.first[cell]; i < part.first[cell + 1]; ++i) {
    MatterSpan span = part.spans[static_cast<std::size_t>(i)];
    span.low += z_mm;
    span.high += z_mm;
    const auto at = std::find_if(column.begin(), column.end(),
                                 [&](const Standing& other) { return other.span.low > span.low; });
    column.insert(at, {span, number});
  }
}

// Visits the part's cells that hold matter, and the tray's below them.
template <typename Visit>
void SupportColumns::over_cells(const SupportedPart& part, int x, int y, const Visit& visit) const {
  for (int j = 0; j < part.bits.depth; ++j)
    for (int i = 0; i < part.bits.width; ++i) {
      const auto cell = static_cast<std::size_t>(j * part.bits.width + i);
      if (part.first[cell] != part.first[cell + 1])
        visit(cell, static_cast<std::size_t>((y + j) * columns_ + x + i));
    }
}

void SupportColumns::put(const SupportedPart& part, int number, int x, int y, double z_mm) {
  over_cells(part, x, y, [&](std::size_t cell, std::size_t at) {
    support_mm_ -= voids_mm(cells_[at]);
    entered(part, cell, number, static_cast<float>(z_mm), cells_[at]);
    support_mm_ += voids_mm(cells_[at]);
  });
}

void SupportColumns::take(const SupportedPart& part, int number, int x, int y) {
  over_cells(part, x, y, [&](std::size_t, std::size_t at) {
    support_mm_ -= voids_mm(cells_[at]);
    std::erase_if(cells_[at], [&](const Standing& one) { return one.number == number; });
    support_mm_ += voids_mm(cells_[at]);
  });
}

double SupportColumns::added_mm3(const SupportedPart& part, int x, int y, double z_mm) const {
  double sum = 0;
  Column column;
  over_cells(part, x, y, [&](std::size_t cell, std::size_t at) {
    column = cells_[at];
    sum -= voids_mm(column);
    entered(part, cell, -1, static_cast<float>(z_mm), column);
    sum += voids_mm(column);
  });
  return sum * cell_mm2_;
}

void SupportColumns::pool() {
  const int wide_stride = columns_ + kBlock;
  // Sums of a row's next cells.
  std::vector<float> wide(static_cast<std::size_t>((rows_ + kBlock) * wide_stride), 0);
  for (int y = 0; y < rows_; ++y)
    for (int x = 0; x < columns_; ++x) {
      const Column& column = cells_[static_cast<std::size_t>(y * columns_ + x)];
      if (column.empty()) continue;
      float top = 0;
      for (const Standing& one : column) top = std::max(top, one.span.high);
      for (int i = std::max(0, x - kBlock + 1); i <= x; ++i)
        wide[static_cast<std::size_t>(y * wide_stride + i)] += top;
    }
  for (int y = 0; y < rows_; ++y)
    for (int x = 0; x < columns_; ++x) {
      float sum = 0;
      for (int j = 0; j < kBlock; ++j)
        sum += wide[static_cast<std::size_t>((y + j) * wide_stride + x)];
      pooled_[static_cast<std::size_t>(x % kBlock)]
             [static_cast<std::size_t>(y * pooled_stride_ + x / kBlock)] = sum / (kBlock * kBlock);
    }
}

}  // namespace packmerger
