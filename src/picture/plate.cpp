#include "picture/plate.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace packmerger {
namespace {

constexpr Colour kPlate{0.93F, 0.94F, 0.95F};
constexpr Colour kFineLine{0.82F, 0.84F, 0.87F};
constexpr Colour kStrongLine{0.66F, 0.70F, 0.75F};
constexpr Colour kVolumeLine{0.35F, 0.43F, 0.53F};
constexpr Colour kBarredLine{0.80F, 0.45F, 0.38F};
constexpr Colour kShadow{0.72F, 0.74F, 0.77F};

// Heights of what lies on z = 0, as a share of the plate's size, so that depth tells them apart.
constexpr double kPlateTop = -12e-4;
constexpr double kShadowTop = -8e-4;
constexpr double kLineTop = -4e-4;

const Vec3 kLight = Vec3(-0.4, -0.3, 1).normalized();  // where the light comes from

// A prism over a convex polygon.
TriangleSoup slab(const Polygon& outline, double low, double high) {
  TriangleSoup soup;
  const int count = static_cast<int>(outline.size());
  for (const double z : {low, high})
    for (const Vec2& at : outline) soup.points.emplace_back(at.x(), at.y(), z);
  for (int i = 1; i + 1 < count; ++i) {
    soup.triangles.push_back({0, i + 1, i});
    soup.triangles.push_back({count, count + i, count + i + 1});
  }
  for (int i = 0; i < count; ++i) {
    const int next = (i + 1) % count;
    soup.triangles.push_back({i, next, count + next});
    soup.triangles.push_back({i, count + next, count + i});
  }
  return soup;
}

Vec3 at_height(const Vec2& at, double z) { return {at.x(), at.y(), z}; }

void add_border(Scene& scene, const Polygon& polygon, double z, const Colour& colour) {
  for (std::size_t i = 0; i < polygon.size(); ++i)
    scene.lines.push_back(
        {at_height(polygon[i], z), at_height(polygon[(i + 1) % polygon.size()], z), colour});
}

// What of a line lies within the polygon.
void add_line(Scene& scene, const Polygon& polygon, const Vec2& from, const Vec2& to, double z,
              const Colour& colour) {
  for (const auto& [a, b] : pieces_within(polygon, from, to))
    scene.lines.push_back({at_height(a, z), at_height(b, z), colour});
}

void hatch(Scene& scene, const Polygon& area, double step, double z) {
  const Eigen::AlignedBox2d box = bounding_box(area);
  const double most = box.max().sum();
  const double depth = box.sizes().y();
  for (double at = box.min().sum() + step / 2; at < most; at += step) {
    const Vec2 low(at - box.min().y(), box.min().y());
    add_line(scene, area, low, low + Vec2(-depth, depth), z, kBarredLine);
  }
  add_border(scene, area, z, kBarredLine);
}

Polygon rectangle(const Box3& box) {
  const Vec3& a = box.min();
  const Vec3& b = box.max();
  return {{a.x(), a.y()}, {b.x(), a.y()}, {b.x(), b.y()}, {a.x(), b.y()}};
}

}  // namespace

Ground::Ground(const Box3& volume, const Plate& plate) : volume_(volume) {
  const Vec2 corner = volume.min().head<2>();
  outline_ = plate.hull();
  barred_ = plate.barred();
  for (Vec2& at : outline_) at += corner;
  for (Polygon& area : barred_)
    for (Vec2& at : area) at += corner;
  if (outline_.empty()) outline_ = rectangle(volume);
}

void add_plate(Scene& scene, const Ground& ground) {
  const double size = ground.size();
  const double top = kPlateTop * size;
  scene.meshes.push_back({closed_mesh(slab(ground.outline(), top - 0.012 * size, top)), kPlate});

  const double step = size < 50 ? 1 : 10;
  const double z = kLineTop * size;
  const Box3& box = ground.volume();
  for (const int axis : {0, 1}) {
    const double length = box.sizes()[axis];
    for (int i = 0; i * step <= length + 1e-9; ++i) {
      Vec2 a = box.min().head<2>();
      a[axis] += i * step;
      Vec2 b = a;
      b[1 - axis] = box.max()[1 - axis];
      add_line(scene, ground.outline(), a, b, z, i % 5 == 0 ? kStrongLine : kFineLine);
    }
  }
  add_border(scene, ground.outline(), z, kStrongLine);
  for (const Polygon& area : ground.barred()) hatch(scene, area, step / 2, z);
}

void add_volume(Scene& scene, const Ground& ground) {
  constexpr std::size_t kMostEdges = 12;  // upright: more of them would be a curtain
  const double low = ground.volume().min().z();
  const double high = ground.volume().max().z();
  for (const double z : {low, high}) add_border(scene, ground.outline(), z, kVolumeLine);
  const std::size_t every = 1 + (ground.outline().size() - 1) / kMostEdges;
  for (std::size_t i = 0; i < ground.outline().size(); i += every)
    scene.lines.push_back(
        {at_height(ground.outline()[i], low), at_height(ground.outline()[i], high), kVolumeLine});
}

void add_standing(Scene& scene, const Mesh& mesh, const Pose& pose, const Colour& colour,
                  const Ground& ground) {
  scene.meshes.push_back({mesh, colour, pose});
  std::vector<Vec3> shadow;
  for (const Vec3& standing : mesh.points()) {
    Vec3 point = pose * standing;
    point -= kLight * (point.z() / kLight.z());
    Vec2 at = point.head<2>();
    if (!contains(ground.outline(), at)) at = nearest_on_border(ground.outline(), at);
    shadow.push_back(at_height(at, kShadowTop * ground.size()));
  }
  scene.meshes.push_back({mesh.with_points(std::move(shadow)), kShadow});
}

Camera distant_camera(const std::vector<Box3>& boxes, const Vec3& direction, int width,
                      int height) {
  constexpr double kFieldOfView = 0.14;  // radians, vertical
  constexpr double kMargin = 1.06;
  const Vec3 ahead = direction.normalized();
  const Vec3 right = ahead.cross(Vec3::UnitZ()).normalized();
  const Vec3 up = right.cross(ahead);

  Box3 seen;  // the boxes along right, up and ahead
  for (const Box3& box : boxes)
    for (int i = 0; i < 8; ++i) {
      const Vec3 corner = box.corner(static_cast<Box3::CornerType>(i));
      seen.extend(Vec3(corner.dot(right), corner.dot(up), corner.dot(ahead)));
    }
  const Vec3 centre = seen.center();
  const Vec3 half = seen.sizes() / 2;
  const double reach = kMargin * std::max(half.y(), half.x() * height / width);

  Camera camera;
  camera.target = centre.x() * right + centre.y() * up + centre.z() * ahead;
  camera.eye = camera.target - (half.z() + reach / std::tan(kFieldOfView / 2)) * ahead;
  camera.field_of_view = kFieldOfView;
  return camera;
}

}  // namespace packmerger
