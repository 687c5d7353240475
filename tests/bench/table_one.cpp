#include "bench/table_one.h"

#include <fmt/format.h>

#include <algorithm>

#include "bench/models.h"
#include "job/compare/advice.h"
#include "picture/preview.h"

namespace packmerger::bench {
namespace {

using Json = nlohmann::ordered_json;

std::vector<Mesh> arch() { return {arch_model()}; }
std::vector<Mesh> bunny() { return {bunny_model()}; }
std::vector<Mesh> molecule() { return {molecule_model()}; }
std::vector<Mesh> sphere() { return {sphere_model()}; }
std::vector<Mesh> table() { return {table_model()}; }
std::vector<Mesh> group() { return group_models(1); }
std::vector<Mesh> large_group() { return group_models(kSecondGroupScale); }

constexpr double hours(double h, double min) { return 3600 * h + 60 * min; }

std::optional<double> ratio(std::optional<double> over, std::optional<double> under) {
  if (!over || !under || *under == 0) return std::nullopt;
  return *over / *under;
}

template <typename Number>
Json or_null(const std::optional<Number>& number) {
  return number ? Json(*number) : Json(nullptr);
}

std::optional<double> time_of(const std::optional<Estimate>& estimate) {
  return estimate ? std::optional(estimate->time_s) : std::nullopt;
}

std::optional<double> support_of(const std::optional<Estimate>& estimate) {
  return estimate ? std::optional(estimate->support_g) : std::nullopt;
}

double seconds_of(const Job& job, const std::vector<std::string>& stages) {
  double sum = 0;
  for (const auto& [stage, seconds] : job.timings_s)
    if (std::find(stages.begin(), stages.end(), stage) != stages.end()) sum += seconds;
  return sum;
}

std::string cell(const Json& number, int digits) {
  return number.is_null() ? "–" : fmt::format("{:.{}f}", number.get<double>(), digits);
}

std::string beside(const Json& row, const std::string& key, int digits) {
  return cell(row[key], digits) + " | " + cell(row["paper_" + key], digits);
}

}  // namespace

const std::vector<TableRow>& table_rows() {
  static const std::vector<TableRow> kRows{
      {"arch", "fig9", "uprint-plus", arch, true, {{}, hours(14, 18), {}, {}, 11, 124}},
      {"bunny", "fig1", "objet30", bunny, true, {hours(13, 43), hours(9, 30), 351, 229, 13, 97}},
      {"molecule",
       "fig11",
       "objet30",
       molecule,
       true,
       {hours(15, 55), hours(12, 3), 264, 160, 12, 56}},
      {"sphere", "fig10", "objet30", sphere, true, {hours(6, 23), hours(4, 13), 110, 39, 6, 28}},
      {"table", "fig12", "replicator", table, true, {hours(2, 43), hours(2, 18), 17, 11, {}, {}}},
      {"group_1", "fig13", "replicator", group, false, {hours(1, 5), hours(1, 2), 16, 16, 4, 14}},
      {"group_2",
       "fig13",
       "replicator",
       large_group,
       false,
       {hours(6, 18), hours(6, 14), 53, 52, 5, 41}}};
  return kRows;
}

Json row_json(const TableRow& row, const Job& job) {
  const Comparison& e = job.estimates;
  const PaperRow& paper = row.paper;
  return {{"name", row.name},
          {"printer", row.printer},
          {"time_ratio", or_null(ratio(time_of(e.packed), time_of(e.as_is)))},
          {"support_ratio", or_null(ratio(support_of(e.packed), support_of(e.as_is)))},
          {"parts", job.parts.size()},
          {"seconds", seconds_of(job, {"divide", "pack"})},
          {"best_of_six_time_ratio", or_null(ratio(time_of(e.packed), time_of(e.solid)))},
          {"best_of_six_support_ratio", or_null(ratio(support_of(e.packed), support_of(e.solid)))},
          {"paper_time_ratio", or_null(ratio(paper.packed_s, paper.solid_s))},
          {"paper_support_ratio", or_null(ratio(paper.packed_support, paper.solid_support))},
          {"paper_parts", or_null(paper.parts)},
          {"paper_seconds", or_null(paper.seconds)},
          {"solid_time_s", or_null(time_of(e.as_is))},
          {"solid_support_g", or_null(support_of(e.as_is))},
          {"best_of_six_time_s", or_null(time_of(e.solid))},
          {"best_of_six_support_g", or_null(support_of(e.solid))},
          {"packed_time_s", or_null(time_of(e.packed))},
          {"packed_support_g", or_null(support_of(e.packed))},
          {"packed_support_mm3", job.support_mm3},
          {"bbox_mm3", job.bbox_mm3},
          {"height_mm", job.height_mm},
          {"trays", e.packed->trays},
          {"shell_volume_mm3", job.shell_volume_mm3},
          {"recommendation", advice(e).text}};
}

std::string table_markdown(const Json& rows) {
  std::string text =
      "| row | printer | time ÷ solid | paper | support ÷ solid | paper | parts | paper | s | "
      "paper "
      "| time ÷ best of six | support ÷ best of six |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Json& row : rows)
    text += fmt::format(
        "| {} | {} | {} | {} | {} | {} | {} | {} |\n", row["name"].get<std::string>(),
        row["printer"].get<std::string>(), beside(row, "time_ratio", 2),
        beside(row, "support_ratio", 2), beside(row, "parts", 0), beside(row, "seconds", 0),
        cell(row["best_of_six_time_ratio"], 2), cell(row["best_of_six_support_ratio"], 2));
  return text;
}

Json make_row(const FigureRun& run, const TableRow& row) {
  const Job job = prepare_job(run, {row.name, row.models(), row.split}, read_profile(row.printer));
  const auto same_figure = [&](const TableRow& other) { return other.figure == row.figure; };
  const bool alone = std::count_if(table_rows().begin(), table_rows().end(), same_figure) == 1;
  const std::string name = alone ? row.figure : row.figure + "_" + row.name;
  write_picture(run, name, preview_picture(job));
  Json entry = row_json(row, job);
  write_data(run, name, entry);
  return entry;
}

void write_table(const FigureRun& run, const Json& rows) {
  write_data(run, "table1", {{"rows", rows}});
  write_file_whole(run.out / "table1.md", table_markdown(rows));
  Plot plot{
      "Table 1: packed ÷ solid", "time", "support", {{"ours", {}, false}, {"paper", {}, false}}};
  const auto add = [](PlotSeries& series, const Json& row, const std::string& prefix) {
    const Json& time = row[prefix + "time_ratio"];
    const Json& support = row[prefix + "support_ratio"];
    if (!time.is_null() && !support.is_null())
      series.points.push_back({time, support, row["name"]});
  };
  for (const Json& row : rows) {
    add(plot.series[0], row, "");
    add(plot.series[1], row, "paper_");
  }
  write_plot(run, "table1", plot);
}

}  // namespace packmerger::bench
