// Figures 3, 4 and 11(a): segments before and after pre-merging.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "bench/divided_picture.h"
#include "bench/figure.h"
#include "bench/models.h"
#include "job/divide.h"
#include "shape/divide/adjacency.h"

namespace packmerger::bench {
namespace {

// What pre-merging demands.
struct Limits {
  double glue_area_mm2 = 0;
  double volume_fraction = 0;
};

// A model divided with these limits, and what there is to tell of it.
struct Division {
  std::string name;
  Divided divided;
  std::vector<double> volumes;    // of V_o, ascending
  std::vector<double> areas_mm2;  // cross-sections, ascending
};

Division division(const FigureRun& run, const std::string& name, const Mesh& model,
                  const Limits& limits) {
  fmt::print(stderr, "dividing: {}\n", name);
  Profile profile = read_profile("objet30");
  profile.shape.min_glue_area_mm2 = limits.glue_area_mm2;
  profile.shape.min_volume_fraction = limits.volume_fraction;
  Warnings warnings;
  Division result{name, divide(model, profile, true, run.seed, warnings, Progress()), {}, {}};
  const auto& [shell, tets, segments, clusters, before, after, tolerance] = result.divided;
  result.volumes.assign(static_cast<std::size_t>(segments.count), 0);
  for (int t = 0; t < tets.count(); ++t)
    result.volumes[segments.of_tetrahedron[t]] += tets.volume_mm3(t) / shell.volume_mm3;
  for (const SegmentEdge& edge : adjacency(tets, segments))
    result.areas_mm2.push_back(edge.area_mm2);
  std::sort(result.volumes.begin(), result.volumes.end());
  std::sort(result.areas_mm2.begin(), result.areas_mm2.end());
  return result;
}

nlohmann::ordered_json told(const Division& division) {
  return {{"name", division.name},
          {"segments", division.divided.segments.count},
          {"smallest_volume_fraction", division.volumes.front()},
          {"smallest_area_mm2", division.areas_mm2.empty() ? 0 : division.areas_mm2.front()},
          {"volume_fractions", division.volumes},
          {"areas_mm2", division.areas_mm2}};
}

// Values by their rank, the smallest first.
PlotSeries ranked(const std::string& name, const std::vector<double>& values, double unit) {
  PlotSeries series{name, {}};
  for (std::size_t i = 0; i < values.size(); ++i)
    series.points.push_back({static_cast<double>(i + 1), values[i] / unit, ""});
  return series;
}

Image pair_of(const Division& left, const Division& right) {
  return cut_picture(outside_of(left.divided.tets, left.divided.segments, false),
                     outside_of(right.divided.tets, right.divided.segments, false));
}

}  // namespace

void figure_3(const FigureRun& run) {
  const Mesh bunny = bunny_model();
  const ShapeSettings settings = read_profile("objet30").shape;
  const Division clusters = division(run, "clusters", bunny, {});
  const Division merged = division(run, "pre-merged", bunny,
                                   {settings.min_glue_area_mm2, settings.min_volume_fraction});
  write_data(run, "fig3", {{"divisions", {told(clusters), told(merged)}}});
  write_picture(run, "fig3", pair_of(clusters, merged));
  write_plot(
      run, "fig3",
      {"Volumes of the bunny's segments",
       "segment, smallest first",
       "% of the shell",
       {ranked("clusters", clusters.volumes, 0.01), ranked("pre-merged", merged.volumes, 0.01)}});
}

void figure_4(const FigureRun& run) {
  const Mesh bunny = bunny_model();
  constexpr std::array<Limits, 4> kSteps{{{0, 0}, {2.5, 0.0125}, {5, 0.025}, {10, 0.05}}};
  std::vector<Division> divisions;
  nlohmann::ordered_json data;
  PlotSeries count{"bunny, 138 mm tall", {}};
  for (const Limits& limits : kSteps) {
    const std::string name =
        fmt::format("{:g} mm², {:g} %", limits.glue_area_mm2, 100 * limits.volume_fraction);
    divisions.push_back(division(run, name, bunny, limits));
    data["divisions"].push_back(told(divisions.back()));
    count.points.push_back({100 * limits.volume_fraction,
                            static_cast<double>(divisions.back().divided.segments.count), name});
  }
  write_data(run, "fig4", data);
  write_picture(run, "fig4_ab", pair_of(divisions[0], divisions[1]));
  write_picture(run, "fig4_cd", pair_of(divisions[2], divisions[3]));
  write_plot(run, "fig4",
             {"Segments left by pre-merging",
              "least volume, % of the shell (with it the least cross-section)",
              "segments",
              {count}});
}

void figure_11a(const FigureRun& run) {
  const Mesh molecule = molecule_model();
  const ShapeSettings settings = read_profile("objet30").shape;
  // More than a stick's own section, so that no cut may go through one.
  constexpr double kMoreThanAStick_mm2 = 60;
  std::vector<Division> divisions;
  nlohmann::ordered_json data;
  Plot plot{
      "Cross-sections between the molecule's segments", "cross-section, smallest first", "mm²", {}};
  for (const double area_mm2 : {0.0, settings.min_glue_area_mm2, kMoreThanAStick_mm2}) {
    divisions.push_back(division(run, fmt::format("at least {:g} mm²", area_mm2), molecule,
                                 {area_mm2, settings.min_volume_fraction}));
    data["divisions"].push_back(told(divisions.back()));
    plot.series.push_back(ranked(divisions.back().name, divisions.back().areas_mm2, 1));
  }
  write_data(run, "fig11a", data);
  write_picture(run, "fig11a", pair_of(divisions[0], divisions[1]));
  write_picture(run, "fig11a_60mm2", pair_of(divisions[0], divisions[2]));
  write_plot(run, "fig11a", plot);
}

}  // namespace packmerger::bench
