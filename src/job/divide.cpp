#include "job/divide.h"

#include <utility>

#include "job/arrangement.h"
#include "shape/premerge.h"
#include "shape/segment.h"
#include "shape/smooth_cuts.h"
#include "shape/solidify.h"

namespace packmerger {

Divided divide(const Mesh& surface, const Profile& profile, bool hollow_it, std::uint64_t seed,
               Warnings& warnings, const Progress& progress) {
  Solidified solid = solidify(surface, profile.shape, hollow_it, warnings, progress);
  Divided divided;
  divided.shell = std::move(solid.shell);
  divided.tets = std::move(solid.tets);
  divided.resample_tolerance_mm = solid.resample_tolerance_mm;

  const Segments clusters = segment(divided.tets, profile.shape, seed, progress);
  divided.clusters = clusters.count;

  // Smoothing straightens cuts, which may bring a cross-section below the limit, so merging has the
  // last word, and what it says then is what the user is told.
  const BuildVolume build{room_of(profile).size_mm, radians(profile.pack.rotation_step_deg)};
  Warnings before_smoothing;
  divided.segments =
      premerge(divided.tets, clusters, profile.shape, build, before_smoothing, progress);
  const CutRoughness roughness =
      smooth_cuts(divided.tets, divided.segments, profile.shape, progress);
  divided.segments =
      premerge(divided.tets, divided.segments, profile.shape, build, warnings, progress);
  divided.roughness_before = roughness.before_rad;
  divided.roughness_after = roughness.after_rad;
  return divided;
}

Divided keep_whole(const Mesh& surface) {
  Divided whole;
  whole.shell.outer = surface;
  whole.shell.volume_mm3 = volume_mm3(surface);
  return whole;
}

Mesh shell_surface(const Shell& shell) {
  std::vector<const Mesh*> surfaces{&shell.outer};
  for (const Mesh& cavity : shell.cavities) surfaces.push_back(&cavity);
  return united(surfaces);
}

}  // namespace packmerger
