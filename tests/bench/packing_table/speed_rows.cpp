// The rows that end in a time, or in a share of one.
#include <malloc.h>

#include <atomic>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "bench/figure.h"
#include "bench/models.h"
#include "bench/packing_table/instances.h"
#include "bench/packing_table/table_case.h"
#include "bench/reference_problem.h"
#include "bench/speed_ratios.h"
#include "bench/stopwatch.h"
#include "bench/table_one.h"
#include "pack/pack.h"

namespace packmerger::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kTableOneBudget_s = 60;
constexpr int kTableOneSeeds = 3;

// Reads and writes more memory than any cache holds, over and over, while it lives.
class MemorySweep {
 public:
  MemorySweep() : thread_([this] { sweep(); }) {}
  MemorySweep(const MemorySweep&) = delete;
  MemorySweep& operator=(const MemorySweep&) = delete;
  ~MemorySweep() {
    done_ = true;
    thread_.join();
  }

 private:
  static constexpr std::size_t kWords = std::size_t{64} << 20;  // of 8 bytes
  static constexpr std::size_t kLine = 8;                       // words that are fetched together

  void sweep() {
    std::vector<std::uint64_t> memory(kWords);
    while (!done_)
      for (std::size_t i = 0; i < memory.size() && !done_; i += kLine) {
        volatile std::uint64_t& word = memory[i];  // nobody reads it, but it shall be written
        word = word + 1;
      }
  }

  std::atomic<bool> done_ = false;
  std::thread thread_;
};

PackProblem paper_bunny() {
  Profile profile = read_profile("objet30");
  profile.shape.segmentation = Segmentation::kPaper;
  return paper_problem(bunny_model(), profile, profile.pack.grid_mm,
                       profile.pack.rotation_step_deg);
}

Json one_packing_run(const RunSettings&) {
  const Stopwatch watch;
  const PackProblem problem = paper_bunny();
  Json quiet, swept;
  measure_one_packing(problem, quiet);
  {
    const MemorySweep sweep;
    measure_one_packing(problem, swept);
  }
  measure_kernel(quiet);
  const double fast_s = quiet["one_packing"]["fast_s"];
  return timed_run(
      watch, {{"one_packing_ratio", quiet["one_packing_ratio"]},
              {"packing_ms", 1000 * fast_s},
              {"slower_beside_a_sweep", swept["one_packing"]["fast_s"].get<double>() / fast_s},
              {"kernel_fraction", quiet["kernel_fraction"]}});
}

Json search_run(const RunSettings&) {
  const Stopwatch watch;
  Json told;
  measure_search(paper_bunny(), told);
  return timed_run(watch, {{"search_ratio", told["search_ratio"]},
                           {"search_with_gap_ratio", told["search_with_gap_ratio"]},
                           {"reference_s", told["search"]["reference_s"]}});
}

Json prepare_run(const RunSettings& settings) {
  const TemporaryFolder folder;
  const Stopwatch watch;
  const Job job = prepare_job({folder.path(), 0, settings.seeds.search}, {"bunny", {bunny_model()}},
                              read_profile("objet30"));
  return timed_run(watch, {{"cost", job.estimates.packed->cost}, {"parts", job.parts.size()}});
}

Json table_one_run(const TableRow& row, const RunSettings& settings) {
  const TemporaryFolder folder;
  const Stopwatch watch;
  const Json made = make_row({folder.path(), kTableOneBudget_s, settings.seeds.search}, row);
  Json figures;
  for (const char* name : {"time_ratio", "support_ratio", "parts"})
    if (!made[name].is_null()) figures[name] = made[name];
  return timed_run(watch, figures);
}

// The most memory that this program has held since the last reset.
void reset_peak_memory() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
}
double peak_memory_mb() {
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);)
    if (line.rfind("VmHWM:", 0) == 0) return std::stod(line.substr(6)) / 1024;
  return 0;
}

Json growth_run(int parts, bool all_alike, const RunSettings& settings) {
  PackProblem problem = growth_problem(parts, all_alike, settings.seeds.instance);
  problem.seed = settings.seeds.search;
  reset_peak_memory();
  const Stopwatch watch;
  const Packing packing = pack(problem, {});
  return timed_run(watch, {{"trays", packing.trays.size()}, {"peak_memory_mb", peak_memory_mb()}});
}

}  // namespace

std::vector<TableCase> speed_rows() {
  std::vector<TableCase> cases;
  cases.push_back({"one-packing", "default",
                   "one packing against the paper's: the bunny's clusters, 2 mm, 60°",
                   "40, kernel 0.9, 2 × beside a sweep", 1, 10, one_packing_run});
  cases.push_back(
      {"search", "default", "search against the paper's, to equal cost", "100", 1, 40, search_run});
  cases.push_back({"bunny-job", "default", "bunny, 138 mm, objet30: model to job folder", "5 s", 3,
                   15, prepare_run});
  for (const bool all_alike : {false, true})
    for (const int parts : {10, 30, 100, 200, 300, 1000}) {
      const std::string kind = all_alike ? "copies of one part" : "parts, all different";
      cases.push_back({(all_alike ? "copies-" : "growth-") + std::to_string(parts), "default",
                       std::to_string(parts) + " " + kind + ", objet30", "", 1, parts / 10.0,
                       [parts, all_alike](const RunSettings& settings) {
                         return growth_run(parts, all_alike, settings);
                       }});
    }
  for (const TableRow& row : table_rows())
    if (row.printer == "objet30")
      cases.push_back({"table1-" + row.name, "default", "Table 1: " + row.name + ", 60 s",
                       row.name == "bunny"    ? "support 0.50, 10 parts"
                       : row.name == "sphere" ? "support 0.355, 12 parts"
                                              : "",
                       kTableOneSeeds, 100, [&row](const RunSettings& settings) {
                         return table_one_run(row, settings);
                       }});
  return cases;
}

}  // namespace packmerger::bench
