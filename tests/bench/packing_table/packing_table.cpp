#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "base/error.h"
#include "bench/bench.h"
#include "bench/packing_table/kept_runs.h"
#include "bench/packing_table/summary.h"
#include "bench/packing_table/table_case.h"

namespace packmerger::bench {
namespace {

using Json = nlohmann::ordered_json;

struct Arguments {
  std::vector<std::string> only;
  std::vector<std::string> packers;
  std::string keep;
  std::string trays;
  int seeds = 5;
  std::uint64_t instance = 1;
  bool json = false;
};

std::vector<TableCase> all_cases() {
  std::vector<TableCase> cases = tray_rows();
  for (TableCase& one : speed_rows()) cases.push_back(std::move(one));
  return cases;
}

std::set<std::string> names(std::string TableCase::*name) {
  std::set<std::string> all;
  for (const TableCase& one : all_cases()) all.insert(one.*name);
  return all;
}

std::vector<TableCase> wanted(const Arguments& arguments) {
  const auto named = [](const std::vector<std::string>& list, const std::string& name) {
    return list.empty() || std::find(list.begin(), list.end(), name) != list.end();
  };
  std::vector<TableCase> cases;
  for (TableCase& one : all_cases())
    if (named(arguments.only, one.row) && named(arguments.packers, one.packer))
      cases.push_back(std::move(one));
  return cases;
}

// A case's runs, those kept from before among them.
Json measured(const TableCase& one, const Arguments& arguments, const KeptRuns& kept) {
  std::vector<Json> runs;
  const int seeds = std::min(arguments.seeds, one.most_seeds);
  for (int seed = 1; seed <= seeds; ++seed) {
    const Seeds of{arguments.instance, static_cast<std::uint64_t>(seed)};
    std::optional<Json> run = kept.find(one.row, one.packer, of);
    if (!run) {
      fmt::print(stderr, "{}, {}, seed {} of {}\n", one.row, one.packer, seed, seeds);
      try {
        run = one.measure({of, arguments.trays});
      } catch (const Error& error) {
        if (error.fault() != Fault::kUnavailable) throw;
        return case_json(one, {}, std::string("skipped: ") + error.what() + ". " + error.hint());
      }
      kept.keep(one.row, one.packer, of, *run);
    }
    runs.push_back(*run);
  }
  return case_json(one, runs, "");
}

void run(const Arguments& arguments) {
  if (!arguments.trays.empty()) fs::create_directories(arguments.trays);
  const auto held_for = measured_for(PACKMERGER_SOURCE_FOLDER);
  if (!arguments.keep.empty() && !held_for)
    fmt::print(stderr, "The source tree has changes or no commit, so no run is kept.\n");
  const KeptRuns kept(arguments.keep, held_for);
  const std::vector<TableCase> cases = wanted(arguments);
  std::vector<std::size_t> quick_first(cases.size());
  for (std::size_t i = 0; i < cases.size(); ++i) quick_first[i] = i;
  std::stable_sort(quick_first.begin(), quick_first.end(), [&](std::size_t a, std::size_t b) {
    return cases[a].about_s < cases[b].about_s;
  });
  std::vector<Json> told(cases.size());
  for (const std::size_t i : quick_first) told[i] = measured(cases[i], arguments, kept);
  const Json table = told;
  fmt::print("{}", arguments.json ? table.dump(2) + "\n" : packing_table_markdown(table));
}

}  // namespace

void add_packing_table(CLI::App& program) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* verb = program.add_subcommand(
      "packing-table", "the figures of docs/PACKING, each tray checked on its meshes");
  verb->add_option("--only", arguments->only, "a row; may be given several times")
      ->check(CLI::IsMember(names(&TableCase::row)));
  verb->add_option("--packer", arguments->packers, "of these alone; may be given several times")
      ->check(CLI::IsMember(names(&TableCase::packer)));
  verb->add_option("--keep", arguments->keep,
                   "a folder for what was measured: a table that was stopped goes on from there");
  verb->add_option("--trays", arguments->trays, "a folder for the trays measured now, as STL");
  verb->add_option("--seeds", arguments->seeds, "of the search: from 1 to this")
      ->capture_default_str()
      ->check(CLI::Range(1, 5));
  verb->add_option("--instance", arguments->instance, "seed of what is packed")
      ->capture_default_str();
  verb->add_flag("--json", arguments->json, "every run, instead of the table");
  verb->callback([arguments] { run(*arguments); });
}

}  // namespace packmerger::bench
