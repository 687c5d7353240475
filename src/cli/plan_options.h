// The options that prepare and compare share: which models, how large, how they are treated.
#pragma once

#include <CLI/CLI.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "job/plan.h"
#include "model/printer.h"

namespace packmerger::cli {

struct PlanArguments {
  std::vector<std::string> models;
  int copies = 1;
  std::string units = "mm";
  double scale = 1;
  std::optional<double> size_mm;
  bool no_split = false;
  bool no_hollow = false;
  std::uint64_t seed = 1;
  double budget_s = 0;
  std::vector<std::string> settings;
};

// Adds the options to a verb; `arguments` must outlive the parsing.
void add_plan_options(CLI::App& verb, PlanArguments& arguments);

PlanOptions plan_options(const PlanArguments& arguments);

// Throws Error{kUsage}, which lists the profiles, where none was named.
void check_profile_given(bool given);

// Reads the profile and applies --set.
Profile chosen_profile(const std::string& id_or_path, const PlanArguments& arguments);

// A line for each model with its size, so that a wrong unit is seen; copies share one.
std::string sizes_of(const Job& job);

// The machine as the head of a table: "Objet30 (objet30)".
std::string title_of(const Profile& profile);

}  // namespace packmerger::cli
