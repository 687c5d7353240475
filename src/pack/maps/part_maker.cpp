#include "pack/maps/part_maker.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "model/sentinel_heights.h"
#include "pack/maps/columns.h"

namespace packmerger {
namespace {

constexpr double kQuarter = std::numbers::pi / 2;
constexpr int kColumnsAcross = 64;       // enough to rank ways up
constexpr std::size_t kSpreadWays = 60;  // about 29 degrees apart
constexpr std::size_t kFlatWays = 8;
constexpr std::size_t kMemberWays = 3;
constexpr std::size_t kRefinedWays = 2;
constexpr double kRefineFrom = 0.2;  // radians
constexpr double kRefineTo = 0.01;

// An angle as whole quarters and a rest in [0, quarter), rounded so that equal turns reached in
// different ways share their maps.
struct QuartersAndRest {
  int quarters;
  double rest;
};

QuartersAndRest split_turn(double turn) {
  const double quarters = std::floor(turn / kQuarter + 1e-9);
  const double rest = std::round(std::max(0.0, turn - quarters * kQuarter) * 1e9) * 1e-9;
  return {((static_cast<int>(quarters) % 4) + 4) % 4, rest};
}

// At 0 degrees V_s = (volume under the upper envelope) - (volume of matter), whatever lies inside.
// Here that part of it which lies between the part's own surfaces.
double inside_support_mm3_of(const DepthMaps& maps, double volume_mm3, double cell_mm) {
  double between = 0;
  for (std::size_t at = 0; at < maps.roof.size(); ++at)
    if (maps.roof[at] != kNothingBelow) between += maps.roof[at] - maps.bottom[at];
  return std::max(0.0, between * cell_mm * cell_mm - volume_mm3);
}

// Under the upper envelope of all of them, down to the lowest point.
double volume_under_mm3(const std::vector<const RoofMap*>& members, double cell_mm) {
  RoofMap all = frame_of(members);
  all.roof.assign(static_cast<std::size_t>(all.width) * static_cast<std::size_t>(all.height),
                  kNothingBelow);
  for (const RoofMap* member : members) {
    auto from = member->roof.begin();
    for (int row = 0; row < member->height; ++row) {
      auto to = all.roof.begin() + (row + member->y0 - all.y0) * all.width + member->x0 - all.x0;
      for (int column = 0; column < member->width; ++column, ++from, ++to)
        *to = std::max(*to, *from);
    }
  }
  double under = 0;
  for (const float roof : all.roof)
    if (roof != kNothingBelow) under += roof - all.box.min().z();
  return under * cell_mm * cell_mm;
}

Mesh turned(const Mesh& surface, const Mat3& rotation) {
  std::vector<Vec3> points;
  points.reserve(surface.n_points());
  for (const Vec3& point : surface.points()) points.push_back(rotation * point);
  return surface.with_points(std::move(points));
}

std::vector<Mesh> turned(std::vector<Mesh> surfaces, const Mat3& rotation) {
  for (Mesh& surface : surfaces) surface = turned(surface, rotation);
  return surfaces;
}

}  // namespace

PartMaker::PartMaker(const PackProblem& problem, const Grid& grid, std::function<void()> tick)
    : problem_(problem),
      grid_(grid),
      mask_(problem.plate, problem.build_mm, grid.cell_mm, grid.bounds),
      tick_(std::move(tick)),
      rotation_set_(rotation_set(problem.rotation_step)) {
  std::vector<Box3> boxes;
  for (const PackItem& item : problem.items) {
    const std::size_t model = static_cast<std::size_t>(item.model);
    if (boxes.size() <= model) boxes.resize(model + 1);
    boxes[model].extend(bounding_box(item.surface));
  }
  for (const Box3& box : boxes) centres_.push_back(box.isEmpty() ? Vec3(0, 0, 0) : box.center());

  std::map<std::vector<double>, int> known;
  for (std::size_t i = 0; i < problem.items.size(); ++i) {
    const Vec3& centre = centres_[static_cast<std::size_t>(problem.items[i].model)];
    std::vector<double> look{centre.x(), centre.y(), centre.z()};
    std::vector<Vec3> points = problem.items[i].surface.points();
    for (Vec3& point : points) {
      point -= centre;
      look.insert(look.end(), {point.x(), point.y(), point.z()});
    }
    Shape shape{problem.items[i].surface.with_points(std::move(points)), 0};
    for (const auto& [a, b, c] : shape.surface.triangles())
      look.insert(look.end(),
                  {static_cast<double>(a), static_cast<double>(b), static_cast<double>(c)});
    shape.twin = known.emplace(std::move(look), static_cast<int>(i)).first->second;
    shapes_.push_back(std::move(shape));
  }
}

std::vector<Mesh> PartMaker::surfaces(const ItemSet& items) const {
  std::vector<Mesh> result;
  for (const int item : items) result.push_back(shapes_[static_cast<std::size_t>(item)].surface);
  return result;
}

std::shared_ptr<const DepthMaps> PartMaker::maps(int twin, const Mat3& rotation) {
  const std::pair key(twin, key_of(rotation));
  if (!grid_.bounds) {
    const std::lock_guard lock(mutex_);
    const auto found = maps_.find(key);
    if (found != maps_.end()) return found->second;
  }
  const Mesh surface = turned(shapes_[static_cast<std::size_t>(twin)].surface, rotation);
  auto drawn = std::make_shared<const DepthMaps>(
      grid_.bounds ? draw_depth_maps(surface, grid_.cell_mm, problem_.support_angle)
                   : draw_sampled_maps(surface, grid_.cell_mm, problem_.support_angle));
  if (grid_.bounds) return drawn;
  const std::lock_guard lock(mutex_);
  return maps_.emplace(key, std::move(drawn)).first->second;
}

DepthMaps PartMaker::part_maps(const ItemSet& items, const Mat3& rotation) {
  std::vector<std::shared_ptr<const DepthMaps>> held;
  std::vector<const DepthMaps*> members;
  for (const int item : items) {
    held.push_back(maps(shapes_[static_cast<std::size_t>(item)].twin, rotation));
    members.push_back(held.back().get());
  }
  return united_maps(members);
}

const Part* PartMaker::make(const ItemSet& items) {
  {
    const std::lock_guard lock(mutex_);
    const auto found = parts_.find(items);
    if (found != parts_.end()) return found->second->ways.empty() ? nullptr : found->second.get();
  }
  auto part = std::make_unique<Part>();
  part->items = items;
  part->model = problem_.items[static_cast<std::size_t>(items.front())].model;
  for (const int item : items)
    part->volume_mm3 += problem_.items[static_cast<std::size_t>(item)].volume_mm3;
  const ItemSet key = twins(items);
  {
    const std::lock_guard lock(mutex_);
    const auto found = ways_.find(key);
    if (found != ways_.end()) part->ways = found->second;
  }
  if (part->ways.empty()) part->ways = ways_of(*part);
  const std::lock_guard lock(mutex_);
  ways_.emplace(key, part->ways);
  const Part* made = parts_.emplace(items, std::move(part)).first->second.get();
  return made->ways.empty() ? nullptr : made;
}

ItemSet PartMaker::twins(const ItemSet& items) const {
  ItemSet twins;
  for (const int item : items) twins.push_back(shapes_[static_cast<std::size_t>(item)].twin);
  std::sort(twins.begin(), twins.end());
  return twins;
}

std::shared_ptr<const PartMaker::Standing> PartMaker::standing(int item, const Mat3& base) {
  const Shape& shape = shapes_[static_cast<std::size_t>(item)];
  const std::pair key(shape.twin, key_of(base));
  const bool is_kept = !grid_.bounds && !problem_.edges.empty();
  if (is_kept) {
    const std::lock_guard lock(mutex_);
    const auto found = standing_.find(key);
    if (found != standing_.end()) return found->second;
  }
  const Mesh surface = turned(shape.surface, base);
  auto made = std::make_shared<Standing>();
  made->boxes = turned_boxes(surface, rotation_set_.turns);
  if (problem_.support_angle <= 0) made->roof = draw_roof(surface, grid_.cell_mm);
  if (!is_kept) return made;
  const std::lock_guard lock(mutex_);
  return standing_.emplace(key, std::move(made)).first->second;
}

std::vector<WayUp> PartMaker::ways_of(const Part& part) {
  std::vector<WayUp> ways;
  const auto add = [&](const Mat3& base) {
    tick_();
    std::vector<std::shared_ptr<const Standing>> members;
    std::vector<Box3> boxes(rotation_set_.turns.size());
    for (const int item : part.items) {
      members.push_back(standing(item, base));
      for (std::size_t i = 0; i < boxes.size(); ++i) boxes[i].extend(members.back()->boxes[i]);
    }
    const auto turn = best_turn(
        boxes, rotation_set_.turns, [&] { return turned(surfaces(part.items), base); }, problem_);
    if (turn) ways.push_back(measured(part, members, base, *turn));
    return turn ? ways.back().cost : std::numeric_limits<double>::infinity();
  };
  for (const Mat3& base : rotation_set_.ways_up) add(base);
  if (rotation_set_.ways_up.size() > 1) add_own_ways(part, ways, add);
  if (ways.empty()) {
    if (const auto found = way_up_that_fits(surfaces(part.items), problem_)) {
      std::vector<std::shared_ptr<const Standing>> members;
      for (const int item : part.items) members.push_back(standing(item, found->rotation));
      ways.push_back(measured(part, members, found->rotation, {0, found->size_mm}));
    }
  }
  std::stable_sort(ways.begin(), ways.end(),
                   [](const WayUp& a, const WayUp& b) { return a.cost < b.cost; });
  return ways;
}

// Beside the rotation set: the part's own best ways up, which no fixed step hits. Large flat
// facets, as cuts leave them, directions spread over the sphere where the set is sparse, and the
// best of all refined; a merged part takes its members' best.
void PartMaker::add_own_ways(const Part& part, const std::vector<WayUp>& ways,
                             const std::function<double(const Mat3&)>& add) {
  if (part.items.size() > 1) {
    for (const int item : part.items) {
      const Part* member = make({item});
      for (std::size_t i = 0; member && i < std::min(kMemberWays, member->ways.size()); ++i)
        add(member->ways[i].base);
    }
    return;
  }
  for (const Mat3& base : ways_on_flat_facets(surfaces(part.items), kFlatWays)) add(base);
  if (rotation_set_.ways_up.size() < kSpreadWays)
    for (const Mat3& base : spread_ways(kSpreadWays)) add(base);
  std::vector<std::pair<double, Mat3>> tried;
  for (const WayUp& way : ways) tried.emplace_back(way.cost, way.base);
  std::stable_sort(tried.begin(), tried.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  const std::size_t refined = std::min(tried.size(), kRefinedWays);
  for (std::size_t i = 0; i < refined; ++i) {
    auto best = tried[i];
    for (double reach = kRefineFrom; reach > kRefineTo; reach /= 2)
      for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)}) {
        const Mat3 base = Eigen::AngleAxisd(reach, axis).toRotationMatrix() * best.second;
        const double cost = add(base);
        if (cost < best.first) best = {cost, base};
      }
  }
}

WayUp PartMaker::measured(const Part& part,
                          const std::vector<std::shared_ptr<const Standing>>& members,
                          const Mat3& base, const Turn& turn) const {
  WayUp way{base, turn.turn, 0, 0, 0, turn.size_mm};
  if (problem_.support_angle <= 0) {
    std::vector<const RoofMap*> roofs;
    for (const auto& member : members) roofs.push_back(&member->roof);
    way.support_mm3 = std::max(0.0, volume_under_mm3(roofs, grid_.cell_mm) - part.volume_mm3);
  } else {
    const std::vector<Mesh> surfaces_up = turned(surfaces(part.items), base);
    Box3 box;
    for (const Mesh& surface : surfaces_up)
      for (const Vec3& point : surface.points()) box.extend(point);
    const double step = std::max(grid_.cell_mm, box.sizes().head<2>().maxCoeff() / kColumnsAcross);
    const ColumnSupport support =
        column_support(surfaces_up, step, problem_.support_angle, box.min().z());
    way.support_mm3 = support.below + support.inside;
    way.inside_support_mm3 = support.inside;
  }
  way.cost = problem_.cost.evaluate({turn.size_mm, way.support_mm3, part.volume_mm3, 1});
  return way;
}

const RotatedPart* PartMaker::rotated(const Part& part, std::size_t way, std::size_t turn) {
  const WayUp& base = part.ways[way];
  const auto [quarters, rest] = split_turn(base.turn + rotation_set_.turns[turn]);
  return rotated(part, turn_about_z(rest) * base.base, quarters, base.inside_support_mm3);
}

const RotatedPart* PartMaker::rotated(const Part& part, const Mat3& rotation,
                                      double inside_support_mm3) {
  return rotated(part, rotation, 0, inside_support_mm3);
}

const RotatedPart* PartMaker::rotated(const Part& part, const Mat3& base, int quarters,
                                      double inside_support_mm3) {
  const Mat3 rotation = turn_about_z(quarters * kQuarter) * base;
  const std::pair key(twins(part.items), key_of(rotation));
  const auto usable = [](const std::unique_ptr<RotatedPart>& made) {
    return made->top.empty() ? nullptr : made.get();
  };
  {
    const std::lock_guard lock(mutex_);
    const auto found = rotated_.find(key);
    if (found != rotated_.end()) return usable(found->second);
  }
  tick_();
  const DepthMaps maps = quarter_turned(part_maps(part.items, base), quarters);
  auto made = std::make_unique<RotatedPart>();
  if (fits(maps.box.sizes(), problem_.build_mm)) {
    *made = quantised(maps, grid_);
    made->rotation = rotation;
    made->barred = mask_.barred(footprint_of(made->top), made->box);
    made->shift = Vec3(-maps.x0 * grid_.cell_mm, -maps.y0 * grid_.cell_mm, -maps.box.min().z()) -
                  rotation * centres_[static_cast<std::size_t>(part.model)];
    made->inside_support_mm3 = problem_.support_angle <= 0
                                   ? inside_support_mm3_of(maps, part.volume_mm3, grid_.cell_mm)
                                   : inside_support_mm3;
  }
  const std::lock_guard lock(mutex_);
  return usable(rotated_.emplace(key, std::move(made)).first->second);
}

Pose PartMaker::pose(const RotatedPart& rotated, int x, int y, Height z) const {
  Pose pose = Pose::Identity();
  pose.linear() = rotated.rotation;
  pose.translation() =
      rotated.shift + Vec3(x * grid_.cell_mm, y * grid_.cell_mm, z * grid_.unit_mm);
  return pose;
}

}  // namespace packmerger
