// Figure 5: what the weight w of equation (1) does to a packing.
#include <fmt/format.h>

#include "bench/figure.h"
#include "bench/models.h"
#include "picture/preview.h"

namespace packmerger::bench {

void figure_5(const FigureRun& run) {
  nlohmann::ordered_json data;
  Plot plot{"Box and support of packed trays", "V_bp, cm³", "V_s, cm³", {{"sphere, 80 mm", {}}}};
  for (const double weight : {0.0, 0.5, 1.0}) {
    Profile profile = read_profile("objet30");
    profile.pack.objective = Objective::kPaper;
    profile.pack.weight = weight;
    const std::string name = fmt::format("fig5_w{:g}", weight);
    const Job job = prepare_job(run, {name, {sphere_model()}}, profile);
    data["packings"].push_back({{"weight", weight},
                                {"bbox_mm3", job.bbox_mm3},
                                {"support_mm3", job.support_mm3},
                                {"cost", job.cost},
                                {"height_mm", job.height_mm},
                                {"parts", job.parts.size()}});
    plot.series.front().points.push_back(
        {job.bbox_mm3 / 1000, job.support_mm3 / 1000, fmt::format("w = {:g}", weight)});
    write_picture(run, name, preview_picture(job));
  }
  write_data(run, "fig5", data);
  write_plot(run, "fig5", plot);
}

}  // namespace packmerger::bench
