#include "job/promises.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "model/stl.h"
#include "pack/exact/exact_gap.h"
#include "pack/exact/exact_removal.h"

namespace packmerger {
namespace {

constexpr double kRounding_mm = 1e-4;  // what single precision in the files may take
// Parts that are cut out of one another or touch: how far is not known.
constexpr double kUnknown_mm = 0.1;

struct WrittenTray {
  std::vector<int> ids;
  std::vector<Mesh> parts;
  std::vector<std::vector<Vec3>> paths;  // by part, as it is here
  std::vector<int> order;                // indices into parts
};

std::vector<Vec3> exact(const std::vector<Eigen::Vector3f>& rounded) {
  std::vector<Vec3> points;
  points.reserve(rounded.size());
  for (const Eigen::Vector3f& point : rounded) points.push_back(point.cast<double>());
  return points;
}

std::vector<WrittenTray> written(const Arrangement& arrangement) {
  std::vector<WrittenTray> trays(static_cast<std::size_t>(arrangement.trays));
  for (const JobPart& part : arrangement.parts) {
    WrittenTray& tray = trays[static_cast<std::size_t>(part.tray - 1)];
    tray.ids.push_back(part.id);
    tray.parts.push_back(transformed(part.surface, part.pose));
    const auto path = arrangement.removal_paths.find(part.id);
    tray.paths.push_back(path == arrangement.removal_paths.end() ? std::vector<Vec3>{}
                                                                 : path->second);
  }
  for (WrittenTray& tray : trays) {
    std::vector<const Mesh*> meshes;
    for (const Mesh& part : tray.parts) meshes.push_back(&part);
    const auto points = float_points(meshes);
    for (std::size_t i = 0; i < tray.parts.size(); ++i)
      tray.parts[i] = tray.parts[i].with_points(exact(points[i]));
    for (const int id : arrangement.removal_order) {
      const auto at = std::find(tray.ids.begin(), tray.ids.end(), id);
      if (at != tray.ids.end()) tray.order.push_back(static_cast<int>(at - tray.ids.begin()));
    }
  }
  return trays;
}

std::optional<BrokenPromise> broken_on(const WrittenTray& tray, double gap_mm, const Room& room,
                                       const Progress& progress) {
  Box3 box;
  for (const Mesh& part : tray.parts) box.extend(bounding_box(part));
  const double outside = std::max((room.corner_mm - box.min()).maxCoeff(),
                                  (box.max() - room.corner_mm - room.size_mm).maxCoeff());
  if (outside > kRounding_mm)
    return BrokenPromise{fmt::format("A part stands {:.4f} mm out of the build volume", outside),
                         outside};
  for (const Mesh& part : tray.parts)
    if (const double over = room.plate.breach_mm(part, Pose::Identity()); over > kRounding_mm)
      return BrokenPromise{fmt::format("A part stands {:.4f} mm over a wall of the plate", over),
                           over};
  const double least = std::max(gap_mm - kRounding_mm, kRounding_mm);
  const double gap = least_gap_mm(tray.parts, gap_mm + 2 * kRounding_mm);
  if (gap < kRounding_mm)
    return BrokenPromise{"Two parts touch or lie within one another", kUnknown_mm};
  if (gap < least)
    return BrokenPromise{
        fmt::format("Two parts are {:.4f} mm apart where {:g} mm are promised", gap, gap_mm),
        gap_mm - gap};
  if (tray.order.size() != tray.parts.size())
    return BrokenPromise{"The order of taking parts out does not list every part once"};
  if (const auto obstacle = first_obstacle(tray.parts, tray.order, tray.paths, progress))
    return BrokenPromise{fmt::format("Part {} cannot be taken out past part {}",
                                     tray.ids[static_cast<std::size_t>(obstacle->taken)],
                                     tray.ids[static_cast<std::size_t>(obstacle->by)])};
  return std::nullopt;
}

}  // namespace

std::optional<BrokenPromise> broken_promise(const Arrangement& arrangement, double gap_mm,
                                            const Room& room, const Progress& progress) {
  for (const WrittenTray& tray : written(arrangement)) {
    progress.check();
    if (auto broken = broken_on(tray, gap_mm, room, progress)) return broken;
  }
  return std::nullopt;
}

}  // namespace packmerger
