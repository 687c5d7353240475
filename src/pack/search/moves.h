// The neighbourhood of a layout: ways to take parts out and put them again, in another place,
// order, rotation or division. Order, rotation and merging are one search (paper, future work).
#pragma once

#include <cstddef>
#include <vector>

#include "base/random.h"
#include "pack/search/layout.h"

namespace packmerger {

struct Move {
  Draft draft;
  std::vector<const Part*> touched;  // parts that the move is about; empty: no such move here
  std::uint64_t seed = 0;            // of the rotations it tries
};

class Moves {
 public:
  // Both must outlive it.
  Moves(const PackProblem& problem, PartMaker& maker) : problem_(problem), maker_(maker) {}

  // Every part once, the largest first or in random order.
  Draft start(bool largest_first, Random& random);

  Move draw(const Layout& layout, Random& random);

  // Every merge that is possible here.
  std::vector<Move> merges(const Layout& layout, Random& random);

  // Rotations that a part is tried in, all different (rotated_part.h): some of its better ways up,
  // each in a random turn.
  std::vector<const RotatedPart*> some_rotations(const Part& part, Random& random);
  // The best few ways up in every turn.
  std::vector<const RotatedPart*> good_rotations(const Part& part, std::size_t ways);

 private:
  Move put_again(const Layout& layout, Random& random);
  Move put_earlier(const Layout& layout, Random& random);
  Move exchange(const Layout& layout, Random& random);
  Move turn(const Layout& layout, Random& random);
  Move merge(const Layout& layout, Random& random);
  Move merge(const Layout& layout, const Part& one, const Part& other);
  Move undo_merge(const Layout& layout, Random& random);

  const PackProblem& problem_;
  PartMaker& maker_;
};

}  // namespace packmerger
