// Everything about a job that can be known before anything is written: the ways of printing it and
// what each costs. prepare writes one of them, compare only shows the figures.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "job/compare/arrangement.h"
#include "job/load_models.h"
#include "model/job.h"

namespace packmerger {

struct PlanOptions {
  std::vector<std::filesystem::path> models;
  Sizing sizing;
  bool split = true;  // false: pack the models as they are (the paper's Figure 13)
  bool hollow = true;
  std::uint64_t seed = 1;
  double budget_s = 0;  // of the packing; 0: until it ends by itself
};

struct Plan {
  Job job;  // all but variant, parts, removal order and the packing's figures
  std::optional<Arrangement> packed;
  std::optional<Arrangement> hollow;
  std::optional<Arrangement> solid;
  std::optional<Error> not_packed;  // where it fits no tray
};

// Throws what reading and repairing throw. What fits no tray, or cannot be hollowed, divided or
// sliced, is no error here: that way is empty, and job.estimates.refused tells why it cannot be
// made.
Plan plan(const Profile& profile, const PlanOptions& options, const Progress& progress);

}  // namespace packmerger
