// What a way of printing costs, as job.json and the comparison show it.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace packmerger {

enum class EstimateSource {
  kModel,    // the profile's model of the machine
  kSlicer,   // sliced for it
  kProgram,  // what a ready program says of itself in its comments
  kMoves     // counted from a ready program's moves, lengths over speeds
};

// "model", "slicer", "program", "moves", as job.json has them. The inverse takes anything it does
// not know for kModel.
std::string_view source_name(EstimateSource source);
EstimateSource source_named(std::string_view name);

struct Estimate {
  double time_s = 0;
  double model_mm3 = 0;  // as deposited
  double model_g = 0;
  double support_mm3 = 0;  // V_s of docs/ESTIMATES, or what the slicer extrudes for support
  double support_g = 0;
  double cost = 0;       // money: the sum of the three that follow
  std::string currency;  // ISO 4217
  double material_cost = 0;
  double machine_cost = 0;  // its hours
  double hands_cost = 0;    // the minutes by hand
  int parts = 1;
  int trays = 1;
  double assembly_min = 0;  // by hand: gluing the parts, cleaning the trays
  EstimateSource source = EstimateSource::kModel;
};

// Why a way cannot be made, and what can be done, a sentence each.
struct Refusal {
  std::string what;
  std::string hint;
};

// Empty where it does not fit the printer, or cannot be made.
struct Comparison {
  std::optional<Estimate> as_is;   // the model the way its file stands
  std::optional<Estimate> solid;   // the best of six ways up
  std::optional<Estimate> hollow;  // in one piece, the best of six ways up
  std::optional<Estimate> packed;
  // Of the ways that cannot be made, by their names in job.json; one that is empty and not here
  // does not fit.
  std::map<std::string, Refusal, std::less<>> refused;
};

}  // namespace packmerger
