// Divides a model the way the profile asks for: by the paper's clusters, or the way that packs
// cheapest.
#pragma once

#include <cstdint>

#include "base/progress.h"
#include "job/divide.h"

namespace packmerger {

// segmentation "paper": the clusters of divide_by_clusters().
// segmentation "printer": several divisions are made in earnest, the paper's clusters and the best
// plans of cut_plans(). Each is packed greedily by the profile's own objective, without merging,
// and the two that come out cheapest are searched briefly. The least packed cost wins; if the other
// is within 2 % of it, the one of fewer parts. Standing alone ranks plans, but parts nest, and only
// packing tells how well. What does not fit the printer loses. hollow_it: false keeps the model
// solid. Warnings are those of the division that is kept. Same surface, settings and seed: the same
// result on any number of threads. Throws what dividing and packing throw, except that a part that
// fits no tray is left to the packer where every division has one.
Divided choose_division(const Mesh& surface, const Profile& profile, bool hollow_it,
                        std::uint64_t seed, Warnings& warnings, const Progress& progress);

}  // namespace packmerger
