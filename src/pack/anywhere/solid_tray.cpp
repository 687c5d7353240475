#include "pack/anywhere/solid_tray.h"

#include <algorithm>
#include <bit>

namespace packmerger {
namespace {

// The empty lengths, units, below the spans of a column that hang; both lists are sorted by height.
// What overlaps after rounding leaves no void.
std::int64_t hollow(std::span<const SolidTray::Span> spans, const SpanCell* added,
                    std::size_t added_count, int z) {
  std::int64_t sum = 0;
  int top = 0;
  std::size_t other = 0;
  const auto pass = [&](int low, int high, bool hangs) {
    if (hangs && low > top) sum += low - top;
    top = std::max(top, high);
  };
  for (const SolidTray::Span& span : spans) {
    for (; other < added_count && added[other].low + z <= span.low; ++other)
      pass(added[other].low + z, added[other].high + z, added[other].hangs);
    pass(span.low, span.high, span.hangs);
  }
  for (; other < added_count; ++other)
    pass(added[other].low + z, added[other].high + z, added[other].hangs);
  return sum;
}

}  // namespace

std::array<TakenHeights::Words, TakenHeights::kCount + 1> TakenHeights::all_below() {
  std::array<Words, kCount + 1> below{};
  for (int count = 1; count <= kCount; ++count) {
    below[static_cast<std::size_t>(count)] = below[static_cast<std::size_t>(count - 1)];
    below[static_cast<std::size_t>(count)][static_cast<std::size_t>((count - 1) / 64)] |=
        std::uint64_t{1} << ((count - 1) % 64);
  }
  return below;
}

const std::array<TakenHeights::Words, TakenHeights::kCount + 1> TakenHeights::kBelow = all_below();

bool TakenHeights::all(int count) const {
  const Words& wanted = kBelow[static_cast<std::size_t>(count)];
  std::uint64_t missing = 0;
  for (std::size_t i = 0; i < words_.size(); ++i) missing |= wanted[i] & ~words_[i];
  return missing == 0;
}

int TakenHeights::next_free(int from) const {
  for (int word = from / 64; word < kCount / 64; ++word) {
    std::uint64_t free = ~words_[static_cast<std::size_t>(word)];
    if (word == from / 64) free &= ~std::uint64_t{0} << (from % 64);
    if (free != 0) return word * 64 + std::countr_zero(free);
  }
  return kCount;
}

SolidTray::SolidTray(const SolidGrid& grid, const std::vector<SolidPlace>& places,
                     const CellWindow& window)
    : grid_(grid) {
  const int border = grid.growth() + 1;
  cells_.x = intersection(window.x, {-border, grid.columns() + border - 1});
  cells_.y = intersection(window.y, {-border, grid.rows() + border - 1});
  stride_ = cells_.x.count();
  if (grid.bounds) matter_ = columns_of(places, &SolidPart::matter);
  centres_ = columns_of(places, &SolidPart::centres);
  for (const SolidPlace& place : places) {
    const Vec3 at(place.x * grid.cell_mm, place.y * grid.cell_mm, place.z * grid.unit_mm);
    contents_.extend(Vec3(place.part->box.min() + at));
    contents_.extend(Vec3(place.part->box.max() + at));
    top_ = std::max(top_, place.z + place.part->rise);
  }
  std::int64_t sum = 0;
  for (std::size_t cell = 0; cell + 1 < centres_.first.size(); ++cell)
    sum += hollow({centres_.spans.data() + centres_.first[cell],
                   static_cast<std::size_t>(centres_.first[cell + 1] - centres_.first[cell])},
                  nullptr, 0, 0);
  support_mm3_ = static_cast<double>(sum) * grid.cell_mm * grid.cell_mm * grid.unit_mm;
}

SolidTray::Columns SolidTray::columns_of(const std::vector<SolidPlace>& places,
                                         std::vector<SpanCell> SolidPart::*spans) const {
  Columns columns;
  columns.first.assign(static_cast<std::size_t>(stride_ * cells_.y.count()) + 1, 0);
  const auto stands_in = [&](const SolidPlace& place) {
    const Vec3 low = place.part->box.min() / grid_.cell_mm;
    const Vec3 high = place.part->box.max() / grid_.cell_mm;
    return place.x + low.x() <= cells_.x.last + 1 && place.x + high.x() >= cells_.x.first &&
           place.y + low.y() <= cells_.y.last + 1 && place.y + high.y() >= cells_.y.first;
  };
  const auto for_each_span = [&](const auto& body) {
    for (const SolidPlace& place : places) {
      if (!stands_in(place)) continue;
      for (const SpanCell& cell : place.part->*spans) {
        const int x = place.x + cell.x;
        const int y = place.y + cell.y;
        if (x >= cells_.x.first && x <= cells_.x.last && y >= cells_.y.first && y <= cells_.y.last)
          body(index(x, y), Span{static_cast<Height>(cell.low + place.z),
                                 static_cast<Height>(cell.high + place.z), cell.hangs});
      }
    }
  };
  for_each_span([&](std::size_t cell, const Span&) { ++columns.first[cell + 1]; });
  for (std::size_t i = 1; i < columns.first.size(); ++i) columns.first[i] += columns.first[i - 1];
  columns.spans.resize(static_cast<std::size_t>(columns.first.back()));
  std::vector<std::int32_t> next(columns.first.begin(), columns.first.end() - 1);
  for_each_span([&](std::size_t cell, const Span& span) {
    columns.spans[static_cast<std::size_t>(next[cell]++)] = span;
  });
  for (std::size_t i = 0; i + 1 < columns.first.size(); ++i)
    if (columns.first[i + 1] - columns.first[i] > 1)
      std::sort(columns.spans.begin() + columns.first[i],
                columns.spans.begin() + columns.first[i + 1],
                [](const Span& a, const Span& b) { return a.low < b.low; });
  return columns;
}

std::vector<FreeHeights> SolidTray::free_heights(const std::vector<SpanCell>& reach, int x,
                                                 int y) const {
  std::vector<FreeHeights> taken;
  meetings(reach, x, y, [&](int low, int high) {
    taken.push_back({low, high});
    return true;
  });
  std::sort(taken.begin(), taken.end(),
            [](const FreeHeights& a, const FreeHeights& b) { return a.low < b.low; });
  std::vector<FreeHeights> free;
  int from = 0;
  for (const FreeHeights& meeting : taken) {
    if (meeting.low >= from) free.push_back({from, meeting.low});
    from = std::max(from, meeting.high);
  }
  free.push_back({from, kUpAndAway});
  return free;
}

double SolidTray::added_support_mm3(const SolidPart& part, int x, int y, int z) const {
  std::int64_t sum = 0;
  const std::vector<SpanCell>& cells = part.centres;
  for (std::size_t i = 0; i < cells.size();) {
    std::size_t end = i + 1;
    while (end < cells.size() && cells[end].x == cells[i].x && cells[end].y == cells[i].y) ++end;
    const std::size_t at = index(x + cells[i].x, y + cells[i].y);
    const std::span<const Span> there{
        centres_.spans.data() + centres_.first[at],
        static_cast<std::size_t>(centres_.first[at + 1] - centres_.first[at])};
    sum += hollow(there, &cells[i], end - i, z);
    if (!there.empty()) sum -= hollow(there, nullptr, 0, 0);
    i = end;
  }
  return static_cast<double>(sum) * grid_.cell_mm * grid_.cell_mm * grid_.unit_mm;
}

}  // namespace packmerger
