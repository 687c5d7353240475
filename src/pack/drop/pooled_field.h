// The height field, pooled: what neighbouring positions have in common, so that one fall bounds the
// heights at all of them.
#pragma once

#include <cstddef>
#include <vector>

#include "pack/drop/tray_state.h"

namespace packmerger {

// Positions of a group along x and along y.
inline constexpr int kPool = 4;

// The least height of each kPool × kPool cells, for every lowest corner (x, y): what the cell of a
// part meets at least, wherever in a group of positions the part is dropped. A row's columns are
// dealt to kPool places in turn, so that groups beside one another read entries beside one another:
// to fall() this is a field whose positions are groups.
class PooledField {
 public:
  explicit PooledField(const HeightField& field);

  std::ptrdiff_t stride() const { return kPool * groups_; }
  // What the groups whose lowest row is y read: the first one here, the next one behind it.
  const Height* row(int y) const {
    return &values_[static_cast<std::size_t>((y + border_) * stride())];
  }
  // The cell as groups read it, of which the first one's lowest column is x.
  HeightCell cell(const HeightCell& cell, int x) const {
    return {static_cast<std::int16_t>(place(x + cell.x + border_)), cell.y, cell.value};
  }

 private:
  std::ptrdiff_t place(int column) const { return column % kPool * groups_ + column / kPool; }

  int border_;
  std::ptrdiff_t groups_;  // that a row has room for
  std::vector<Height> values_;
};

}  // namespace packmerger
