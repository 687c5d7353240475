// The rows of the paper's Table 1, measured again, and the figures that show them (1, 9 to 13).
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/figure.h"

namespace packmerger::bench {

// What the paper says of one row; empty where it says nothing or what cannot be ("did not fit").
struct PaperRow {
  std::optional<double> solid_s;
  std::optional<double> packed_s;
  std::optional<double> solid_support;  // g; packed ÷ solid is all that is compared
  std::optional<double> packed_support;
  std::optional<int> parts;
  std::optional<double> seconds;  // of optimisation
};

struct TableRow {
  std::string name;
  std::string figure;  // "fig10"
  std::string printer;
  std::vector<Mesh> (*models)();
  bool split = true;
  PaperRow paper;
};

// In the paper's order. Its slips are put right: the molecule's 156 g saved are 104 g, the table's
// 18 % of the time are 15 %.
const std::vector<TableRow>& table_rows();

// One entry of table1.json. `time_ratio` and `support_ratio` divide the packed tray by the solid
// model as its file stands, `best_of_six_…` by the solid model the best of six ways up; each null
// where the model does not fit that way, and the support's where that needs none. `seconds`:
// dividing and packing. Times s, masses g, lengths mm.
nlohmann::ordered_json row_json(const TableRow& row, const Job& job);

// The rows as a Markdown table, our ratios beside the paper's.
std::string table_markdown(const nlohmann::ordered_json& rows);

// Packs a row's models and writes a picture: OUT/FIGURE.png and .json, and of a figure with two
// rows OUT/FIGURE_ROW.*. Returns the row's entry.
nlohmann::ordered_json make_row(const FigureRun& run, const TableRow& row);

// OUT/table1.json {"rows": […]}, table1.md and table1.svg.
void write_table(const FigureRun& run, const nlohmann::ordered_json& rows);

}  // namespace packmerger::bench
