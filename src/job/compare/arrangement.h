// One way of printing the job: which parts stand where on which trays.
#pragma once

#include <map>
#include <vector>

#include "model/job.h"
#include "model/packing.h"
#include "model/printer.h"
#include "model/tray.h"

namespace packmerger {

// Kept between parts even where the profile asks for no gap: what touches would be printed as one.
inline constexpr double kLeastGap_mm = 0.001;

struct Arrangement {
  std::vector<JobPart> parts;                      // ids 1, 2, … in order
  std::vector<int> removal_order;                  // ids
  std::map<int, std::vector<Vec3>> removal_paths;  // by id, only parts not lifted straight up
  int trays = 1;
};

// The parts at their places, one Tray each, in order.
std::vector<Tray> trays_of(const Arrangement& arrangement);

Assembly assembly_of(const Arrangement& arrangement);

// Where parts may be. A part's place is counted from the build volume's own corner.
struct Room {
  Vec3 corner_mm = Vec3::Zero();
  Vec3 size_mm = Vec3::Zero();
  Plate plate{};  // its walls drawn in by the margin, in the build volume's coordinates
};

// At all: the build volume; in powder, which must be all round a part, less the gap to every wall,
// floor and ceiling.
Room whole_room(const Profile& profile);

// Less a margin for the support that a slicer puts beside parts.
Room room_of(const Profile& profile);

// What the packer's objective sees, taken from the exact meshes.
TrayMeasure measure(const Tray& tray, const Profile& profile);

}  // namespace packmerger
