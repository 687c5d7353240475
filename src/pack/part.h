// A part as the packer handles it: a set of items in every rotation it is tried in, with all that
// the placement kernel reads laid out ready for it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include "model/packing.h"
#include "pack/depth_map.h"
#include "pack/rotations.h"
#include "pack/ways_up.h"

namespace packmerger {

// One cell of a map; x and y count cells from the part's own origin.
struct MapCell {
  std::int16_t x = 0;
  std::int16_t y = 0;
  float value = 0;
};

// Coordinates are the rotated frame's: model coordinates less the model's centre, rotated. A
// position (x, y, z) of the part adds x and y whole cells of the fine grid and z mm.
struct RotatedPart {
  Mat3 rotation = Mat3::Identity();
  Box3 box;  // exact, mm
  // Fine grid.
  std::vector<MapCell> reach;       // lower bound of matter, grown by the gap in every direction
  Eigen::Vector2i reach_low{0, 0};  // least and greatest cell of `reach`
  Eigen::Vector2i reach_high{0, 0};
  std::vector<MapCell> top;   // upper bound of matter
  std::vector<MapCell> roof;  // the highest matter at the cell's centre
  std::vector<MapCell> hang;  // the lowest matter there, where it needs support
  double hang_sum = 0;        // of the values of `hang`
  // Coarse grid: blocks of coarse × coarse fine cells.
  std::vector<MapCell> coarse_reach;  // mean of `reach` in the block
  std::vector<MapCell> coarse_hang;   // number of cells of `hang` in the block
  double inside_support_mm3 = 0;      // between the part's own surfaces
};

struct Part {
  std::vector<int> items;  // sorted
  int model = 0;
  double volume_mm3 = 0;
  std::vector<WayUp> ways;  // that fit the build volume, best alone first
  std::shared_ptr<const std::vector<RotatedPart>> rotations;  // the best way's first
};

// How many rotations a part is tried in: the best ways up in quarters or whatever the search's step
// is, in every turn of the answer's step, or the best way up alone.
enum class Effort { kSearch, kPlace, kAlone };

// Makes parts of items, drawing the maps of each item once per rotation. Thread-safe.
class PartMaker {
 public:
  // margin_mm is added to the gap in the maps. tick is called often, from any thread, and may throw
  // to end the making. problem must outlive the maker.
  PartMaker(const PackProblem& problem, double margin_mm, std::function<void()> tick);

  // A part with the search's rotations. Empty where no rotation fits the build volume.
  std::optional<Part> make(std::vector<int> items);

  // The same part with more rotations, or fewer.
  Part with(Part part, Effort effort);

  // The fine grid's cells that make up one of the coarse grid.
  int coarse() const { return coarse_; }
  // Cells by which `reach` may stand out over the part.
  int growth() const { return growth_; }

  // Pose of a part at a position, model → tray.
  Pose pose(const Part& part, const RotatedPart& rotated, int x, int y, double z) const;
  // Where the part's model has its centre, model coordinates.
  const Vec3& centre(int model) const { return centres_[static_cast<std::size_t>(model)]; }

 private:
  struct Shape {  // of an item, about its model's centre
    TriangleSoup surface;
    int twin = 0;  // the first item with the same shape
  };
  using MapsKey = std::array<std::int64_t, 10>;  // twin and rotation

  std::vector<TriangleSoup> surfaces(const std::vector<int>& items) const;
  std::shared_ptr<const DepthMaps> maps(int twin, const Mat3& rotation);
  DepthMaps part_maps(const std::vector<int>& items, const Mat3& way, double turn);
  RotatedPart rotated(const std::vector<int>& items, const WayUp& way, double turn);
  std::shared_ptr<const std::vector<RotatedPart>> rotations(const Part& part, Effort effort);

  const PackProblem& problem_;
  double margin_mm_;
  std::function<void()> tick_;
  int coarse_ = 1;
  int growth_ = 0;
  std::size_t most_rotations_ = 1;  // of one part, so that all together stay in memory
  RotationSet rotation_set_;
  std::vector<Vec3> centres_;  // by model
  std::vector<Shape> shapes_;  // by item
  std::mutex mutex_;           // guards the two caches
  std::map<MapsKey, std::shared_ptr<const DepthMaps>> maps_;
  std::map<std::vector<int>, Part> parts_;  // by twins
  tbb::enumerable_thread_specific<DepthRenderer> renderers_;
};

}  // namespace packmerger
