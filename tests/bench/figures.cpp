#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/bench.h"
#include "bench/figure.h"
#include "bench/table_one.h"

namespace packmerger::bench {
namespace {

struct Arguments {
  std::string out;
  std::vector<std::string> only;
  double budget_s = 10;
  std::uint64_t seed = 1;
  bool markdown = false;
};

using Maker = std::pair<std::string, std::function<void(const FigureRun&)>>;

const std::vector<Maker>& makers() {
  static const std::vector<Maker> kMakers{{"fig3", figure_3}, {"fig4", figure_4},
                                          {"fig5", figure_5}, {"fig7", figure_7},
                                          {"fig8", figure_8}, {"fig11a", figure_11a}};
  return kMakers;
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const auto& [name, make] : makers()) all.push_back(name);
  all.push_back("table1");
  for (const TableRow& row : table_rows()) {
    if (std::find(all.begin(), all.end(), row.figure) == all.end()) all.push_back(row.figure);
    all.push_back(row.name);
  }
  return all;
}

void run(const Arguments& arguments) {
  const FigureRun figure_run{arguments.out, arguments.budget_s, arguments.seed};
  fs::create_directories(figure_run.out);
  const auto wanted = [&](const std::string& name) {
    const std::vector<std::string>& only = arguments.only;
    return only.empty() || std::find(only.begin(), only.end(), name) != only.end();
  };
  for (const auto& [name, make] : makers())
    if (wanted(name)) make(figure_run);
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const TableRow& row : table_rows())
    if (wanted("table1") || wanted(row.figure) || wanted(row.name))
      rows.push_back(make_row(figure_run, row));
  if (wanted("table1")) write_table(figure_run, rows);
  if (arguments.markdown) fmt::print("{}", table_markdown(rows));
}

}  // namespace

void add_figures(CLI::App& program) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* verb = program.add_subcommand("figures", "the paper's figures and Table 1, made again");
  verb->add_option("--out", arguments->out, "the folder they go to")->required();
  verb->add_option("--only", arguments->only,
                   "one figure, table1, or one of its rows; may be given several times")
      ->check(CLI::IsMember(names()));
  verb->add_option("--budget", arguments->budget_s, "seconds for each packing")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  verb->add_option("--seed", arguments->seed)->capture_default_str();
  verb->add_flag("--markdown", arguments->markdown, "prints the rows of Table 1 that were made");
  verb->callback([arguments] { run(*arguments); });
}

}  // namespace packmerger::bench
