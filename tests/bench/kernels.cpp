// Speed of the packer's innermost loops: depth maps against OSMesa, and the placement kernel
// against plain loops and against the least it has to do.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/random.h"
#include "bench/bare_kernel.h"
#include "bench/bench.h"
#include "bench/kernels.h"
#include "fixtures/z_buffer.h"
#include "pack/drop/fall.h"
#include "pack/maps/depth_map.h"
#include "unit/pack/shapes.h"

namespace packmerger::bench {
namespace {

// ---- depth maps ----------------------------------------------------------------------------

// A piece of a shell, 3 mm thick, in triangles of about 1.6 mm, in many rotations: the packer draws
// each once, and a processor that is shown one of them again remembers what its branches did.
const std::vector<Mesh>& segments() {
  static const std::vector<Mesh> kSegments = [] {
    Random random(7);
    const Mesh segment = shapes::sphere_patch(50, 3, 0, 50);
    std::vector<Mesh> turned;
    for (int i = 0; i < 20; ++i)
      turned.push_back(shapes::turned(segment, shapes::any_rotation(random)));
    return turned;
  }();
  return kSegments;
}

void count_triangles(benchmark::State& state) {
  state.SetItemsProcessed(
      state.iterations() *
      static_cast<std::int64_t>(segments().size() * segments().front().n_triangles()));
}

void depth_maps(benchmark::State& state, double grid_mm) {
  for (auto step : state)
    for (const Mesh& segment : segments())
      benchmark::DoNotOptimize(draw_depth_maps(segment, grid_mm, 0));
  count_triangles(state);
}

// The two views that the same maps' bounds and centres need. All of OSMesa's threads count.
void depth_maps_by_osmesa(benchmark::State& state, double grid_mm) {
  struct View {
    DepthTriangles triangles;
    RayLattice rays;
  };
  std::vector<View> views;
  for (const Mesh& segment : segments()) {
    const DepthMaps maps = draw_depth_maps(segment, grid_mm, 0);
    views.push_back({shapes::depth_triangles(segment),
                     {maps.x0 * grid_mm, maps.y0 * grid_mm, grid_mm / 2, 2 * maps.width + 1,
                      2 * maps.height + 1}});
  }
  DepthRenderer renderer;
  for (auto step : state)
    for (const View& view : views) {
      benchmark::DoNotOptimize(renderer.from_below(view.triangles, view.rays));
      benchmark::DoNotOptimize(renderer.from_above(view.triangles, view.rays));
    }
  count_triangles(state);
}

// ---- placement -----------------------------------------------------------------------------

constexpr int kTray = 150;
constexpr int kPart = 55;
constexpr int kStride = kTray + kFallReadAhead + 1;
constexpr int kPositions = kTray - kPart + 1;  // a row, and rows
constexpr Height kNeverGiveUp = 32767;

// A part of 55 × 55 cells over a tray of 150 × 150.
struct Scene {
  Scene() : field(static_cast<std::size_t>(kStride * (kTray + 1))) {
    Random random(3);
    for (Height& height : field) height = static_cast<Height>(random.below(8000));
    for (int y = 0; y < kPart; ++y)
      for (int x = 0; x < kPart; ++x)
        cells.push_back({static_cast<std::int16_t>(x), static_cast<std::int16_t>(y),
                         static_cast<Height>(random.below(3000))});
  }
  std::vector<Height> field;
  std::vector<HeightCell> cells;
};

void plain_loops(const Scene& scene, int y, Height* heights) {
  std::fill_n(heights, kPositions, Height{0});
  for (const HeightCell& cell : scene.cells) {
    const Height* field = &scene.field[static_cast<std::size_t>((y + cell.y) * kStride + cell.x)];
    for (int i = 0; i < kPositions; ++i)
      heights[i] = std::max(heights[i], static_cast<Height>(field[i] - cell.value));
  }
}

void count_cells(benchmark::State& state) {
  state.SetItemsProcessed(state.iterations() * kPart * kPart * kPositions * kPositions);
}

void fall_by_plain_loops(benchmark::State& state) {
  const Scene scene;
  std::vector<Height> heights(kPositions);
  for (auto step : state)
    for (int y = 0; y < kPositions; ++y) {
      plain_loops(scene, y, heights.data());
      benchmark::DoNotOptimize(heights.data());
      benchmark::ClobberMemory();
    }
  count_cells(state);
}

// Calls kernel(blocks) with all positions in blocks, row after row.
template <typename Kernel>
void all_blocks(benchmark::State& state, const Kernel& kernel) {
  const Scene scene;
  constexpr int kBlocksOfRow = kPositions / kFallPositions;
  static_assert(kPositions == kBlocksOfRow * kFallPositions);
  std::vector<Height> heights(static_cast<std::size_t>(kPositions * kPositions));
  for (auto step : state) {
    std::vector<FallBlock> blocks;
    for (int y = 0; y < kPositions; ++y)
      for (int block = 0; block < kBlocksOfRow; ++block) {
        const int x = block * kFallPositions;
        Height* to = &heights[static_cast<std::size_t>(y * kPositions + x)];
        std::fill_n(to, kFallPositions, Height{0});
        blocks.push_back(
            {&scene.field[static_cast<std::size_t>(y * kStride + x)], to, kNeverGiveUp});
      }
    kernel(scene, blocks);
    benchmark::ClobberMemory();
  }
  count_cells(state);
}

void fall_by_kernel(benchmark::State& state) {
  all_blocks(state, [](const Scene& scene, std::vector<FallBlock>& blocks) {
    benchmark::DoNotOptimize(fall(blocks, kStride, scene.cells));
  });
}

void sums_by_kernel(benchmark::State& state) {
  std::vector<std::int64_t> sums(static_cast<std::size_t>(kPositions * kPositions));
  all_blocks(state, [&](const Scene& scene, std::vector<FallBlock>& blocks) {
    sum_field(blocks, kStride, scene.cells, sums.data());
    benchmark::DoNotOptimize(sums.data());
  });
}

// As many cells as a row of the part has, over as much of the field as stays in the first cache.
void fall_bare(benchmark::State& state) {
  const Scene scene;
  std::vector<BareCell> cells;
  for (int i = 0; i < 1024; ++i)
    cells.push_back({i * 7 % 4096, scene.cells[static_cast<std::size_t>(i)].value});
  std::vector<Height> heights(kBarePositions);
  for (auto step : state) {
    bare_fall(scene.field.data(), cells, heights.data());
    benchmark::DoNotOptimize(heights.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(cells.size()) *
                          kBarePositions);
}

// ---- the verb ------------------------------------------------------------------------------

// Keeps each figure, beside printing it or in place of that.
class KeepingReporter : public benchmark::ConsoleReporter {
 public:
  explicit KeepingReporter(bool prints) : prints_(prints) {}

  bool ReportContext(const Context& context) override {
    return !prints_ || ConsoleReporter::ReportContext(context);
  }
  void ReportRuns(const std::vector<Run>& runs) override {
    if (prints_) ConsoleReporter::ReportRuns(runs);
    for (const Run& run : runs) {
      const auto rate = run.counters.find("items_per_second");
      if (rate != run.counters.end()) rates[run.run_name.function_name] = rate->second.value;
    }
  }
  std::map<std::string, double> rates;  // items a second

 private:
  bool prints_;
};

void register_falls() {
  benchmark::RegisterBenchmark("fall_bare", fall_bare);
  benchmark::RegisterBenchmark("fall", fall_by_kernel);
}

void measure_kernels() {
  using benchmark::RegisterBenchmark;
  RegisterBenchmark("depth_maps_1mm", depth_maps, 1.0)->MeasureProcessCPUTime();
  RegisterBenchmark("depth_maps_2mm", depth_maps, 2.0)->MeasureProcessCPUTime();
  RegisterBenchmark("osmesa_1mm", depth_maps_by_osmesa, 1.0)->MeasureProcessCPUTime();
  RegisterBenchmark("osmesa_2mm", depth_maps_by_osmesa, 2.0)->MeasureProcessCPUTime();
  RegisterBenchmark("fall_plain", fall_by_plain_loops);
  register_falls();
  RegisterBenchmark("sum_field", sums_by_kernel);
  KeepingReporter reporter(true);
  benchmark::RunSpecifiedBenchmarks(&reporter);
  auto& rates = reporter.rates;
  for (const char* grid : {"1mm", "2mm"}) {
    const double ours = rates[fmt::format("depth_maps_{}", grid)];
    fmt::print("depth maps, {} grid: {:.1f} Mtri/s, {:.1f} times OSMesa's\n", grid, ours / 1e6,
               ours / rates[fmt::format("osmesa_{}", grid)]);
  }
  fmt::print(
      "fall: {:.1f} Gcell/s; plain loops {:.1f}, bare {:.1f}; ours / bare = {:.2f}\n"
      "sum_field: {:.1f} Gcell/s\n",
      rates["fall"] / 1e9, rates["fall_plain"] / 1e9, rates["fall_bare"] / 1e9,
      rates["fall"] / rates["fall_bare"], rates["sum_field"] / 1e9);
}

}  // namespace

FallRates measured_fall_rates() {
  register_falls();
  KeepingReporter reporter(false);
  benchmark::RunSpecifiedBenchmarks(&reporter);
  return {reporter.rates["fall"] / 1e9, reporter.rates["fall_bare"] / 1e9};
}

void add_kernels(CLI::App& program) {
  program.add_subcommand("kernels", "Speed of the packer's inner loops")->callback(measure_kernels);
}

}  // namespace packmerger::bench
