// The lowest place of a part among the others: every position of the tray and all heights, many
// positions in one instruction (Highway, chosen at run time).
#pragma once

#include "pack/lattice/height_bits.h"

namespace packmerger {

// What makes one place better than another; the less the better.
struct PlaceRating {
  double limit_mm = 0;       // no part may reach above it
  double unit_mm = 1;        // of the heights
  double malus_mm = 0;       // of the rotation
  double per_column_mm = 0;  // decides between places at one height
  double per_row_mm = 0;
};

struct BitPlace {
  int x = 0;
  int y = 0;
  int z = 0;
};

struct RatedPlace {
  BitPlace place;
  double rating_mm = 0;      // the part's top, its malus and what the position counts
  std::uint64_t looked = 0;  // runs of parts, at eight positions each, that it took to find it
};

// Puts into `best` the place of the lowest rating, where there is one that is lower than that in
// it; of equal ones the first by y and x. Returns whether there was one. Adds to best.looked.
bool lower_place(const HeightBits& tray, const BitPart& part, const PlaceRating& rating,
                 RatedPlace& best);

}  // namespace packmerger
