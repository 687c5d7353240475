#include "bench/figure.h"

#include <fmt/format.h>

#include "bench/divided_picture.h"
#include "job/prepare.h"
#include "model/stl.h"

namespace packmerger::bench {
namespace {

fs::path path_of(const FigureRun& run, const std::string& name, const std::string& extension) {
  return run.out / (name + extension);
}

// Only what is a job folder is taken away.
void remove_job(const fs::path& folder) {
  if (fs::exists(folder / "job.json")) fs::remove_all(folder);
}

}  // namespace

void write_data(const FigureRun& run, const std::string& name, const nlohmann::ordered_json& data) {
  write_file_whole(path_of(run, name, ".json"), data.dump(2) + "\n");
}

void write_plot(const FigureRun& run, const std::string& name, const Plot& plot) {
  write_file_whole(path_of(run, name, ".svg"), plot_svg(plot));
}

void write_picture(const FigureRun& run, const std::string& name, const Image& image) {
  write_file_whole(path_of(run, name, ".png"), png_bytes(halved(image)));
}

Job prepare_job(const FigureRun& run, const FigureJob& job, const Profile& profile) {
  fmt::print(stderr, "packing {} on {}\n", job.name, profile.id);
  fs::create_directories(run.out / "models");
  fs::create_directories(run.out / "jobs");
  PlanOptions options;
  options.split = job.split;
  options.seed = run.seed;
  options.budget_s = run.budget_s;
  for (std::size_t i = 0; i < job.models.size(); ++i) {
    const std::string suffix = job.models.size() > 1 ? fmt::format("_{}", i + 1) : "";
    options.models.push_back(run.out / "models" / (job.name + suffix + ".stl"));
    write_file_whole(options.models.back(), binary_stl({&job.models[i]}));
  }
  const fs::path folder = run.out / "jobs" / job.name;
  remove_job(folder);
  return prepare(profile, options, Variant::kPacked, folder, Progress());
}

}  // namespace packmerger::bench
