// How much parts overlap one another and the walls, as a smooth function of their poses: squares
// of what each sample of a surface lacks of the room it should have.
#pragma once

#include <cstdint>
#include <vector>

#include "model/plate.h"
#include "pack/separate/shape.h"

namespace packmerger {

// The room that is asked for. Parts: index into the poses.
class Rooms {
 public:
  Rooms(std::size_t parts, double room_mm)
      : parts_(parts), pairs_(parts * parts, room_mm), walls_(parts, 0) {}

  double pair(std::size_t a, std::size_t b) const { return pairs_[a * parts_ + b]; }
  void widen(std::size_t a, std::size_t b, double by_mm) {
    pairs_[a * parts_ + b] += by_mm;
    pairs_[b * parts_ + a] += by_mm;
  }
  // To the walls, beyond a hair that every part keeps.
  double wall(std::size_t part) const { return walls_[part]; }
  void widen_wall(std::size_t part, double by_mm) { walls_[part] += by_mm; }

 private:
  std::size_t parts_;
  std::vector<double> pairs_;  // mm
  std::vector<double> walls_;
};

struct Overlap {
  double energy = 0;         // mm²
  double deepest_mm = 0;     // what a sample lacks most
  Eigen::VectorXd gradient;  // six a part: turn (mm at its radius), then translation
  std::uint64_t steps = 0;   // of work (base/effort.h)
};

// box_mm: the parts are to lie within [0, box_mm], and over no wall of the plate. Poses are of the
// shapes' own frames. The same bits on any number of threads.
Overlap overlap(const std::vector<const Shape*>& shapes, const std::vector<Pose>& poses,
                const Vec3& box_mm, const Rooms& rooms, const Plate& plate = {});

// The poses moved by six numbers a part, as in the gradient.
std::vector<Pose> moved(const std::vector<const Shape*>& shapes, const std::vector<Pose>& poses,
                        const Eigen::VectorXd& by);

}  // namespace packmerger
