#include "shape/divide/fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include "base/parallel.h"

namespace packmerger {
namespace {

constexpr double kSameAxis = 1e-6;
constexpr double kRounding_mm = 1e-6;  // a part exactly as long as the tray fits

// How deep a box may be that is so many mm wide, by whole mm of its width. What fits as a box
// fits; what only fits round a kept-out area does not count.
std::vector<double> deepest_boxes(const BuildVolume& build) {
  constexpr int kHalvings = 9;
  std::vector<double> deepest_mm;
  if (build.plate.is_whole()) return deepest_mm;
  const auto fits = [&](double x, double y) {
    TriangleSoup box;
    box.points = {Vec3(0, 0, 0), Vec3(x, 0, 0), Vec3(x, y, 0), Vec3(0, y, 0)};
    box.triangles = {{0, 1, 2}, {0, 2, 3}};
    return build.plate.spot_for(box, build.build_mm.head<2>()).has_value();
  };
  double most = build.build_mm.y();  // a wider box is never deeper
  for (int x = 1; x <= static_cast<int>(build.build_mm.x()) && most > 0; ++x) {
    double low = 0;
    if (fits(x, most)) low = most;
    for (int i = 0; low < most && i < kHalvings; ++i) {
      const double middle = (low + most) / 2;
      (fits(x, middle) ? low : most) = middle;
    }
    deepest_mm.push_back(low);
    most = low;
  }
  deepest_mm.push_back(0);
  return deepest_mm;
}

}  // namespace

FitTest::FitTest(const BuildVolume& build)
    : build_mm_(build.build_mm), deepest_mm_(deepest_boxes(build)) {
  using std::numbers::pi;
  const int steps =
      build.rotation_step > 0
          ? std::max(1, static_cast<int>(std::floor(2 * pi / build.rotation_step + 1e-9)))
          : 1;
  const auto turn = [&](int i, const Vec3& axis) {
    return Eigen::AngleAxisd(i * build.rotation_step, axis).toRotationMatrix();
  };
  std::set<std::array<int, 3>> different;
  std::map<std::array<long, 3>, int> index_of;  // by rounded coordinates
  const auto axis_index = [&](Vec3 axis) {
    const auto rounded = [&] {
      return std::array{std::lround(axis.x() / kSameAxis), std::lround(axis.y() / kSameAxis),
                        std::lround(axis.z() / kSameAxis)};
    };
    if (rounded() < std::array{0L, 0L, 0L}) axis = -axis;
    const auto [entry, is_new] = index_of.try_emplace(rounded(), static_cast<int>(axes_.size()));
    if (is_new) axes_.push_back(axis);
    return entry->second;
  };
  for (int x = 0; x < steps; ++x)
    for (int y = 0; y < steps; ++y) {
      const Mat3 way_up = turn(y, Vec3::UnitY()) * turn(x, Vec3::UnitX());
      for (int z = 0; z < steps; ++z) {
        const Mat3 rotation = turn(z, Vec3::UnitZ()) * way_up;
        different.insert({axis_index(rotation.row(0)), axis_index(rotation.row(1)),
                          axis_index(rotation.row(2))});
      }
    }
  rotations_.assign(different.begin(), different.end());
}

FitTest::Extents FitTest::extents_of(const std::vector<Vec3>& points) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Extents extents;
  extents.low.assign(axes_.size(), kInfinity);
  extents.high.assign(axes_.size(), -kInfinity);
  for (const Vec3& point : points)
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      const double at = axes_[i].dot(point);
      extents.low[i] = std::min(extents.low[i], at);
      extents.high[i] = std::max(extents.high[i], at);
    }
  return extents;
}

std::vector<FitTest::Extents> FitTest::extents(const TetMesh& mesh,
                                               const Segments& segments) const {
  // A segment's extents are those of its points on the surface or on a cut; all will do.
  std::vector<std::vector<int>> points(segments.count);
  for (int t = 0; t < mesh.count(); ++t) {
    std::vector<int>& list = points[segments.of_tetrahedron[t]];
    list.insert(list.end(), mesh.tetrahedra[t].begin(), mesh.tetrahedra[t].end());
  }
  std::vector<Extents> result(segments.count);
  parallel_tasks(points.size(), [&](std::size_t label) {
    std::vector<int>& list = points[label];
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    std::vector<Vec3> places;
    places.reserve(list.size());
    for (const int point : list) places.push_back(mesh.points[point]);
    result[label] = extents_of(places);
  });
  return result;
}

bool FitTest::fits(const Extents& a, const Extents& b) const {
  const auto length = [&](int i) {
    return std::max(a.high[i], b.high[i]) - std::min(a.low[i], b.low[i]);
  };
  return std::any_of(rotations_.begin(), rotations_.end(), [&](const std::array<int, 3>& r) {
    return length(r[0]) <= build_mm_.x() + kRounding_mm &&
           length(r[1]) <= build_mm_.y() + kRounding_mm &&
           length(r[2]) <= build_mm_.z() + kRounding_mm && has_room(length(r[0]), length(r[1]));
  });
}

bool FitTest::has_room(double x_mm, double y_mm) const {
  if (deepest_mm_.empty()) return true;
  const auto index = static_cast<std::size_t>(std::max(0.0, std::ceil(x_mm - kRounding_mm) - 1));
  return index < deepest_mm_.size() && y_mm <= deepest_mm_[index];
}

bool FitTest::fits(const std::vector<Vec3>& points, double margin_mm) const {
  Box3 box;
  for (const Vec3& point : points) box.extend(point);
  if (box.isEmpty()) return false;
  const double most_mm = box.diagonal().norm() + margin_mm;
  if (most_mm <= build_mm_.minCoeff() && has_room(most_mm, most_mm)) return true;  // turned any way
  Extents extents = extents_of(points);
  for (double& low : extents.low) low -= margin_mm / 2;
  for (double& high : extents.high) high += margin_mm / 2;
  return fits(extents, extents);
}

void FitTest::unite(Extents& into, const Extents& from) {
  for (std::size_t i = 0; i < into.low.size(); ++i) {
    into.low[i] = std::min(into.low[i], from.low[i]);
    into.high[i] = std::max(into.high[i], from.high[i]);
  }
}

}  // namespace packmerger
