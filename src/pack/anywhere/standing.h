// Parts standing on a tray, and their columns of matter on a coarse and on a fine grid.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <mutex>
#include <tuple>
#include <vector>

#include "model/packing.h"
#include "pack/anywhere/solid_tray.h"

namespace packmerger {

// A part turned. Its own frame is rotation · model coordinates + shift: the lowest point at z = 0,
// the corner of its box in the fine grid's first cell.
struct Attitude {
  Mat3 rotation = Mat3::Identity();
  Vec3 shift = Vec3::Zero();
};

struct StandingPart {
  int part = 0;
  std::shared_ptr<const Attitude> attitude;
  int x = 0;  // fine cells
  int y = 0;
  int z = 0;  // units
};

// Draws parts and keeps what it drew. Thread-safe.
class SolidMaker {
 public:
  // parts: the items of each. fine.cell_mm is the coarse cell's over a whole number.
  // The grids must outlive the maker.
  SolidMaker(const PackProblem& problem, const std::vector<std::vector<int>>& parts,
             const SolidGrid& coarse, const SolidGrid& fine);

  std::shared_ptr<const Attitude> attitude(int part, const Mat3& rotation);
  // The part as it stands: the answer's attitude and place give this pose to the last bit but for
  // z, which is in whole units.
  StandingPart standing(int part, const Pose& pose) const;
  Pose pose(const StandingPart& standing) const;

  // Fine cells in a coarse one along each axis.
  int ratio() const { return ratio_; }
  std::shared_ptr<const SolidPart> fine(int part, const std::shared_ptr<const Attitude>& attitude);
  // Moved by so many fine cells first.
  std::shared_ptr<const SolidPart> coarse(int part, const std::shared_ptr<const Attitude>& attitude,
                                          int fine_x, int fine_y);

  // Frees memory when there is much to free. Not while other threads draw.
  void forget_some();

 private:
  using Key = std::tuple<const Attitude*, int, int, int>;  // -1: fine; moved by

  std::shared_ptr<const SolidPart> drawn(int part, const std::shared_ptr<const Attitude>& attitude,
                                         const Key& key, const SolidGrid& grid, const Vec3& moved);
  const SolidGrid& coarse_;
  const SolidGrid& fine_;
  int ratio_;
  std::vector<std::vector<Mesh>> shapes_;  // by part, model coordinates
  std::mutex mutex_;                       // guards the caches
  std::map<std::pair<int, std::array<std::int64_t, 9>>, std::shared_ptr<const Attitude>> attitudes_;
  struct Drawing {
    std::shared_ptr<const Attitude> attitude;  // kept alive: it is the key
    std::shared_ptr<const SolidPart> part;
  };
  std::map<Key, Drawing> drawings_;
  std::size_t spans_ = 0;  // in the drawings
};

}  // namespace packmerger
