// A tray as columns of matter, and where a part is free of it: in the open as well as in cavities
// and under overhangs.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "pack/anywhere/solid_part.h"
#include "pack/maps/grid.h"

namespace packmerger {

struct SolidPlace {
  const SolidPart* part = nullptr;
  int x = 0;  // cells
  int y = 0;
  int z = 0;  // units
};

// Cells of a tray that are looked at.
struct CellWindow {
  Range x = kAllCells;
  Range y = kAllCells;
};

// Heights of a part's origin at which it meets nothing, units; both ends are free too.
struct FreeHeights {
  int low = 0;
  int high = 0;
};
inline constexpr int kUpAndAway = std::numeric_limits<int>::max();

// Which of 256 heights, `1 << shift` units apart from 0 up, are taken.
class TakenHeights {
 public:
  static constexpr int kCount = 256;

  // Takes those strictly between low and high.
  void take_between(int low, int high, int shift) {
    take((low >> shift) + 1, (high + (1 << shift) - 1) >> shift);
  }
  // Takes those from which a move up to the next would come between low and high.
  void take_ways_between(int low, int high, int shift) {
    take(low >> shift, (high + (1 << shift) - 1) >> shift);
  }
  // Whether the first `count` are all taken.
  bool all(int count) const;
  bool taken(int index) const {
    return (words_[static_cast<std::size_t>(index / 64)] >> (index % 64) & 1) != 0;
  }
  // The first at or after `from` that is free, or kCount.
  int next_free(int from) const;

 private:
  using Words = std::array<std::uint64_t, kCount / 64>;
  static std::array<Words, kCount + 1> all_below();
  static const std::array<Words, kCount + 1> kBelow;

  void take(int first, int end) {
    first = first < 0 ? 0 : first;
    end = end > kCount ? kCount : end;
    if (end <= first) return;
    const Words& until = kBelow[static_cast<std::size_t>(end)];
    const Words& from = kBelow[static_cast<std::size_t>(first)];
    for (std::size_t i = 0; i < words_.size(); ++i) words_[i] |= until[i] & ~from[i];
  }

  Words words_{};
};

class SolidTray {
 public:
  struct Span {
    Height low;
    Height high;
    bool hangs;
  };

  // grid must outlive it. Matter outside of the window is left out, and no part may be asked about
  // there; contents() and top() are those of the whole tray all the same.
  SolidTray(const SolidGrid& grid, const std::vector<SolidPlace>& places,
            const CellWindow& window = {});

  // Where a part of these spans meets matter at (x, y), as heights of its origin: `between(low,
  // high)` is called for each meeting with the heights strictly between which it happens, until it
  // returns false. The part lies within the build volume, but for `reach`.
  template <typename Between>
  void meetings(const std::vector<SpanCell>& reach, int x, int y, const Between& between) const {
    const Columns& matter = grid_.bounds ? matter_ : centres_;
    const std::int32_t* at = &matter.first[index(x, y)];
    for (const SpanCell& cell : reach) {
      const std::int32_t* column = at + cell.y * stride_ + cell.x;
      for (std::int32_t i = column[0]; i < column[1]; ++i) {
        const Span& span = matter.spans[static_cast<std::size_t>(i)];
        if (!between(span.low - cell.high, span.high - cell.low)) return;
      }
    }
  }

  // All heights from 0 up at which it is free, from below; the last ends at kUpAndAway.
  std::vector<FreeHeights> free_heights(const std::vector<SpanCell>& reach, int x, int y) const;

  // V_s that a part adds at a place, mm³; negative where it fills what would need support.
  double added_support_mm3(const SolidPart& part, int x, int y, int z) const;

  const Box3& contents() const { return contents_; }   // mm; empty where there is nothing
  double support_mm3() const { return support_mm3_; }  // in the window
  int top() const { return top_; }                     // of all spans, units
  const SolidGrid& grid() const { return grid_; }

 private:
  struct Columns {
    std::vector<std::int32_t> first;  // of a cell's spans; one more at the end
    std::vector<Span> spans;          // by height
  };

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>((y - cells_.y.first) * stride_ + x - cells_.x.first);
  }
  Columns columns_of(const std::vector<SolidPlace>& places,
                     std::vector<SpanCell> SolidPart::*spans) const;

  const SolidGrid& grid_;
  CellWindow cells_;  // with a border for what stands out of the tray
  int stride_;
  Columns matter_;  // of bounds; samples are the centres themselves
  Columns centres_;
  Box3 contents_;
  double support_mm3_ = 0;
  int top_ = 0;
};

}  // namespace packmerger
