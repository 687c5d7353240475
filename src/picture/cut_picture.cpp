#include <algorithm>
#include <map>
#include <memory>
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
// so that every segment is a surface OpenMesh can hold, however it touches itself.
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

int corner_of(const Mesh& mesh, Mesh::FaceHandle face, Mesh::VertexHandle vertex) {
  int corner = face.idx() * 3;
  for (const auto other : mesh.fv_ccw_range(face)) {
    if (other == vertex) break;
    ++corner;
  }
  return corner;
}

CornerClasses joined_corners(const ColouredMesh& coloured) {
  const Mesh& mesh = coloured.surface;
  CornerClasses classes(mesh.n_faces() * 3);
  for (const auto edge : mesh.edges()) {
    const auto a = edge.h0().face();
    const auto b = edge.h1().face();
    if (!a.is_valid() || !b.is_valid()) continue;
    if (coloured.segment_of_face[a.idx()] != coloured.segment_of_face[b.idx()]) continue;
    for (const auto vertex : {edge.v0(), edge.v1()})
      classes.unite(corner_of(mesh, a, vertex), corner_of(mesh, b, vertex));
  }
  return classes;
}

std::map<int, Mesh> segment_meshes(const ColouredMesh& coloured) {
  const Mesh& mesh = coloured.surface;
  CornerClasses classes = joined_corners(coloured);
  std::map<int, Mesh> segments;
  std::map<int, Mesh::VertexHandle> vertex_of_class;
  for (const auto face : mesh.faces()) {
    Mesh& segment = segments[coloured.segment_of_face[face.idx()]];
    std::vector<Mesh::VertexHandle> triangle;
    int corner = face.idx() * 3;
    for (const auto vertex : face.vertices_ccw()) {
      const auto [entry, added] =
          vertex_of_class.try_emplace(classes.find(corner++), Mesh::VertexHandle());
      if (added) entry->second = segment.add_vertex(mesh.point(vertex));
      triangle.push_back(entry->second);
    }
    segment.add_face(triangle);
  }
  return segments;
}

void add_cuts(Scene& scene, const ColouredMesh& coloured, const Pose& pose, double lift_mm) {
  Mesh mesh = transformed(coloured.surface, pose);
  mesh.request_face_normals();
  mesh.request_vertex_normals();
  mesh.update_normals();
  const auto lifted = [&](Mesh::VertexHandle vertex) -> Vec3 {
    return mesh.point(vertex) + lift_mm * mesh.normal(vertex);
  };
  for (const auto edge : mesh.edges()) {
    const auto a = edge.h0().face();
    const auto b = edge.h1().face();
    if (!a.is_valid() || !b.is_valid()) continue;
    if (coloured.segment_of_face[a.idx()] == coloured.segment_of_face[b.idx()]) continue;
    scene.lines.push_back({lifted(edge.v0()), lifted(edge.v1()), kCut});
  }
}

}  // namespace

Image cut_picture(const ColouredMesh& before, const ColouredMesh& after) {
  const Box3 box = bounding_box(before.surface);
  const Vec3 right = kView.cross(Vec3::UnitZ()).normalized();
  const double width = box.sizes().dot(right.cwiseAbs());
  Scene scene;
  scene.line_width_px = 2;
  std::vector<std::unique_ptr<Mesh>> owned;
  std::vector<Box3> all;
  Pose pose = Pose::Identity();
  for (const ColouredMesh* coloured : {&before, &after}) {
    for (auto& [segment, mesh] : segment_meshes(*coloured)) {
      owned.push_back(std::make_unique<Mesh>(std::move(mesh)));
      scene.meshes.push_back({owned.back().get(), part_colour(segment), pose});
    }
    add_cuts(scene, *coloured, pose, 2e-3 * width);
    all.push_back(box.translated(Vec3(pose.translation())));
    pose.translation() += 1.1 * width * right;
  }
  return draw(scene, distant_camera(all, kView, kWidth, kHeight), kWidth, kHeight);
}

}  // namespace packmerger
