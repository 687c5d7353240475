// Parts that overlap a little are moved apart, all at once: the overlap energy is minimised, and
// what the samples do not see is found on the exact meshes and given more room.
#pragma once

#include <functional>
#include <vector>

#include "base/effort.h"
#include "base/random.h"
#include "pack/separate/overlap_energy.h"

namespace packmerger {

// How close parts may come where the gap is less: at 0 a touch is not told from a cut, and along an
// escape path parts keep 0.02 mm.
inline constexpr double kLeastApart_mm = 0.025;
// What is asked for beyond what parts are to keep: the samples see too little.
inline constexpr double kMargin_mm = 0.02;

class Separation {
 public:
  // base_mm: x and y of the tray; plate: its walls within the base. is_over says that time is up;
  // it may throw to cancel. effort: to which the work is added, if anybody counts it; it must
  // outlive this.
  Separation(std::vector<const Shape*> shapes, const Vec2& base_mm, double gap_mm,
             std::function<bool()> is_over, Plate plate = {}, Effort* effort = nullptr);

  // Moves the parts so that they lie within the base up to the height and over no wall, and gap_mm
  // (and kLeastApart_mm) apart on the exact meshes. False where that did not succeed; the poses are
  // then as they were.
  bool separate(std::vector<Pose>& poses, double height_mm, int most_steps) const;

  double height_mm(const std::vector<Pose>& poses) const;

 private:
  double minimise(std::vector<Pose>& poses, const Vec3& box_mm, const Rooms& rooms,
                  int most_steps) const;
  bool widen_where_close(const std::vector<Pose>& poses, const Vec3& box_mm, Rooms& rooms) const;
  void spend(std::uint64_t steps) const;

  std::vector<const Shape*> shapes_;
  Vec2 base_mm_;
  Plate plate_;
  double apart_mm_;
  std::function<bool()> is_over_;
  Effort* effort_;
};

// Each part moved by up to half of shift_mm along each axis and turned by up to half the angle.
void shake(std::vector<Pose>& poses, double shift_mm, double angle, Random& random);

// All moved towards the plate by a share of their height.
void squeeze(std::vector<Pose>& poses, double share);

}  // namespace packmerger
