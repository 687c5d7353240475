// What the paper's figures are made with: one folder, one seed, one budget.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/files.h"
#include "bench/plot.h"
#include "model/job.h"
#include "offscreen/offscreen.h"

namespace packmerger::bench {

struct FigureRun {
  fs::path out;          // exists
  double budget_s = 10;  // of each packing
  std::uint64_t seed = 1;
};

// OUT/NAME.json, OUT/NAME.svg and OUT/NAME.png (at half size), replacing what is there.
void write_data(const FigureRun& run, const std::string& name, const nlohmann::ordered_json& data);
void write_plot(const FigureRun& run, const std::string& name, const Plot& plot);
void write_picture(const FigureRun& run, const std::string& name, const Image& image);

// What is packed for a figure.
struct FigureJob {
  std::string name;
  std::vector<Mesh> models;
  bool split = true;
};

// The job folder OUT/jobs/NAME, made by prepare() of models written to OUT/models; it replaces the
// one that an earlier run left there.
Job prepare_job(const FigureRun& run, const FigureJob& job, const Profile& profile);

// One function a figure.
void figure_3(const FigureRun& run);    // segments before and after pre-merging
void figure_4(const FigureRun& run);    // pre-merging with rising limits
void figure_5(const FigureRun& run);    // the weight w
void figure_7(const FigureRun& run);    // the rotation step
void figure_8(const FigureRun& run);    // the tabu search
void figure_11a(const FigureRun& run);  // with and without the limit on glue areas

}  // namespace packmerger::bench
