#include "shape/surface/distance_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/VolumeToMesh.h>

#include "base/error.h"
#include "shape/read/soup.h"

namespace packmerger {
namespace {

constexpr double kMaxVoxels = 2e8;
// Keeps faces that lie on round coordinates off the grid's points.
constexpr double kShift = 0.3719;
constexpr int kMaxMends = 40;

class Interrupter : public openvdb::util::NullInterrupter {
 public:
  explicit Interrupter(const Progress& progress) : progress_(progress) {}
  bool wasInterrupted(int = -1) override {
    try {
      progress_.check();
      return false;
    } catch (const Error&) {
      return true;
    }
  }

 private:
  const Progress& progress_;
};

// The mesh as OpenVDB wants to see it, in units of voxels.
class Adapter {
 public:
  Adapter(TriangleSoup soup, const Vec3& origin, double voxel_mm)
      : soup_(std::move(soup)), origin_(origin), voxel_mm_(voxel_mm) {}
  std::size_t polygonCount() const { return soup_.triangles.size(); }
  std::size_t pointCount() const { return soup_.points.size(); }
  std::size_t vertexCount(std::size_t) const { return 3; }
  void getIndexSpacePoint(std::size_t triangle, std::size_t corner, openvdb::Vec3d& point) const {
    const Vec3 p = (soup_.points[soup_.triangles[triangle][corner]] - origin_) / voxel_mm_;
    point = {p.x(), p.y(), p.z()};
  }

 private:
  TriangleSoup soup_;
  Vec3 origin_;
  double voxel_mm_;
};

void add_quad(TriangleSoup& soup, const std::array<int, 4>& q) {
  const auto& p = soup.points;
  const bool other = (p[q[0]] - p[q[2]]).squaredNorm() > (p[q[1]] - p[q[3]]).squaredNorm();
  if (other) {
    soup.triangles.push_back({q[0], q[1], q[3]});
    soup.triangles.push_back({q[1], q[2], q[3]});
  } else {
    soup.triangles.push_back({q[0], q[1], q[2]});
    soup.triangles.push_back({q[0], q[2], q[3]});
  }
}

// Components that are matter, or cavities in what came before, in the order they are laid.
struct Layer {
  bool is_matter = true;
  TriangleSoup soup;
};

// A component inside another one has a smaller box, so it comes later.
std::vector<Layer> layers_of(const Mesh& mesh) {
  std::vector<TriangleSoup> parts = split_components(mesh);
  std::stable_sort(parts.begin(), parts.end(), [](const TriangleSoup& a, const TriangleSoup& b) {
    return bounding_box(a).volume() > bounding_box(b).volume();
  });
  std::vector<Layer> layers;
  for (const TriangleSoup& part : parts) {
    const bool is_matter = signed_volume_mm3(part) >= 0;
    if (layers.empty() || layers.back().is_matter != is_matter) layers.push_back({is_matter, {}});
    append(layers.back().soup, part);
  }
  return layers;
}

// Adds matter, or takes a cavity out. OpenVDB's own operations want bands of equal width on both
// sides; here only the sides that are looked at need be wide.
void lay(openvdb::FloatGrid& grid, const openvdb::FloatGrid& layer, bool is_matter) {
  auto accessor = grid.getAccessor();
  for (auto value = layer.cbeginValueAll(); value; ++value) {
    if (value.isVoxelValue()) {
      const float old = accessor.getValue(value.getCoord());
      const float changed = is_matter ? std::min(old, *value) : std::max(old, -*value);
      if (changed != old) accessor.setValue(value.getCoord(), changed);
    } else if (*value < 0) {
      openvdb::CoordBBox box;
      value.getBoundingBox(box);
      grid.fill(box, is_matter ? *value : -*value, false);
    }
  }
}

}  // namespace

struct DistanceGrid::Grid {
  openvdb::FloatGrid::Ptr values;  // in voxels
  Vec3 origin;                     // of index (0, 0, 0)
  double voxel_mm = 0;

  // One triangulation of the level, in grid coordinates.
  TriangleSoup extract(double level) const {
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec4I> quads;
    openvdb::tools::volumeToMesh(*values, points, quads, level);
    TriangleSoup soup;
    soup.points.reserve(points.size());
    for (const auto& p : points) soup.points.emplace_back(p.x(), p.y(), p.z());
    soup.triangles.reserve(2 * quads.size());
    // OpenVDB counts corners clockwise as seen from outside.
    for (const auto& quad : quads)
      add_quad(soup, {static_cast<int>(quad[3]), static_cast<int>(quad[2]),
                      static_cast<int>(quad[1]), static_cast<int>(quad[0])});
    return soup;
  }

  // The eight grid points around a place leave the enclosed side.
  void give_way(const Vec3& place, double level) {
    constexpr double kBarely = 0.05;
    auto accessor = values->getAccessor();
    for (int i = 0; i < 8; ++i) {
      const openvdb::Coord at(static_cast<int>(std::floor(place.x())) + (i & 1),
                              static_cast<int>(std::floor(place.y())) + (i >> 1 & 1),
                              static_cast<int>(std::floor(place.z())) + (i >> 2));
      const float least = static_cast<float>(level + kBarely);
      if (accessor.getValue(at) < least) accessor.setValue(at, least);
    }
  }
};

DistanceGrid::DistanceGrid(const Mesh& mesh, double voxel_mm, double inside_mm, double outside_mm,
                           NarrowSheets sheets, const Progress& progress)
    : grid_(std::make_unique<Grid>()) {
  const double layers = (inside_mm + outside_mm) / voxel_mm + 4;
  const double voxels = area_mm2(mesh) / (voxel_mm * voxel_mm) * layers;
  if (voxels > kMaxVoxels)
    throw Error(Fault::kBadInput, "The model is too large for its distance grid",
                "Raise voxel_mm, or scale the model down.");
  grid_->voxel_mm = voxel_mm;
  grid_->origin = bounding_box(mesh).min() - Vec3::Constant(kShift * voxel_mm);
  const float inside = static_cast<float>(inside_mm / voxel_mm + 2);
  const float outside = static_cast<float>(outside_mm / voxel_mm + 2);
  const int flags =
      sheets == NarrowSheets::kCount ? openvdb::tools::DISABLE_INTERSECTING_VOXEL_REMOVAL : 0;
  Interrupter interrupter(progress);
  for (Layer& layer : layers_of(mesh)) {
    const Adapter adapter(std::move(layer.soup), grid_->origin, voxel_mm);
    auto values = openvdb::tools::meshToVolume<openvdb::FloatGrid>(
        interrupter, adapter, *openvdb::math::Transform::createLinearTransform(1.0),
        layer.is_matter ? outside : inside, layer.is_matter ? inside : outside, flags);
    progress.check();
    if (grid_->values)
      lay(*grid_->values, *values, layer.is_matter);
    else
      grid_->values = std::move(values);
  }
}

DistanceGrid::DistanceGrid(DistanceGrid&&) noexcept = default;
DistanceGrid::~DistanceGrid() = default;

std::optional<TriangleSoup> DistanceGrid::level(double level_mm, const Progress& progress) {
  const double level = level_mm / grid_->voxel_mm;
  for (int i = 0; i < kMaxMends; ++i) {
    progress.check();
    TriangleSoup soup = grid_->extract(level);
    const std::vector<int> pinches = non_manifold_points(soup);
    if (pinches.empty()) {
      for (Vec3& point : soup.points) point = grid_->origin + grid_->voxel_mm * point;
      return soup;
    }
    for (const int point : pinches) grid_->give_way(soup.points[point], level);
  }
  return std::nullopt;
}

}  // namespace packmerger
