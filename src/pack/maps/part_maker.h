// Parts as sets of items, and their maps in the rotations the search asks for. Maps of items are
// drawn once for each rotation; the maps of a merged part are its members' united, so that merging
// draws nothing.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "model/packing.h"
#include "pack/maps/merge.h"
#include "pack/maps/plate_mask.h"
#include "pack/maps/rotated_part.h"
#include "pack/maps/rotations.h"
#include "pack/maps/ways_up.h"

namespace packmerger {

struct Part {
  ItemSet items;
  int model = 0;
  double volume_mm3 = 0;
  std::vector<WayUp> ways;  // that fit the build volume, best alone first
};

// Thread-safe. Parts and maps live as long as the maker.
class PartMaker {
 public:
  // tick is called often, from any thread, and may throw to end the making. problem must outlive
  // the maker.
  PartMaker(const PackProblem& problem, const Grid& grid, std::function<void()> tick);

  // nullptr where no rotation fits the build volume. The same items give the same part.
  const Part* make(const ItemSet& items);

  // The part in one of its ways up, turned further about the vertical by the step's multiple;
  // nullptr where that turn does not fit the build volume.
  const RotatedPart* rotated(const Part& part, std::size_t way, std::size_t turn);
  std::size_t turns() const { return rotation_set_.turns.size(); }

  // The part in any rotation; the part may be another maker's. The inside support is the caller's
  // where the maps do not tell it. nullptr as above.
  const RotatedPart* rotated(const Part& part, const Mat3& rotation, double inside_support_mm3);

  // Pose of a part at a position, model → tray.
  Pose pose(const RotatedPart& rotated, int x, int y, Height z) const;

 private:
  struct Shape {  // of an item, about its model's centre
    Mesh surface;
    int twin = 0;  // the first item with the same shape about the same centre
  };
  struct Standing {           // what an item's way up is measured by
    std::vector<Box3> boxes;  // in each turn
    RoofMap roof;             // at 0 degrees
  };

  const RotatedPart* rotated(const Part& part, const Mat3& base, int quarters,
                             double inside_support_mm3);
  DepthMaps part_maps(const ItemSet& items, const Mat3& rotation);
  // Kept while samples are searched: merged parts ask for their members' again. Bounds are drawn
  // for one layout, and fine ones are large.
  std::shared_ptr<const DepthMaps> maps(int twin, const Mat3& rotation);
  // Copies are told apart by their twins only: what was found for one serves all.
  ItemSet twins(const ItemSet& items) const;
  std::vector<WayUp> ways_of(const Part& part);
  std::shared_ptr<const Standing> standing(int item, const Mat3& base);
  void add_own_ways(const Part& part, const std::vector<WayUp>& ways,
                    const std::function<double(const Mat3&)>& add);
  WayUp measured(const Part& part, const std::vector<std::shared_ptr<const Standing>>& members,
                 const Mat3& base, const Turn& turn) const;
  std::vector<Mesh> surfaces(const ItemSet& items) const;

  const PackProblem& problem_;
  Grid grid_;
  PlateMask mask_;
  std::function<void()> tick_;
  RotationSet rotation_set_;
  std::vector<Vec3> centres_;  // by model
  std::vector<Shape> shapes_;  // by item
  std::mutex mutex_;           // guards the caches
  std::map<std::pair<int, RotationKey>, std::shared_ptr<const DepthMaps>> maps_;
  // Kept where parts may merge: a merged part is measured by its members.
  std::map<std::pair<int, RotationKey>, std::shared_ptr<const Standing>> standing_;  // by twin
  std::map<ItemSet, std::unique_ptr<Part>> parts_;
  std::map<ItemSet, std::vector<WayUp>> ways_;                                       // by twins
  std::map<std::pair<ItemSet, RotationKey>, std::unique_ptr<RotatedPart>> rotated_;  // by twins
};

}  // namespace packmerger
