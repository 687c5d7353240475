// The ways of printing that the packed tray is compared with: whole models side by side.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "base/progress.h"
#include "job/compare/arrangement.h"
#include "model/mesh.h"
#include "model/printer.h"

namespace packmerger {

// One per input, in order; copies share an object.
using WholeModels = std::vector<std::shared_ptr<const Mesh>>;

// The models the way their files stand, dropped to the plate. Empty where one does not fit.
std::optional<Arrangement> stand_as_is(const WholeModels& models, const Profile& profile);

// Each model the best of the six axis-aligned ways up (lowest cost, then time, by the analytic
// estimate), turned by a quarter about the vertical where that is cheaper or the only way to fit.
std::optional<Arrangement> stand_best(const WholeModels& models, const Profile& profile,
                                      const Progress& progress);

// Rectangles placed in rows, deepest first, each on the first tray that has room, the whole centred
// on its tray. Corners are front left, mm.
struct Slot {
  int tray = 0;  // from 0
  Vec2 corner = Vec2::Zero();
};
std::vector<Slot> side_by_side(const std::vector<Vec2>& sizes, const Vec2& tray_mm, double gap_mm);

}  // namespace packmerger
