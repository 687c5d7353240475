#include "picture/page_scene.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "picture/corner_normals.h"
#include "picture/gltf_file.h"

namespace packmerger {
namespace {

constexpr std::size_t kTriangles = 40000;
constexpr std::size_t kLeastTriangles = 200;  // of a part
constexpr double kSteps = 65535;              // of a coordinate

// A part's surface in glTF's axes, mm: fewer triangles, and no vertex that is in none of them.
struct Reduced {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
  std::vector<std::uint32_t> corners;  // three a triangle
};

template <typename Item>
std::vector<Item> remapped(const std::vector<Item>& items, const std::vector<unsigned>& to,
                           std::size_t count) {
  std::vector<Item> out(count);
  for (std::size_t i = 0; i < items.size(); ++i)
    if (to[i] != ~0U) out[to[i]] = items[i];
  return out;
}

Reduced reduced(const Mesh& mesh, double share) {
  const SplitSurface surface = split_at_sharp_edges(mesh);
  Reduced part;
  for (const Vec3& point : surface.points) part.points.push_back(gltf_axes(point).cast<float>());
  for (const Vec3& normal : surface.normals)
    part.normals.push_back(gltf_axes(normal).cast<float>());
  for (const auto& triangle : surface.triangles)
    part.corners.insert(part.corners.end(), triangle.begin(), triangle.end());
  const std::size_t count = part.points.size();
  const auto wanted = static_cast<std::size_t>(share * static_cast<double>(kTriangles));
  const std::size_t target = 3 * std::max(wanted, kLeastTriangles);
  std::vector<std::uint32_t> corners(part.corners.size());
  corners.resize(meshopt_simplify(corners.data(), part.corners.data(), part.corners.size(),
                                  part.points.data()->data(), count, sizeof(Eigen::Vector3f),
                                  std::min(target, corners.size()), 1.0F));
  // what follows one another in the file is near each other, and shrinks better when compressed
  meshopt_optimizeVertexCache(corners.data(), corners.data(), corners.size(), count);
  std::vector<unsigned> to(count);
  const std::size_t kept =
      meshopt_optimizeVertexFetchRemap(to.data(), corners.data(), corners.size(), count);
  for (std::uint32_t& corner : corners) corner = to[corner];
  return {remapped(part.points, to, kept), remapped(part.normals, to, kept), std::move(corners)};
}

// A mesh whose coordinates are whole numbers, and where it lies.
struct Quantised {
  int mesh = 0;
  Vec3 origin_mm = Vec3::Zero();  // of the whole numbers, glTF's axes
  double step_mm = 1;
};

int add_accessor(tinygltf::Model& model, int view, int component, int type, std::size_t count) {
  tinygltf::Accessor accessor;
  accessor.bufferView = view;
  accessor.componentType = component;
  accessor.type = type;
  accessor.count = count;
  model.accessors.push_back(accessor);
  return static_cast<int>(model.accessors.size()) - 1;
}

int add_points(tinygltf::Model& model, const Reduced& part, const Quantised& place) {
  std::vector<std::array<std::uint16_t, 4>> whole;  // the fourth fills up to eight bytes
  std::array<double, 3> low{kSteps, kSteps, kSteps};
  std::array<double, 3> high{};
  for (const Eigen::Vector3f& point : part.points) {
    const Vec3 steps = (point.cast<double>() - place.origin_mm) / place.step_mm;
    std::array<std::uint16_t, 4> item{};
    for (std::size_t i = 0; i < 3; ++i) {
      const double step = std::clamp(std::round(steps[static_cast<int>(i)]), 0.0, kSteps);
      item[i] = static_cast<std::uint16_t>(step);
      low[i] = std::min(low[i], step);
      high[i] = std::max(high[i], step);
    }
    whole.push_back(item);
  }
  const int view = add_view(model, whole.data(), whole.size() * sizeof whole[0],
                            TINYGLTF_TARGET_ARRAY_BUFFER, sizeof whole[0]);
  const int accessor = add_accessor(model, view, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT,
                                    TINYGLTF_TYPE_VEC3, whole.size());
  model.accessors.back().minValues.assign(low.begin(), low.end());
  model.accessors.back().maxValues.assign(high.begin(), high.end());
  return accessor;
}

int add_normals(tinygltf::Model& model, const Reduced& part) {
  std::vector<std::array<std::int8_t, 4>> whole;
  for (const Eigen::Vector3f& normal : part.normals) {
    std::array<std::int8_t, 4> item{};
    for (std::size_t i = 0; i < 3; ++i)
      item[i] = static_cast<std::int8_t>(std::lround(127 * normal[static_cast<int>(i)]));
    whole.push_back(item);
  }
  const int view = add_view(model, whole.data(), whole.size() * sizeof whole[0],
                            TINYGLTF_TARGET_ARRAY_BUFFER, sizeof whole[0]);
  const int accessor =
      add_accessor(model, view, TINYGLTF_COMPONENT_TYPE_BYTE, TINYGLTF_TYPE_VEC3, whole.size());
  model.accessors.back().normalized = true;
  return accessor;
}

int add_corners(tinygltf::Model& model, const Reduced& part) {
  constexpr int kTarget = TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER;
  if (part.points.size() > 65535) {
    const int view =
        add_view(model, part.corners.data(), part.corners.size() * sizeof(std::uint32_t), kTarget);
    return add_accessor(model, view, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR,
                        part.corners.size());
  }
  std::vector<std::uint16_t> narrow;
  for (const std::uint32_t corner : part.corners)
    narrow.push_back(static_cast<std::uint16_t>(corner));
  const int view = add_view(model, narrow.data(), narrow.size() * sizeof narrow[0], kTarget);
  return add_accessor(model, view, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, TINYGLTF_TYPE_SCALAR,
                      narrow.size());
}

Quantised add_mesh(tinygltf::Model& model, const PagePart& part, double share) {
  const Reduced surface = reduced(*part.surface, share);
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& point : surface.points) box.extend(point);
  Quantised place;
  place.origin_mm = box.min().cast<double>();
  place.step_mm = std::max(1e-6, static_cast<double>(box.sizes().maxCoeff())) / kSteps;
  const std::string name = "part " + std::to_string(part.id);
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.attributes["POSITION"] = add_points(model, surface, place);
  primitive.attributes["NORMAL"] = add_normals(model, surface);
  primitive.indices = add_corners(model, surface);
  primitive.material = add_material(model, name, part.colour);
  tinygltf::Mesh mesh;
  mesh.name = name;
  mesh.primitives.push_back(primitive);
  model.meshes.push_back(mesh);
  place.mesh = static_cast<int>(model.meshes.size()) - 1;
  return place;
}

// pose and aside_mm: from the part's model to the scene, in mm and our axes.
int add_node(tinygltf::Model& model, int id, const Quantised& mesh, const Pose& pose,
             const Vec3& aside_mm) {
  Eigen::Matrix3d turn;
  for (int i = 0; i < 3; ++i) turn.col(i) = gltf_axes(pose.linear().col(i));
  // the columns are where x, y, z of ours go; glTF's own axes are x, z and the negative y
  Eigen::Matrix3d axes;
  axes.col(0) = turn.col(0);
  axes.col(1) = turn.col(2);
  axes.col(2) = -turn.col(1);
  const Eigen::Quaterniond rotation(axes);
  const Vec3 at = (axes * mesh.origin_mm + gltf_axes(pose.translation() + aside_mm)) * kMetresPerMm;
  tinygltf::Node node;
  node.name = "part " + std::to_string(id);
  node.mesh = mesh.mesh;
  node.translation = {at.x(), at.y(), at.z()};
  node.rotation = {rotation.x(), rotation.y(), rotation.z(), rotation.w()};
  node.scale = std::vector<double>(3, mesh.step_mm * kMetresPerMm);
  node.extras = tinygltf::Value(tinygltf::Value::Object{{"part", tinygltf::Value(id)}});
  model.nodes.push_back(node);
  return static_cast<int>(model.nodes.size()) - 1;
}

}  // namespace

std::string page_glb(const std::vector<PagePart>& parts) {
  tinygltf::Model model = empty_gltf();
  model.extensionsUsed = {"KHR_mesh_quantization"};
  model.extensionsRequired = model.extensionsUsed;
  double triangles = 0;
  for (const PagePart& part : parts) triangles += static_cast<double>(part.surface->n_triangles());
  tinygltf::Scene trays;
  trays.name = "trays";
  tinygltf::Scene models;
  models.name = "models";
  for (const PagePart& part : parts) {
    const double share = static_cast<double>(part.surface->n_triangles()) / triangles;
    const Quantised mesh = add_mesh(model, part, share);
    trays.nodes.push_back(add_node(model, part.id, mesh, part.on_tray, part.aside_on_tray_mm));
    models.nodes.push_back(
        add_node(model, part.id, mesh, Pose::Identity(), part.aside_in_model_mm));
  }
  model.scenes = {trays, models};
  model.defaultScene = 0;
  return glb_of(model);
}

}  // namespace packmerger
