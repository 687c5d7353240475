#include <algorithm>
#include <array>
#include <map>
#include <numeric>

#include "picture/part_colour.h"
#include "picture/plate.h"
#include "picture/preview.h"

namespace packmerger {
namespace {

constexpr int kWidth = 1800;
constexpr int kHeight = 900;
constexpr Colour kCut{0.12F, 0.13F, 0.16F};
const Vec3 kView(0.35, 1, -0.3);

// Corners of faces that share an edge inside one segment share a vertex; all others get their own,
// so that every segment is a 2-manifold, however it touches itself.
class CornerClasses {
 public:
  explicit CornerClasses(std::size_t corners) : parent_(corners) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  int find(int corner) {
    while (parent_[corner] != corner) corner = parent_[corner] = parent_[parent_[corner]];
    return corner;
  }
  void unite(int a, int b) { parent_[find(a)] = find(b); }

 private:
  std::vector<int> parent_;
};

// Calls visit(face, k, other) for each edge once: it goes from corner k of the face to the next,
// and the other face is across it.
template <typename Visit>
void for_each_edge(const Mesh& mesh, const Visit& visit) {
  for (int face = 0; face < static_cast<int>(mesh.n_triangles()); ++face)
    for (int k = 0; k < 3; ++k)
      if (mesh.neighbours()[face][k] > face) visit(face, k, mesh.neighbours()[face][k]);
}

// The number of a point's corner among those of all faces.
int corner_of(const Mesh& mesh, int face, int point) {
  const auto& corners = mesh.triangles()[face];
  const auto at = std::find(corners.begin(), corners.end(), point);
  return 3 * face + static_cast<int>(at - corners.begin());
}

CornerClasses joined_corners(const ColouredMesh& coloured) {
  const Mesh& mesh = coloured.surface;
  CornerClasses classes(mesh.n_triangles() * 3);
  for_each_edge(mesh, [&](int face, int k, int other) {
    if (coloured.segment_of_face[face] != coloured.segment_of_face[other]) return;
    for (const int end : {k, (k + 1) % 3})
      classes.unite(3 * face + end, corner_of(mesh, other, mesh.triangles()[face][end]));
  });
  return classes;
}

std::map<int, Mesh> segment_meshes(const ColouredMesh& coloured) {
  const Mesh& mesh = coloured.surface;
  CornerClasses classes = joined_corners(coloured);
  std::map<int, TriangleSoup> soups;
  std::map<int, int> point_of_class;
  for (int face = 0; face < static_cast<int>(mesh.n_triangles()); ++face) {
    TriangleSoup& soup = soups[coloured.segment_of_face[face]];
    std::array<int, 3> triangle{};
    for (int k = 0; k < 3; ++k) {
      const auto [entry, added] = point_of_class.try_emplace(classes.find(3 * face + k),
                                                             static_cast<int>(soup.points.size()));
      if (added) soup.points.push_back(mesh.points()[mesh.triangles()[face][k]]);
      triangle[k] = entry->second;
    }
    soup.triangles.push_back(triangle);
  }
  std::map<int, Mesh> segments;
  for (auto& [segment, soup] : soups) segments[segment] = manifold_mesh(std::move(soup));
  return segments;
}

// The mean of the normals of the faces round each point, unit length.
std::vector<Vec3> point_normals(const Mesh& mesh) {
  std::vector<Vec3> normals(mesh.n_points(), Vec3::Zero());
  for (std::size_t i = 0; i < mesh.n_triangles(); ++i) {
    const auto [a, b, c] = mesh.corners(i);
    const Vec3 normal = (b - a).cross(c - a).normalized();
    for (const int corner : mesh.triangles()[i]) normals[corner] += normal;
  }
  for (Vec3& normal : normals) normal.normalize();
  return normals;
}

void add_cuts(Scene& scene, const ColouredMesh& coloured, const Pose& pose, double lift_mm) {
  const Mesh mesh = transformed(coloured.surface, pose);
  const std::vector<Vec3> normals = point_normals(mesh);
  const auto lifted = [&](int point) -> Vec3 {
    return mesh.points()[point] + lift_mm * normals[point];
  };
  for_each_edge(mesh, [&](int face, int k, int other) {
    if (coloured.segment_of_face[face] == coloured.segment_of_face[other]) return;
    const auto& corners = mesh.triangles()[face];
    scene.lines.push_back({lifted(corners[k]), lifted(corners[(k + 1) % 3]), kCut});
  });
}

}  // namespace

Image cut_picture(const ColouredMesh& before, const ColouredMesh& after) {
  const Box3 box = bounding_box(before.surface);
  const Vec3 right = kView.cross(Vec3::UnitZ()).normalized();
  const double width = box.sizes().dot(right.cwiseAbs());
  Scene scene;
  scene.line_width_px = 2;
  std::vector<Box3> all;
  Pose pose = Pose::Identity();
  for (const ColouredMesh* coloured : {&before, &after}) {
    for (const auto& [segment, mesh] : segment_meshes(*coloured))
      scene.meshes.push_back({mesh, part_colour(segment), pose});
    add_cuts(scene, *coloured, pose, 2e-3 * width);
    all.push_back(box.translated(Vec3(pose.translation())));
    pose.translation() += 1.1 * width * right;
  }
  return draw(scene, distant_camera(all, kView, kWidth, kHeight), kWidth, kHeight);
}

}  // namespace packmerger
