#include "shape/divide/premerge.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "shape/divide/adjacency.h"
#include "shape/divide/fit.h"
#include "shape/divide/manifold_parts.h"

namespace packmerger {
namespace {

// The paper's weighted graph G(V, E) while edges are contracted. A group keeps the label of its
// lowest member; the labels of the others are empty.
class SegmentGraph {
 public:
  SegmentGraph(const TetMesh& mesh, const Segments& segments, const FitTest& fit)
      : fit_(fit),
        volumes_(segment_volumes(mesh, segments)),
        extents_(fit.extents(mesh, segments)),
        areas_(segments.count),
        round_cavities_(segments_round_cavities(mesh, segments)) {
    for (int label = 0; label < segments.count; ++label) groups_.push_back({label});
    for (const SegmentEdge& edge : adjacency(mesh, segments)) {
      areas_[edge.a][edge.b] = edge.area_mm2;
      areas_[edge.b][edge.a] = edge.area_mm2;
    }
  }

  int count() const { return static_cast<int>(groups_.size()); }
  bool is_alive(int v) const { return !groups_[v].empty(); }
  double volume_mm3(int v) const { return volumes_[v]; }
  const std::map<int, double>& areas_mm2(int v) const { return areas_[v]; }  // by neighbour
  bool may_merge(int a, int b) const {
    return fit_.fits(extents_[a], extents_[b]) && !shuts_a_cavity(a, b);
  }

  // Contracts the edge between two neighbours.
  void merge(int a, int b) {
    const auto [into, from] = std::minmax(a, b);
    groups_[into].insert(groups_[into].end(), groups_[from].begin(), groups_[from].end());
    groups_[from].clear();
    volumes_[into] += volumes_[from];
    FitTest::unite(extents_[into], extents_[from]);
    for (const auto& [other, area] : areas_[from]) {
      areas_[other].erase(from);
      if (other == into) continue;
      areas_[into][other] += area;
      areas_[other][into] = areas_[into][other];
    }
    areas_[from].clear();
    for (std::vector<int>& round_it : round_cavities_) {
      std::replace(round_it.begin(), round_it.end(), from, into);
      std::sort(round_it.begin(), round_it.end());
      round_it.erase(std::unique(round_it.begin(), round_it.end()), round_it.end());
    }
  }

  // The groups that are left, in the order of their lowest labels.
  std::vector<std::vector<int>> groups() const {
    std::vector<std::vector<int>> left;
    for (const auto& group : groups_)
      if (!group.empty()) left.push_back(group);
    return left;
  }

 private:
  // Nobody could take support out of a cavity that lies in one part.
  bool shuts_a_cavity(int a, int b) const {
    const auto pair = std::minmax(a, b);
    const std::vector<int> both{pair.first, pair.second};
    return std::find(round_cavities_.begin(), round_cavities_.end(), both) != round_cavities_.end();
  }

  const FitTest& fit_;
  std::vector<double> volumes_;
  std::vector<FitTest::Extents> extents_;
  std::vector<std::map<int, double>> areas_;
  std::vector<std::vector<int>> round_cavities_;  // the groups that each cavity touches, sorted
  std::vector<std::vector<int>> groups_;
};

struct Pair {
  int a = -1;
  int b = -1;
};

// The permitted merge across the smallest cross-section below the limit; a < 0: none.
Pair smallest_glue(const SegmentGraph& graph, double min_area_mm2) {
  Pair best;
  double smallest = min_area_mm2;
  for (int a = 0; a < graph.count(); ++a)
    for (const auto& [b, area] : graph.areas_mm2(a)) {
      if (b < a || area >= smallest || !graph.may_merge(a, b)) continue;
      best = {a, b};
      smallest = area;
    }
  return best;
}

// The smallest segment below the limit that may merge, and its smallest such neighbour; a < 0:
// none.
Pair smallest_segment(const SegmentGraph& graph, double min_volume_mm3) {
  Pair best;
  for (int a = 0; a < graph.count(); ++a) {
    if (!graph.is_alive(a) || graph.volume_mm3(a) >= min_volume_mm3) continue;
    if (best.a >= 0 && graph.volume_mm3(a) >= graph.volume_mm3(best.a)) continue;
    int with = -1;
    for (const auto& [b, area] : graph.areas_mm2(a))
      if ((with < 0 || graph.volume_mm3(b) < graph.volume_mm3(with)) && graph.may_merge(a, b))
        with = b;
    if (with >= 0) best = {a, with};
  }
  return best;
}

// Merges until nothing is left to mend.
std::vector<std::vector<int>> merged_groups(SegmentGraph graph, double min_area_mm2,
                                            double min_volume_mm3, const Progress& progress) {
  const auto contract = [&](const auto& next) {
    for (Pair pair = next(); pair.a >= 0; pair = next()) {
      progress.check();
      graph.merge(pair.a, pair.b);
    }
  };
  contract([&] { return smallest_glue(graph, min_area_mm2); });
  contract([&] { return smallest_segment(graph, min_volume_mm3); });
  return graph.groups();
}

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", value);
  return text.data();
}

void warn_of_leftovers(const SegmentGraph& graph, double volume_mm3, const ShapeSettings& settings,
                       Warnings& warnings) {
  int segments = 0, small_segments = 0, joints = 0, small_joints = 0;
  double least_volume = volume_mm3, least_area = settings.min_glue_area_mm2;
  for (int a = 0; a < graph.count(); ++a) {
    ++segments;
    least_volume = std::min(least_volume, graph.volume_mm3(a));
    if (graph.volume_mm3(a) < settings.min_volume_fraction * volume_mm3) ++small_segments;
    for (const auto& [b, area] : graph.areas_mm2(a)) {
      if (b < a) continue;
      ++joints;
      least_area = std::min(least_area, area);
      if (area < settings.min_glue_area_mm2) ++small_joints;
    }
  }
  if (small_segments > 0)
    warnings.push_back(
        {"small_segment",
         std::to_string(small_segments) + " of " + std::to_string(segments) +
             " segments stay smaller than " + number(100 * settings.min_volume_fraction) +
             " % of the model's volume (the smallest " + number(100 * least_volume / volume_mm3) +
             " %), because no merge is left that fits the build volume and shuts no cavity."});
  if (small_joints > 0)
    warnings.push_back(
        {"small_glue_area",
         std::to_string(small_joints) + " of " + std::to_string(joints) +
             " joints between segments stay smaller than " + number(settings.min_glue_area_mm2) +
             " mm² (the smallest " + number(least_area) +
             " mm²), because no merge is left that fits the build volume and shuts no cavity."});
}

}  // namespace

Segments premerge(TetMesh& mesh, const Segments& segments, const ShapeSettings& settings,
                  const BuildVolume& build, Warnings& warnings, const Progress& progress) {
  const FitTest fit(build);
  const double volume = total_volume_mm3(mesh);
  Segments merged = segments;
  // Making parts manifold moves a little area and volume, so the merged parts are looked at again
  // until none is merged any more.
  for (int round = 0;; ++round) {
    progress.report("merging segments", round == 0 ? 0 : 0.5);
    const int before = merged.count;
    merged =
        united(merged, merged_groups(SegmentGraph(mesh, merged, fit), settings.min_glue_area_mm2,
                                     settings.min_volume_fraction * volume, progress));
    if (round > 0 && merged.count == before) break;
    make_manifold(mesh, merged, progress, kFreeReach);
  }
  warn_of_leftovers(SegmentGraph(mesh, merged, fit), volume, settings, warnings);
  progress.report("merging segments", 1);
  return merged;
}

}  // namespace packmerger
