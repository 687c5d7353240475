#include "job/compare/unpacked.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>

#include "base/parallel.h"
#include "printers/estimate/estimate.h"
#include "printers/layers/slice_layers.h"

namespace packmerger {
namespace {

constexpr double kSlack = 1e-9;  // of a model exactly as large as the tray, mm

// The six faces that can be down. Exact signed permutations, so that nothing is lost by turning.
std::vector<Mat3> ways_up() {
  std::vector<Mat3> ways;
  for (const int axis : {2, 0, 1})  // as the file stands comes first, and wins ties
    for (const double sign : {1.0, -1.0}) {
      Mat3 way = Mat3::Zero();
      way(2, axis) = sign;
      way(0, (axis + 1) % 3) = 1;
      way(1, (axis + 2) % 3) = sign;
      ways.push_back(way);
    }
  return ways;
}

Mat3 quarter_turned(const Mat3& way) {
  Mat3 turned = way;
  turned.row(0) = -way.row(1);
  turned.row(1) = way.row(0);
  return turned;
}

Box3 turned_box(const Mesh& mesh, const Mat3& way) {
  const Box3 box = bounding_box(mesh);
  Box3 turned;
  turned.extend(Vec3(way * box.min()));
  turned.extend(Vec3(way * box.max()));
  return turned;
}

bool fits(const Vec3& size, const Vec3& build) {
  return (size.array() <= build.array() + kSlack).all();
}

Pose standing_at(const Mat3& way, const Box3& box, const Vec2& corner) {
  Pose pose = Pose::Identity();
  pose.linear() = way;
  pose.translation() = Vec3(corner.x(), corner.y(), 0) - box.min();
  return pose;
}

// Whether the model, turned, has a place in the room.
bool fits(const Mesh& model, const Mat3& way, const Room& room) {
  if (!fits(turned_box(model, way).sizes(), room.size_mm)) return false;
  if (room.plate.is_whole()) return true;
  const Plate plate = room.plate.drawn_in(room.corner_mm.head<2>(), 0);
  return plate.spot_for(transformed(model, Pose(way)), room.size_mm.head<2>()).has_value();
}

// The margin for support is given up where a model fills the build volume.
Room room_for(const WholeModels& models, const std::vector<Mat3>& ways, const Profile& profile) {
  const Room room = room_of(profile);
  for (std::size_t m = 0; m < models.size(); ++m)
    if (!fits(*models[m], ways[m], room)) return whole_room(profile);
  return room;
}

bool over_a_wall(const Arrangement& arrangement, const Room& room) {
  return std::any_of(arrangement.parts.begin(), arrangement.parts.end(), [&](const JobPart& part) {
    return room.plate.breach_mm(part.surface, part.pose) > kWallTolerance_mm;
  });
}

// Each part on the first tray where it has a place off the plate's walls and the boxes of those
// before it, the deepest first.
void place_between_walls(Arrangement& arrangement, const Room& room, double gap_mm) {
  const Vec2 corner = room.corner_mm.head<2>();
  const Plate walls = room.plate.drawn_in(corner, 0);
  std::vector<std::vector<Polygon>> barred;  // of each tray
  std::vector<JobPart*> order;
  for (JobPart& part : arrangement.parts) order.push_back(&part);
  const auto depth = [](const JobPart* part) {
    return bounding_box(transformed(part->surface, part->pose)).sizes().y();
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](const JobPart* a, const JobPart* b) { return depth(a) > depth(b); });
  for (JobPart* part : order) {
    const Mesh standing = transformed(part->surface, part->pose);
    std::optional<Vec2> spot;
    for (std::size_t tray = 0; !spot; ++tray) {
      if (tray == barred.size()) barred.push_back(walls.barred());
      const bool is_bare = barred[tray].size() == walls.barred().size();
      spot = Plate(walls.hull(), barred[tray]).spot_for(standing, room.size_mm.head<2>());
      if (!spot && is_bare) return;  // it has no place anywhere; the check of promises tells
      part->tray = static_cast<int>(tray) + 1;
    }
    const Box3 box = bounding_box(standing);
    const Vec2 low = box.min().head<2>() + *spot - Vec2::Constant(gap_mm);
    const Vec2 high = box.max().head<2>() + *spot + Vec2::Constant(gap_mm);
    barred[static_cast<std::size_t>(part->tray) - 1].push_back(
        {low, Vec2(high.x(), low.y()), high, Vec2(low.x(), high.y())});
    part->pose.pretranslate(Vec3(spot->x() + corner.x(), spot->y() + corner.y(), 0));
  }
  arrangement.trays = static_cast<int>(barred.size());
}

// What stands side by side on several trays is stood in layers above one another, as many as the
// room is high: powder holds them.
void stack_trays(Arrangement& arrangement, const Room& room, double gap_mm) {
  std::vector<double> heights(static_cast<std::size_t>(arrangement.trays), 0);
  for (const JobPart& part : arrangement.parts) {
    double& height = heights[static_cast<std::size_t>(part.tray) - 1];
    height = std::max(height, bounding_box(transformed(part.surface, part.pose)).sizes().z());
  }
  struct Layer {
    int tray;
    double z_mm;
  };
  std::vector<Layer> layers;
  Layer next{1, 0};
  for (const double height : heights) {
    if (next.z_mm + height > room.size_mm.z() + kSlack) next = {next.tray + 1, 0};
    layers.push_back(next);
    next.z_mm += height + gap_mm;
  }
  std::map<int, std::size_t> layer_of;  // by id
  for (JobPart& part : arrangement.parts) {
    const std::size_t layer = static_cast<std::size_t>(part.tray) - 1;
    layer_of[part.id] = layer;
    part.tray = layers[layer].tray;
    part.pose.pretranslate(Vec3(0, 0, layers[layer].z_mm));
  }
  arrangement.trays = layers.back().tray;
  std::stable_sort(arrangement.removal_order.begin(), arrangement.removal_order.end(),
                   [&](int a, int b) { return layer_of.at(a) > layer_of.at(b); });
}

Arrangement arrange(const WholeModels& models, const std::vector<Mat3>& ways,
                    const Profile& profile) {
  std::vector<Box3> boxes;
  std::vector<Vec2> sizes;
  for (std::size_t m = 0; m < models.size(); ++m) {
    boxes.push_back(turned_box(*models[m], ways[m]));
    sizes.push_back(boxes.back().sizes().head<2>());
  }
  const Room room = room_for(models, ways, profile);
  const double gap_mm = std::max(profile.pack.gap_mm, kLeastGap_mm);
  const std::vector<Slot> slots = side_by_side(sizes, room.size_mm.head<2>(), gap_mm);
  Arrangement arrangement;
  for (std::size_t m = 0; m < models.size(); ++m) {
    JobPart part;
    part.id = static_cast<int>(m) + 1;
    part.model = static_cast<int>(m);
    part.tray = slots[m].tray + 1;
    part.surface = *models[m];
    part.volume_mm3 = volume_mm3(*models[m]);
    part.pose = standing_at(ways[m], boxes[m], slots[m].corner + room.corner_mm.head<2>());
    part.pose.pretranslate(Vec3(0, 0, room.corner_mm.z()));
    arrangement.trays = std::max(arrangement.trays, part.tray);
    arrangement.removal_order.push_back(part.id);
    arrangement.parts.push_back(std::move(part));
  }
  if (over_a_wall(arrangement, room)) place_between_walls(arrangement, room, gap_mm);
  if (profile.technology == Technology::kPowder) stack_trays(arrangement, room, gap_mm);
  return arrangement;
}

// The width of the rectangle of the same area and perimeter, or of the square where it is rounder:
// that of strips, rings and small squares alike.
double width_mm(double area_mm2, double perimeter_mm) {
  const double half_sum = perimeter_mm / 4;
  return half_sum - std::sqrt(std::max(0.0, half_sum * half_sum - area_mm2));
}

// Slicers refuse what stands on a point or an edge: islands as wide as a line have to hold a line
// or two.
bool stands_on_a_point(const Layer& footprint, double line_mm) {
  double printable_mm2 = 0;
  for (const Island& island : islands_of(footprint))
    if (width_mm(island.area_mm2, island.perimeter_mm) >= line_mm) printable_mm2 += island.area_mm2;
  return printable_mm2 < std::pow(2 * line_mm, 2);
}

std::optional<Mat3> best_way(const Mesh& model, const Profile& profile, const Progress& progress) {
  const std::vector<Mat3> ways = ways_up();
  const double line_mm = profile.is_sliced() ? profile.fdm.line_width_mm : 0;
  using Rank = std::tuple<bool, double, double, std::size_t>;  // on a point, cost, time, index
  std::vector<Rank> ranks(2 * ways.size(), {true, std::numeric_limits<double>::infinity(), 0, 0});
  parallel_tasks(ways.size(), [&](std::size_t i) {
    const Box3 box = turned_box(model, ways[i]);
    const Room room = whole_room(profile);
    const bool fits_straight = fits(model, ways[i], room);
    const bool fits_turned = fits(model, quarter_turned(ways[i]), room);
    if (!fits_straight && !fits_turned) return;
    Tray tray;
    tray.parts.push_back(transformed(model, standing_at(ways[i], box, Vec2::Zero())));
    const BothTurns both = estimate_both_turns(profile, {tray}, Assembly{}, progress);
    const Layer footprint = slice_at(tray.parts.front(), profile.layer_mm / 2);
    const bool on_point = stands_on_a_point(footprint, line_mm);
    if (fits_straight) ranks[2 * i] = {on_point, both.straight.cost, both.straight.time_s, 2 * i};
    if (fits_turned) ranks[2 * i + 1] = {on_point, both.turned.cost, both.turned.time_s, 2 * i + 1};
  });
  const auto [on_point, cost, time_s, index] = *std::min_element(ranks.begin(), ranks.end());
  if (std::isinf(cost)) return std::nullopt;
  return index % 2 == 0 ? ways[index / 2] : quarter_turned(ways[index / 2]);
}

}  // namespace

std::vector<Slot> side_by_side(const std::vector<Vec2>& sizes, const Vec2& tray_mm, double gap_mm) {
  struct Row {
    int tray;
    double y, depth, used_x;
  };
  std::vector<std::size_t> order(sizes.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return sizes[a].y() > sizes[b].y(); });
  std::vector<Row> rows;
  std::vector<double> used_y;  // of each tray
  std::vector<Slot> slots(sizes.size());
  for (const std::size_t i : order) {
    const Vec2& size = sizes[i];
    auto row = std::find_if(rows.begin(), rows.end(), [&](const Row& candidate) {
      return candidate.depth >= size.y() && candidate.used_x + size.x() <= tray_mm.x() + kSlack;
    });
    if (row == rows.end()) {
      auto tray = std::find_if(used_y.begin(), used_y.end(),
                               [&](double y) { return y + size.y() <= tray_mm.y() + kSlack; });
      if (tray == used_y.end()) tray = used_y.insert(used_y.end(), 0);
      rows.push_back({static_cast<int>(tray - used_y.begin()), *tray, size.y(), 0});
      *tray += size.y() + gap_mm;
      row = rows.end() - 1;
    }
    slots[i] = {row->tray, Vec2(row->used_x, row->y)};
    row->used_x += size.x() + gap_mm;
  }
  std::vector<Vec2> extent(used_y.size(), Vec2::Zero());
  for (std::size_t i = 0; i < slots.size(); ++i)
    extent[slots[i].tray] = extent[slots[i].tray].cwiseMax(slots[i].corner + sizes[i]);
  for (Slot& slot : slots) slot.corner += ((tray_mm - extent[slot.tray]) / 2).cwiseMax(0);
  return slots;
}

std::optional<Arrangement> stand_as_is(const WholeModels& models, const Profile& profile) {
  for (const auto& model : models)
    if (!fits(*model, Mat3::Identity(), whole_room(profile))) return std::nullopt;
  return arrange(models, std::vector<Mat3>(models.size(), Mat3::Identity()), profile);
}

std::optional<Arrangement> stand_best(const WholeModels& models, const Profile& profile,
                                      const Progress& progress) {
  std::map<const Mesh*, Mat3> known;
  std::vector<Mat3> ways;
  for (const auto& model : models) {
    if (!known.contains(model.get())) {
      const std::optional<Mat3> way = best_way(*model, profile, progress);
      if (!way) return std::nullopt;
      known.emplace(model.get(), *way);
    }
    ways.push_back(known.at(model.get()));
  }
  return arrange(models, ways, profile);
}

}  // namespace packmerger
