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
constexpr Colour kShadow{0.72F, 0.74F, 0.77F};

// Heights of what lies on z = 0, as a share of the plate's size, so that depth tells them apart.
constexpr double kPlateTop = -12e-4;
constexpr double kShadowTop = -8e-4;
constexpr double kLineTop = -4e-4;

const Vec3 kLight = Vec3(-0.4, -0.3, 1).normalized();  // where the light comes from

TriangleSoup slab(const Box3& box) {
  TriangleSoup soup;
  for (int i = 0; i < 8; ++i)
    soup.points.emplace_back(box.corner(static_cast<Box3::CornerType>(i)));
  soup.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return soup;
}

double size_of(const Box3& box) { return std::max(box.sizes().x(), box.sizes().y()); }

}  // namespace

void add_plate(Scene& scene, const Box3& box) {
  const double size = size_of(box);
  Box3 plate(box.min(), box.max());
  plate.max().z() = kPlateTop * size;
  plate.min().z() = plate.max().z() - 0.012 * size;
  scene.meshes.push_back({closed_mesh(slab(plate)), kPlate});

  const double step = size < 50 ? 1 : 10;
  const double z = kLineTop * size;
  for (const int axis : {0, 1}) {
    const int across = 1 - axis;
    const double length = box.sizes()[axis];
    for (int i = 0; i * step <= length + 1e-9; ++i) {
      Vec3 a(box.min().x(), box.min().y(), z);
      Vec3 b = a;
      a[axis] = b[axis] = box.min()[axis] + i * step;
      b[across] = box.max()[across];
      scene.lines.push_back({a, b, i % 5 == 0 ? kStrongLine : kFineLine});
    }
  }
}

void add_volume(Scene& scene, const Box3& box) {
  for (int from = 0; from < 8; ++from)
    for (const int axis : {1, 2, 4})
      if ((from & axis) == 0)
        scene.lines.push_back({box.corner(static_cast<Box3::CornerType>(from)),
                               box.corner(static_cast<Box3::CornerType>(from | axis)),
                               kVolumeLine});
}

void add_standing(Scene& scene, const Mesh& mesh, const Pose& pose, const Colour& colour,
                  const Box3& plate) {
  scene.meshes.push_back({mesh, colour, pose});
  std::vector<Vec3> shadow;
  for (const Vec3& standing : mesh.points()) {
    Vec3 point = pose * standing;
    point -= kLight * (point.z() / kLight.z());
    for (int i : {0, 1}) point[i] = std::clamp(point[i], plate.min()[i], plate.max()[i]);
    point.z() = kShadowTop * size_of(plate);
    shadow.push_back(point);
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
