#include "bench/reference_packing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "pack/maps/columns.h"
#include "pack/maps/rotations.h"
#include "pack/maps/ways_up.h"

namespace packmerger::bench {
namespace {

constexpr double kFinestUnit_mm = 1.0 / 64;
constexpr double kMostUnits = 16000;  // of the build volume's height: sums of two stay in 16 bits
constexpr Height kBare = -16384;      // the plate: no part needs a gap to it

DepthTriangles triangles_of(const std::vector<Mesh>& surfaces, const Mat3& rotation,
                            double normal_limit) {
  DepthTriangles result;
  for (const Mesh& surface : surfaces) {
    const auto base = static_cast<std::uint32_t>(result.points.size());
    std::vector<Vec3> points;
    for (const Vec3& point : surface.points()) {
      points.push_back(rotation * point);
      result.points.push_back(points.back().cast<float>());
    }
    for (const auto& [a, b, c] : surface.triangles()) {
      const Vec3 normal = (points[b] - points[a]).cross(points[c] - points[a]).normalized();
      if (!(normal.z() <= normal_limit)) continue;
      result.triangles.push_back({base + static_cast<std::uint32_t>(a),
                                  base + static_cast<std::uint32_t>(b),
                                  base + static_cast<std::uint32_t>(c)});
    }
  }
  return result;
}

// How far down a ball of radius `gap` round the points of a cell reaches over one `dx`, `dy` away.
std::optional<double> reach_down(int dx, int dy, double gap_mm, double grid_mm) {
  const auto apart = [&](int cells) { return std::max(0, std::abs(cells) - 1) * grid_mm; };
  const double distance = std::hypot(apart(dx), apart(dy));
  if ((dx != 0 || dy != 0) && distance >= gap_mm) return std::nullopt;
  return std::sqrt(gap_mm * gap_mm - distance * distance);
}

}  // namespace

// The height field with a border of bare plate, so that no loop tests its limits.
struct ReferencePacker::Tray {
  int border;
  int stride;
  std::vector<Height> field;
  Box3 contents;
  double support_mm3 = 0;
  double material_mm3 = 0;
  int parts = 0;

  const Height* row(int x, int y) const { return &field[index(x, y)]; }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y + border) * static_cast<std::size_t>(stride) +
           static_cast<std::size_t>(x + border);
  }
};

ReferencePacker::ReferencePacker(const PackProblem& problem, Ties ties)
    : problem_(problem),
      ties_(ties),
      unit_mm_(std::max(kFinestUnit_mm, problem.build_mm.z() / kMostUnits)),
      columns_(static_cast<int>(std::floor(problem.build_mm.x() / problem.grid_mm + 1e-9))),
      rows_(static_cast<int>(std::floor(problem.build_mm.y() / problem.grid_mm + 1e-9))) {
  const RotationSet set = rotation_set(problem.rotation_step);
  for (const Mat3& way : set.ways_up)
    for (const double turn : set.turns) rotations_.push_back(turn_about_z(turn) * way);
}

Height ReferencePacker::units(double mm) const {
  return static_cast<Height>(std::lround(mm / unit_mm_));
}

std::vector<ReferenceMaps> ReferencePacker::draw(const ItemSet& items) {
  std::vector<Mesh> surfaces;
  for (const int item : items)
    surfaces.push_back(problem_.items[static_cast<std::size_t>(item)].surface);
  std::vector<ReferenceMaps> all;
  for (const Mat3& rotation : rotations_) {
    ReferenceMaps maps = draw(surfaces, rotation);
    if (fits(maps.box.sizes(), problem_.build_mm)) all.push_back(std::move(maps));
  }
  return all;
}

ReferenceMaps ReferencePacker::draw(const std::vector<Mesh>& surfaces, const Mat3& rotation) {
  ReferenceMaps maps;
  maps.rotation = rotation;
  Box3 exact;
  for (const Mesh& surface : surfaces)
    for (const Vec3& point : surface.points()) exact.extend(Vec3(rotation * point));
  const double grid = problem_.grid_mm;
  const Vec3 low = exact.min();
  // In whole units, as all heights, so that equal places have equal costs to the last bit.
  maps.box = Box3(Vec3(0, 0, 0), Vec3((exact.sizes() / unit_mm_).array().ceil() * unit_mm_));
  maps.width = std::max(1, static_cast<int>(std::ceil(maps.box.sizes().x() / grid - 1e-9)));
  maps.height = std::max(1, static_cast<int>(std::ceil(maps.box.sizes().y() / grid - 1e-9)));
  const RayLattice rays{low.x() + grid / 2, low.y() + grid / 2, grid, maps.width, maps.height};
  const DepthTriangles every = triangles_of(surfaces, rotation, 1);
  const DepthTriangles hanging =
      triangles_of(surfaces, rotation, support_normal_limit(problem_.support_angle));
  const DepthMap bottom = renderer_.from_below(every, rays);
  const DepthMap top = renderer_.from_above(every, rays);
  const DepthMap hangs = renderer_.from_below(hanging, rays);
  for (std::size_t i = 0; i < bottom.heights.size(); ++i) {
    const bool hit = bottom.heights[i] != kNothingAbove;
    maps.bottom.push_back(hit ? units(bottom.heights[i] - low.z()) : kNothing);
    maps.top.push_back(hit ? units(top.heights[i] - low.z()) : kNothing);
    maps.hangs.push_back(hit && hangs.heights[i] - bottom.heights[i] < unit_mm_ ? 1 : 0);
  }

  maps.growth = static_cast<int>(std::ceil(problem_.gap_mm / grid));
  const int width = maps.width + 2 * maps.growth;
  const int height = maps.height + 2 * maps.growth;
  maps.reach.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), kNothing);
  for (int dy = -maps.growth; dy <= maps.growth; ++dy)
    for (int dx = -maps.growth; dx <= maps.growth; ++dx) {
      const auto down = reach_down(dx, dy, problem_.gap_mm, grid);
      if (!down) continue;
      for (int y = 0; y < maps.height; ++y)
        for (int x = 0; x < maps.width; ++x) {
          const Height from = maps.bottom[static_cast<std::size_t>(y * maps.width + x)];
          if (from == kNothing) continue;
          const auto to = static_cast<Height>(from - units(*down));
          Height& reach = maps.reach[static_cast<std::size_t>((y + dy + maps.growth) * width + x +
                                                              dx + maps.growth)];
          reach = reach == kNothing ? to : std::min(reach, to);
        }
    }
  return maps;
}

double ReferencePacker::waste_mm3(const ReferencePlacement& place) const {
  return std::max(0, place.waste) * (problem_.grid_mm * problem_.grid_mm * unit_mm_);
}

Box3 ReferencePacker::contents_with(const Tray& tray, const ReferenceMaps& maps,
                                    const ReferencePlacement& place) const {
  const Vec3 low(place.x * problem_.grid_mm, place.y * problem_.grid_mm, place.z * unit_mm_);
  Box3 contents = tray.contents;
  contents.extend(low);
  contents.extend(Vec3(low + maps.box.sizes()));
  return contents;
}

TrayMeasure ReferencePacker::measure(const Tray& tray, const ReferenceMaps& maps, double volume_mm3,
                                     const ReferencePlacement& place) const {
  const Box3 contents = contents_with(tray, maps, place);
  const Vec3 size = contents.sizes();
  return {Vec3(size.x(), size.y(), contents.max().z()), tray.support_mm3 + waste_mm3(place),
          tray.material_mm3 + volume_mm3, tray.parts + 1};
}

std::optional<ReferencePlacement> ReferencePacker::best(const Tray& tray,
                                                        const std::vector<ReferenceMaps>& part,
                                                        double volume_mm3) {
  const int highest = static_cast<int>(std::floor(problem_.build_mm.z() / unit_mm_ + 1e-6));
  std::optional<ReferencePlacement> best;
  std::vector<Height> z;
  std::vector<int> waste;
  for (std::size_t rotation = 0; rotation < part.size(); ++rotation) {
    const ReferenceMaps& maps = part[rotation];
    const int columns = columns_ - maps.width + 1;
    const int rows = rows_ - maps.height + 1;
    if (columns <= 0 || rows <= 0) continue;
    const auto positions = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);

    // Drop from above: the (max, +) scan of the part's lower side over the field.
    z.assign(positions, 0);
    const int width = maps.width + 2 * maps.growth;
    for (std::size_t cell = 0; cell < maps.reach.size(); ++cell) {
      const Height reach = maps.reach[cell];
      if (reach == kNothing) continue;
      const int dx = static_cast<int>(cell) % width - maps.growth;
      const int dy = static_cast<int>(cell) / width - maps.growth;
      for (int y = 0; y < rows; ++y) {
        const Height* field = tray.row(dx, y + dy);
        Height* fall = &z[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns)];
        for (int x = 0; x < columns; ++x)
          fall[x] = std::max(fall[x], static_cast<Height>(field[x] - reach));
      }
      cells_ += static_cast<double>(positions);
    }

    // The wasted space between the field and the lower side.
    waste.assign(positions, 0);
    for (int dy = 0; dy < maps.height; ++dy)
      for (int dx = 0; dx < maps.width; ++dx) {
        const auto cell = static_cast<std::size_t>(dy * maps.width + dx);
        if (maps.hangs[cell] == 0) continue;
        const int bottom = maps.bottom[cell];
        for (int y = 0; y < rows; ++y) {
          const Height* field = tray.row(dx, y + dy);
          const std::size_t first = static_cast<std::size_t>(y) * static_cast<std::size_t>(columns);
          for (int x = 0; x < columns; ++x) {
            const auto at = first + static_cast<std::size_t>(x);
            waste[at] += z[at] + bottom - std::max<int>(0, field[x]);
          }
        }
        cells_ += static_cast<double>(positions);
      }

    const int top = static_cast<int>(std::ceil(maps.box.sizes().z() / unit_mm_ - 1e-6));
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < columns; ++x) {
        const auto at = static_cast<std::size_t>(y * columns + x);
        if (z[at] + top > highest) continue;
        ReferencePlacement here{0, static_cast<int>(rotation), x, y, z[at], z[at] + top, waste[at],
                                0};
        here.cost = problem_.cost.evaluate(measure(tray, maps, volume_mm3, here));
        const auto rank = [this](const ReferencePlacement& p) {
          const int first = ties_ == Ties::kLowestTop ? p.top : p.z;
          return std::tuple(p.cost, first, p.z, p.y, p.x, p.rotation);
        };
        if (!best || rank(here) < rank(*best)) best = here;
      }
  }
  return best;
}

ReferencePacking ReferencePacker::pack(const std::vector<std::vector<ReferenceMaps>>& parts,
                                       const std::vector<double>& volumes_mm3, const Order& order) {
  const int border = static_cast<int>(std::ceil(problem_.gap_mm / problem_.grid_mm));
  Tray tray{border, columns_ + 2 * border, {}, {}};
  tray.field.assign(
      static_cast<std::size_t>(tray.stride) * static_cast<std::size_t>(rows_ + 2 * border), kBare);
  ReferencePacking packing;
  for (const int index : order) {
    const std::vector<ReferenceMaps>& part = parts[static_cast<std::size_t>(index)];
    const double volume = volumes_mm3[static_cast<std::size_t>(index)];
    auto place = best(tray, part, volume);
    if (!place) {
      packing.cost = std::numeric_limits<double>::infinity();
      return packing;
    }
    place->part = index;
    const ReferenceMaps& maps = part[static_cast<std::size_t>(place->rotation)];
    for (int dy = 0; dy < maps.height; ++dy)
      for (int dx = 0; dx < maps.width; ++dx) {
        const auto cell = static_cast<std::size_t>(dy * maps.width + dx);
        if (maps.top[cell] == kNothing) continue;
        Height& field = tray.field[tray.index(place->x + dx, place->y + dy)];
        field = std::max(field, static_cast<Height>(place->z + maps.top[cell]));
      }
    tray.contents = contents_with(tray, maps, *place);
    tray.support_mm3 += waste_mm3(*place);
    tray.material_mm3 += volume;
    ++tray.parts;
    packing.cost = place->cost;
    packing.placed.push_back(*place);
  }
  return packing;
}

}  // namespace packmerger::bench
