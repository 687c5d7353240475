// One run of the packer where the least height is sought, with its check.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "bench/packing_table/table_case.h"
#include "model/packing.h"

namespace packmerger::bench {

// On one thread. name: of the trays' files, where settings ask for them.
nlohmann::ordered_json height_run(const std::string& name, PackProblem problem, bool anywhere,
                                  double budget_s, const RunSettings& settings);

}  // namespace packmerger::bench
