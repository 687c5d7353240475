#include "shape/surface/coarsen.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <utility>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModAspectRatioT.hh>
#include <OpenMesh/Tools/Decimater/ModEdgeLengthT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#include <OpenMesh/Tools/Decimater/Observer.hh>

namespace packmerger {
namespace {

// The decimater's modules do not compile with Eigen's vectors.
struct PlainTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};
using PlainMesh = OpenMesh::TriMesh_ArrayKernelT<PlainTraits>;
using Decimater = OpenMesh::Decimater::DecimaterT<PlainMesh>;

constexpr float kMaxAspectRatio = 8;
constexpr float kMaxTurnDegrees = 60;
// Where the surface is flat every collapse costs nothing; then short edges go first.
constexpr double kLengthCost = 1e-5;

using Quadric = OpenMesh::Decimater::ModQuadricT<PlainMesh>;
class QuadricAndLength : public Quadric {
 public:
  using Quadric::Quadric;
  float collapse_priority(const CollapseInfo& collapse) override {
    const float error = Quadric::collapse_priority(collapse);
    if (error == static_cast<float>(ILLEGAL_COLLAPSE)) return error;
    const double squared_mm2 = (collapse.p0 - collapse.p1).sqrnorm();
    // Rounding makes the error of flat places slightly negative, which would forbid them.
    return std::max(error, 0.0F) + static_cast<float>(kLengthCost * squared_mm2 * squared_mm2);
  }
};

// Ends the decimater's work where cancelling was asked for.
class Watch : public OpenMesh::Decimater::Observer {
 public:
  explicit Watch(const Progress& progress) : Observer(kEvery), progress_(progress) {}
  void notify(std::size_t) override {}
  bool abort() const override {
    const std::atomic<bool>* cancelled = progress_.cancelled();
    return cancelled != nullptr && cancelled->load();
  }

 private:
  static constexpr std::size_t kEvery = 1000;  // collapses
  const Progress& progress_;
};

PlainMesh to_plain(const Mesh& mesh) {
  PlainMesh plain;
  plain.reserve(mesh.n_points(), mesh.n_triangles() * 3 / 2, mesh.n_triangles());
  for (const Vec3& p : mesh.points()) plain.add_vertex({p.x(), p.y(), p.z()});
  const auto vertex = [](int i) { return PlainMesh::VertexHandle(i); };
  for (const auto& [a, b, c] : mesh.triangles()) plain.add_face(vertex(a), vertex(b), vertex(c));
  return plain;
}

Mesh from_plain(const PlainMesh& plain) {
  TriangleSoup soup;
  for (const auto vertex : plain.vertices()) {
    const auto& p = plain.point(vertex);
    soup.points.emplace_back(p[0], p[1], p[2]);
  }
  for (const auto face : plain.faces()) {
    std::array<int, 3> triangle{};
    int i = 0;
    for (const auto vertex : face.vertices_ccw()) triangle[i++] = vertex.idx();
    soup.triangles.push_back(triangle);
  }
  return closed_mesh(std::move(soup));
}

}  // namespace

Mesh coarsened(const Mesh& mesh, double tolerance_mm, double max_edge_mm,
               const Progress& progress) {
  PlainMesh plain = to_plain(mesh);
  plain.request_face_normals();
  plain.update_face_normals();
  Decimater decimater(plain);
  OpenMesh::Decimater::ModHandleT<QuadricAndLength> quadric;
  decimater.add(quadric);
  // A quadric sums area times squared distance, each triangle three times.
  const double patch_mm2 = max_edge_mm * max_edge_mm / 2;
  decimater.module(quadric).set_max_err(3 * patch_mm2 * tolerance_mm * tolerance_mm, false);
  OpenMesh::Decimater::ModNormalFlippingT<PlainMesh>::Handle flipping;
  decimater.add(flipping);
  decimater.module(flipping).set_max_normal_deviation(kMaxTurnDegrees);
  OpenMesh::Decimater::ModEdgeLengthT<PlainMesh>::Handle length;
  decimater.add(length);
  decimater.module(length).set_edge_length(static_cast<float>(max_edge_mm));
  OpenMesh::Decimater::ModAspectRatioT<PlainMesh>::Handle aspect;
  decimater.add(aspect);
  decimater.module(aspect).set_aspect_ratio(kMaxAspectRatio);
  Watch watch(progress);
  decimater.set_observer(&watch);
  progress.check();
  decimater.initialize();
  decimater.decimate_to_faces(0, 0);
  progress.check();
  plain.garbage_collection();
  return from_plain(plain);
}

}  // namespace packmerger
