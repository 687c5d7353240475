#include "pack/separate/sinking.h"

#include "pack/separate/descent.h"
#include "pack/separate/separation.h"
#include "pack/separate/support_pull.h"

namespace packmerger {
namespace {

// What a mm³ of support counts beside the squares of what the samples of the surfaces lack, mm²: a
// part of 20 cm² that rests on thirty samples cuts in by some hundredths of a millimetre.
constexpr double kFirstPull = 2e-3;
constexpr double kFall = 0.6;
constexpr int kPhases = 6;  // the support is counted anew in each
constexpr int kStepsOfPhase = 15;
constexpr double kFreeFall_mm = 0.3;  // a step, where nothing is in the way
constexpr double kLongestStep_mm = 0.5;

}  // namespace

void sink(const std::vector<const Shape*>& shapes, std::vector<Pose>& poses,
          const SinkingRoom& room, const Plate& plate, const std::function<bool()>& is_over) {
  const Rooms rooms(poses.size(), room.apart_mm + kMargin_mm);
  double weight = kFirstPull;
  for (int phase = 0; phase < kPhases && !is_over(); ++phase, weight *= kFall) {
    const Eigen::VectorXd pull =
        weight * support_pull(shapes, poses, room.step_mm, room.support_angle).gradient;
    const double strongest = pull.cwiseAbs().maxCoeff();
    if (strongest == 0) return;
    descend(
        shapes, poses,
        [&](const std::vector<Pose>& at, const Eigen::VectorXd& by) {
          Overlap here = overlap(shapes, at, room.box_mm, rooms, plate);
          here.energy += pull.dot(by);
          here.gradient += pull;
          return here;
        },
        {kFreeFall_mm / strongest, kLongestStep_mm},
        [&](int steps, const Overlap&) { return steps < kStepsOfPhase && !is_over(); });
  }
}

}  // namespace packmerger
