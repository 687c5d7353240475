#include "job/divide.h"

#include <utility>

#include "job/compare/arrangement.h"
#include "shape/divide/segment.h"
#include "shape/divide/smooth_cuts.h"
#include "shape/solid/solidify.h"

namespace packmerger {

Divided undivided(const Mesh& surface, const Profile& profile, bool hollow_it, Warnings& warnings,
                  const Progress& progress) {
  Solidified solid = solidify(surface, profile.shape, hollow_it, warnings, progress);
  Divided model;
  model.shell = std::move(solid.shell);
  model.tets = std::move(solid.tets);
  model.resample_tolerance_mm = solid.resample_tolerance_mm;
  return model;
}

void cut_into_clusters(Divided& model, const Profile& profile, std::uint64_t seed,
                       const Progress& progress) {
  const Segments clusters = segment(model.tets, profile.shape, seed, progress);
  model.clusters = clusters.count;
  // Smoothing straightens cuts, which may bring a cross-section below the limit, so merging has the
  // last word, and what it says then is what the user is told.
  Warnings before_smoothing;
  model.segments = premerge(model.tets, clusters, profile.shape, build_volume(profile),
                            before_smoothing, progress);
}

void smooth_clusters(Divided& model, const Profile& profile, Warnings& warnings,
                     const Progress& progress) {
  const CutRoughness roughness = smooth_cuts(model.tets, model.segments, profile.shape, progress);
  model.segments = premerge(model.tets, model.segments, profile.shape, build_volume(profile),
                            warnings, progress);
  model.roughness_before = roughness.before_rad;
  model.roughness_after = roughness.after_rad;
}

void divide_by_clusters(Divided& model, const Profile& profile, std::uint64_t seed,
                        Warnings& warnings, const Progress& progress) {
  cut_into_clusters(model, profile, seed, progress);
  smooth_clusters(model, profile, warnings, progress);
}

Divided divide(const Mesh& surface, const Profile& profile, bool hollow_it, std::uint64_t seed,
               Warnings& warnings, const Progress& progress) {
  Divided model = undivided(surface, profile, hollow_it, warnings, progress);
  divide_by_clusters(model, profile, seed, warnings, progress);
  return model;
}

BuildVolume build_volume(const Profile& profile) {
  const Room room = room_of(profile);
  return {room.size_mm, radians(profile.pack.rotation_step_deg),
          room.plate.drawn_in(room.corner_mm.head<2>(), 0)};
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
