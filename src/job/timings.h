// The clock of a job's stages, for timings_s in job.json.
#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace packmerger {

using StageTimes = std::vector<std::pair<std::string, double>>;  // stage, s

// Runs work() and writes down how long it took. Returns what work() returns.
template <typename Work>
decltype(auto) timed(StageTimes& times, const std::string& stage, const Work& work) {
  struct Entry {
    StageTimes& times;
    const std::string& stage;
    std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
    ~Entry() {
      const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
      times.emplace_back(stage, took.count());
    }
  } entry{times, stage};
  return work();
}

}  // namespace packmerger
