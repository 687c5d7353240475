#include "pack/part.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/error.h"

namespace packmerger {
namespace {

constexpr double kQuarter = std::numbers::pi / 2;

constexpr double kMapMemory_bytes = 512e6;  // for the maps of all parts in all rotations
constexpr double kBytesPerCell = 4 * sizeof(MapCell);
constexpr double kMostCellsFromCentre = 30000;  // MapCell counts them in 16 bits

// Cells of the larger views of a part; its maps take about that in each rotation.
double cells_seen(const TriangleSoup& surface, double grid_mm) {
  Box3 box;
  for (const Vec3& point : surface.points) box.extend(point);
  const Vec3 cells = box.sizes() / grid_mm + Vec3(2, 2, 2);
  return cells.prod() / cells.minCoeff();
}

std::size_t ways_tried(Effort effort) {
  switch (effort) {
    case Effort::kSearch:
      return 8;
    case Effort::kPlace:
      return 10;
    case Effort::kAlone:
      return 1;
  }
  return 0;
}

// What the z-buffer may lose: a facet's corner is snapped to 1/256 of the ray step, half a cell.
double sampling_slack(double grid_mm) { return 0.004 * grid_mm + 1e-3; }

// Least horizontal distance between the points of two cells that lie `cells` apart on one axis.
double apart(int cells, double grid_mm) { return std::max(0, std::abs(cells) - 1) * grid_mm; }

int floor_division(int value, int divisor) {
  return value >= 0 ? value / divisor : -((divisor - 1 - value) / divisor);
}

// Cells with values, x fastest, kNothingAbove where empty.
struct Raster {
  int x0 = 0;
  int y0 = 0;
  int width = 0;
  int height = 0;
  std::vector<float> values;

  float& at(int x, int y) {
    return values[static_cast<std::size_t>(y - y0) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x - x0)];
  }
};

// The lower bound of the part grown by a ball of radius `gap`, so that matter dropped on it keeps
// its distance in every direction: over a cell at horizontal distance d the part reaches
// sqrt(gap² - d²) further down.
Raster grown_low(const DepthMaps& maps, double gap, double slack, double grid, int growth) {
  Raster grown{
      maps.x0 - growth, maps.y0 - growth, maps.width + 2 * growth, maps.height + 2 * growth, {}};
  grown.values.assign(
      static_cast<std::size_t>(grown.width) * static_cast<std::size_t>(grown.height),
      kNothingAbove);
  for (int dy = -growth; dy <= growth; ++dy)
    for (int dx = -growth; dx <= growth; ++dx) {
      const double distance = std::hypot(apart(dx, grid), apart(dy, grid));
      if ((dx != 0 || dy != 0) && distance >= gap) continue;
      const double radius = gap + slack;
      const float further =
          static_cast<float>(std::sqrt(std::max(0.0, radius * radius - distance * distance)));
      for (int row = 0; row < maps.height; ++row)
        for (int column = 0; column < maps.width; ++column) {
          const float low =
              maps.low[static_cast<std::size_t>(row) * static_cast<std::size_t>(maps.width) +
                       static_cast<std::size_t>(column)];
          float& value = grown.at(maps.x0 + column + dx, maps.y0 + row + dy);
          value = std::min(value, low - further);
        }
    }
  return grown;
}

MapCell cell(int x, int y, float value) {
  return {static_cast<std::int16_t>(x), static_cast<std::int16_t>(y), value};
}

std::vector<MapCell> filled_cells(Raster& raster) {
  std::vector<MapCell> cells;
  for (int y = raster.y0; y < raster.y0 + raster.height; ++y)
    for (int x = raster.x0; x < raster.x0 + raster.width; ++x)
      if (std::isfinite(raster.at(x, y))) cells.push_back(cell(x, y, raster.at(x, y)));
  return cells;
}

// Cells from all over the part first, so that a scan soon knows about how high it will come.
std::vector<MapCell> spread(const std::vector<MapCell>& cells) {
  constexpr std::size_t kStride = 16;
  std::vector<MapCell> result;
  result.reserve(cells.size());
  for (std::size_t i = 0; i < cells.size(); i += kStride) result.push_back(cells[i]);
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (i % kStride != 0) result.push_back(cells[i]);
  return result;
}

// One cell for each block that holds any: the mean, or the number, of the cells in it.
std::vector<MapCell> blocks(const std::vector<MapCell>& cells, int coarse, bool count) {
  std::map<std::pair<int, int>, std::pair<double, int>> sums;  // (y, x) → sum, number
  for (const MapCell& fine : cells) {
    auto& [sum, number] = sums[{floor_division(fine.y, coarse), floor_division(fine.x, coarse)}];
    sum += fine.value;
    ++number;
  }
  std::vector<MapCell> result;
  result.reserve(sums.size());
  for (const auto& [place, total] : sums)
    result.push_back(cell(place.second, place.first,
                          static_cast<float>(count ? total.second : total.first / total.second)));
  return result;
}

void add_surface_cells(const DepthMaps& maps, RotatedPart& part) {
  for (int row = 0; row < maps.height; ++row)
    for (int column = 0; column < maps.width; ++column) {
      const std::size_t at = static_cast<std::size_t>(row) * static_cast<std::size_t>(maps.width) +
                             static_cast<std::size_t>(column);
      const int x = maps.x0 + column;
      const int y = maps.y0 + row;
      if (maps.top[at] != kNothingBelow) part.top.push_back(cell(x, y, maps.top[at]));
      if (maps.roof[at] != kNothingBelow) part.roof.push_back(cell(x, y, maps.roof[at]));
      if (maps.hangs[at] == 0) continue;
      part.hang.push_back(cell(x, y, maps.bottom[at]));
      part.hang_sum += maps.bottom[at];
    }
}

// An angle as whole quarters and a rest in [0, quarter). The rest is rounded, so that equal turns
// reached in different ways share their maps.
struct QuartersAndRest {
  int quarters;
  double rest;
};

QuartersAndRest split_turn(double turn) {
  const double quarters = std::floor(turn / kQuarter + 1e-9);
  const double rest = std::round(std::max(0.0, turn - quarters * kQuarter) * 1e9) * 1e-9;
  return {((static_cast<int>(quarters) % 4) + 4) % 4, rest};
}

Mat3 rotation_of(const WayUp& way, double turn) {
  const QuartersAndRest split = split_turn(way.turn + turn);
  return turn_about_z(split.quarters * kQuarter) * (turn_about_z(split.rest) * way.base);
}

}  // namespace

PartMaker::PartMaker(const PackProblem& problem, double margin_mm, std::function<void()> tick)
    : problem_(problem),
      margin_mm_(margin_mm),
      tick_(std::move(tick)),
      coarse_(std::max(1, static_cast<int>(std::lround(problem.search_grid_mm / problem.grid_mm)))),
      growth_(static_cast<int>(std::ceil((problem.gap_mm + margin_mm) / problem.grid_mm))),
      rotation_set_(rotation_set(problem.rotation_step)) {
  std::vector<Box3> boxes;
  for (const PackItem& item : problem.items) {
    const std::size_t model = static_cast<std::size_t>(item.model);
    if (boxes.size() <= model) boxes.resize(model + 1);
    boxes[model].extend(bounding_box(item.surface));
  }
  for (const Box3& box : boxes) centres_.push_back(box.isEmpty() ? Vec3(0, 0, 0) : box.center());

  double cells = 0;  // of all different shapes
  std::map<std::vector<double>, int> known;
  for (std::size_t i = 0; i < problem.items.size(); ++i) {
    Shape shape{to_soup(problem.items[i].surface), 0};
    std::vector<double> look;
    for (Vec3& point : shape.surface.points) {
      point -= centre(problem.items[i].model);
      if (point.norm() / problem.grid_mm > kMostCellsFromCentre)
        throw Error(Fault::kUsage, "The packer's grid is too fine for a model of this size",
                    "Set a larger grid_mm.");
      look.insert(look.end(), {point.x(), point.y(), point.z()});
    }
    for (const auto& [a, b, c] : shape.surface.triangles)
      look.insert(look.end(),
                  {static_cast<double>(a), static_cast<double>(b), static_cast<double>(c)});
    shape.twin = known.emplace(std::move(look), static_cast<int>(i)).first->second;
    if (shape.twin == static_cast<int>(i)) cells += cells_seen(shape.surface, problem.grid_mm);
    shapes_.push_back(std::move(shape));
  }
  most_rotations_ = static_cast<std::size_t>(
      std::clamp(kMapMemory_bytes / (kBytesPerCell * std::max(1.0, cells)), 1.0, 1e6));
}

std::vector<TriangleSoup> PartMaker::surfaces(const std::vector<int>& items) const {
  std::vector<TriangleSoup> result;
  for (const int item : items) result.push_back(shapes_[static_cast<std::size_t>(item)].surface);
  return result;
}

std::shared_ptr<const DepthMaps> PartMaker::maps(int twin, const Mat3& rotation) {
  MapsKey key{};
  key[0] = twin;
  for (int i = 0; i < 9; ++i)
    key[static_cast<std::size_t>(i + 1)] = std::llround(rotation(i / 3, i % 3) * 1e9);
  {
    const std::lock_guard lock(mutex_);
    const auto found = maps_.find(key);
    if (found != maps_.end()) return found->second;
  }
  TriangleSoup surface = shapes_[static_cast<std::size_t>(twin)].surface;
  for (Vec3& point : surface.points) point = rotation * point;
  auto drawn = std::make_shared<const DepthMaps>(
      draw_depth_maps(renderers_.local(), surface, problem_.grid_mm, problem_.support_angle));
  const std::lock_guard lock(mutex_);
  return maps_.emplace(key, std::move(drawn)).first->second;
}

DepthMaps PartMaker::part_maps(const std::vector<int>& items, const Mat3& way, double turn) {
  const QuartersAndRest split = split_turn(turn);
  const Mat3 drawn = turn_about_z(split.rest) * way;
  std::vector<std::shared_ptr<const DepthMaps>> held;
  std::vector<const DepthMaps*> members;
  for (const int item : items) {
    held.push_back(maps(shapes_[static_cast<std::size_t>(item)].twin, drawn));
    members.push_back(held.back().get());
  }
  return quarter_turned(united_maps(members), split.quarters);
}

RotatedPart PartMaker::rotated(const std::vector<int>& items, const WayUp& way, double turn) {
  const DepthMaps maps = part_maps(items, way.base, way.turn + turn);
  RotatedPart part;
  part.rotation = rotation_of(way, turn);
  part.box = maps.box;
  part.inside_support_mm3 = way.inside_support_mm3;
  Raster reach = grown_low(maps, problem_.gap_mm + margin_mm_, sampling_slack(problem_.grid_mm),
                           problem_.grid_mm, growth_);
  part.reach = spread(filled_cells(reach));
  part.reach_low = {reach.x0, reach.y0};
  part.reach_high = {reach.x0 + reach.width - 1, reach.y0 + reach.height - 1};
  add_surface_cells(maps, part);
  part.coarse_reach = blocks(part.reach, coarse_, false);
  part.coarse_hang = blocks(part.hang, coarse_, true);
  return part;
}

std::optional<Part> PartMaker::make(std::vector<int> items) {
  std::sort(items.begin(), items.end());
  std::vector<int> twins;
  for (const int item : items) twins.push_back(shapes_[static_cast<std::size_t>(item)].twin);
  Part part;
  {
    const std::lock_guard lock(mutex_);
    const auto found = parts_.find(twins);
    if (found != parts_.end()) part = found->second;
  }
  part.items = items;
  part.model = problem_.items[static_cast<std::size_t>(items.front())].model;
  if (part.rotations) return part;

  const std::vector<TriangleSoup> shapes = surfaces(items);
  for (const int item : items)
    part.volume_mm3 += problem_.items[static_cast<std::size_t>(item)].volume_mm3;
  part.ways = ranked_ways_up(shapes, part.volume_mm3, rotation_set_, problem_, tick_);
  if (part.ways.empty()) {
    const auto found = way_up_that_fits(shapes, part.volume_mm3, problem_);
    if (!found) return std::nullopt;
    part.ways.push_back(*found);
  }
  part.rotations = rotations(part, Effort::kSearch);
  const std::lock_guard lock(mutex_);
  parts_.emplace(std::move(twins), part);
  return part;
}

std::shared_ptr<const std::vector<RotatedPart>> PartMaker::rotations(const Part& part,
                                                                     Effort effort) {
  const std::vector<double> turns = effort == Effort::kPlace
                                        ? rotation_set_.turns
                                        : rotation_set(problem_.search_rotation_step).turns;
  const std::size_t affordable = std::max<std::size_t>(1, most_rotations_ / turns.size());
  const std::size_t ways = std::min({part.ways.size(), ways_tried(effort), affordable});
  auto made = std::make_shared<std::vector<RotatedPart>>();
  for (std::size_t i = 0; i < ways; ++i)
    for (const double turn : turns) {
      tick_();
      RotatedPart one = rotated(part.items, part.ways[i], turn);
      if (fits(one.box.sizes(), problem_.build_mm)) made->push_back(std::move(one));
    }
  return made;
}

Part PartMaker::with(Part part, Effort effort) {
  part.rotations = rotations(part, effort);
  return part;
}

Pose PartMaker::pose(const Part& part, const RotatedPart& rotated, int x, int y, double z) const {
  Pose pose = Pose::Identity();
  pose.linear() = rotated.rotation;
  pose.translation() =
      Vec3(x * problem_.grid_mm, y * problem_.grid_mm, z) - rotated.rotation * centre(part.model);
  return pose;
}

}  // namespace packmerger
