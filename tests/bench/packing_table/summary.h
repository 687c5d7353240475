// Runs of one case as a line of the table: the median of each figure, and its range.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/packing_table/table_case.h"

namespace packmerger::bench {

// Of an even number of values the mean of the middle two. At least one value.
double median(std::vector<double> values);

// "height 42.0 mm (41.2–44.8)" for each figure of the runs; none where all are told alike.
std::string figures_text(const std::vector<nlohmann::ordered_json>& runs);

// What the checks of all runs say together: "apart 0.017 mm, 23 straight up, 5 by a path"; what is
// broken in any of them is told first. Empty where no run has a tray.
std::string check_text(const std::vector<nlohmann::ordered_json>& runs);

// {"row", "packer", "what", "aim", "runs": […], "skipped"}: a measured case.
nlohmann::ordered_json case_json(const TableCase& of,
                                 const std::vector<nlohmann::ordered_json>& runs,
                                 const std::string& skipped);

// Cases as case_json() gives them, as a Markdown table.
std::string packing_table_markdown(const nlohmann::ordered_json& cases);

}  // namespace packmerger::bench
