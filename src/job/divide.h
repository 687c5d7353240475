// From a surface to segments ready to be packed: the paper's sections 3 to 5 in order.
#pragma once

#include <cstdint>
#include <optional>

#include "base/progress.h"
#include "model/mesh.h"
#include "model/printer.h"
#include "model/segments.h"
#include "model/shell.h"
#include "model/tet_mesh.h"
#include "model/warning.h"
#include "shape/divide/premerge.h"

namespace packmerger {

struct Divided {
  Shell shell;
  TetMesh tets;                 // empty when the model is kept whole
  Segments segments;            // after pre-merging and smoothing
  int clusters = 0;             // segments before pre-merging
  double roughness_before = 0;  // radians: mean turning angle of the cut curves
  double roughness_after = 0;
  std::optional<double> resample_tolerance_mm;
};

// The shell and its tetrahedra, no segments yet. hollow_it: false keeps the model solid.
Divided undivided(const Mesh& surface, const Profile& profile, bool hollow_it, Warnings& warnings,
                  const Progress& progress);

// The paper's clusters, pre-merged. Same surface, settings and seed: the same result on any number
// of threads.
void cut_into_clusters(Divided& model, const Profile& profile, std::uint64_t seed,
                       const Progress& progress);

// Smooths the cuts between them, and pre-merges what is too small after that.
void smooth_clusters(Divided& model, const Profile& profile, Warnings& warnings,
                     const Progress& progress);

// Both.
void divide_by_clusters(Divided& model, const Profile& profile, std::uint64_t seed,
                        Warnings& warnings, const Progress& progress);

// All of it.
Divided divide(const Mesh& surface, const Profile& profile, bool hollow_it, std::uint64_t seed,
               Warnings& warnings, const Progress& progress);

// The model as it is, solid and undivided.
Divided keep_whole(const Mesh& surface);

// What parts must fit, and how the packer turns them.
BuildVolume build_volume(const Profile& profile);

// The shell as one surface: outside and cavities.
Mesh shell_surface(const Shell& shell);

}  // namespace packmerger
