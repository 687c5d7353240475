// The escape path of a part from a tray where it cannot be lifted straight up: a flood fill of
// its free translations (as SSP, Cui 2023, certifies layouts), here over stretches of free
// heights.
#pragma once

#include <optional>
#include <vector>

#include "pack/anywhere/solid_tray.h"

namespace packmerger {

// Steps along the axes, mm, after which the part can be lifted straight up; empty where it can at
// once. The part stands at `place`, which is not in `rest`; both are on a grid of bounds, so that a
// step of one cell between two free positions sweeps nothing that was not tested. All along, the
// part stays kEscapeClearance_mm away from the rest and within the build volume's sides.
// Nothing where no way was found; that none exists is not said: the search looks at a limited
// number of positions.
std::optional<std::vector<Vec3>> escape_path(const SolidTray& rest, const SolidPlace& place);

inline constexpr double kEscapeClearance_mm = 0.05;

}  // namespace packmerger
