// What the table measures: a row is a question, its cases are packers that answer it.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "bench/packing_table/kept_runs.h"
#include "bench/stopwatch.h"

namespace packmerger::bench {

struct RunSettings {
  Seeds seeds;
  fs::path trays;  // exists: trays are written there as STL; empty: nowhere
};

// A run is {"figures": {NAME: number, …}, "seconds", "processor_s", "check"}. `check` is there
// where a tray was made: {"apart_mm", "outside_mm", "straight_up", "by_path", "broken": […]}.
struct TableCase {
  std::string row;     // "mixed-60"
  std::string packer;  // "drop"
  std::string what;    // of the row, for people
  std::string aim;     // of the row; may be empty
  int most_seeds = 1;  // of the search, from 1 on
  double about_s = 0;  // of one run: quick rows are measured first
  // Throws Error{kUnavailable} where something that is needed is not installed.
  std::function<nlohmann::ordered_json(const RunSettings& settings)> measure;
};

// A run that took what the watch says so far.
inline nlohmann::ordered_json timed_run(
    const Stopwatch& watch, nlohmann::ordered_json figures = nlohmann::ordered_json::object()) {
  return {{"figures", std::move(figures)},
          {"seconds", watch.seconds()},
          {"processor_s", watch.processor_seconds()}};
}

std::vector<TableCase> tray_rows();
std::vector<TableCase> speed_rows();

}  // namespace packmerger::bench
