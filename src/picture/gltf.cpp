#include "picture/gltf.h"

#include "picture/corner_normals.h"
#include "picture/gltf_file.h"

namespace packmerger {
namespace {

int add_vectors(tinygltf::Model& model, const std::vector<Eigen::Vector3f>& vectors, bool bounded) {
  tinygltf::Accessor accessor;
  accessor.bufferView = add_view(model, vectors.data(), vectors.size() * sizeof(Eigen::Vector3f),
                                 TINYGLTF_TARGET_ARRAY_BUFFER);
  accessor.componentType = TINYGLTF_COMPONENT_TYPE_FLOAT;
  accessor.type = TINYGLTF_TYPE_VEC3;
  accessor.count = vectors.size();
  if (bounded) {
    Eigen::AlignedBox3f box;
    for (const Eigen::Vector3f& vector : vectors) box.extend(vector);
    for (int i = 0; i < 3; ++i) {
      accessor.minValues.push_back(box.min()[i]);
      accessor.maxValues.push_back(box.max()[i]);
    }
  }
  model.accessors.push_back(accessor);
  return static_cast<int>(model.accessors.size()) - 1;
}

int add_indices(tinygltf::Model& model, const SplitSurface& surface) {
  tinygltf::Accessor accessor;
  accessor.bufferView = add_view(model, surface.triangles.data(),
                                 surface.triangles.size() * sizeof surface.triangles[0],
                                 TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
  accessor.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  accessor.type = TINYGLTF_TYPE_SCALAR;
  accessor.count = surface.triangles.size() * 3;
  model.accessors.push_back(accessor);
  return static_cast<int>(model.accessors.size()) - 1;
}

int add_mesh(tinygltf::Model& model, const GltfPart& part) {
  const SplitSurface surface = split_at_sharp_edges(*part.surface);
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    points.push_back((gltf_axes(part.pose * surface.points[i]) * kMetresPerMm).cast<float>());
    normals.push_back(gltf_axes(part.pose.linear() * surface.normals[i]).cast<float>());
  }
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.attributes["POSITION"] = add_vectors(model, points, true);
  primitive.attributes["NORMAL"] = add_vectors(model, normals, false);
  primitive.indices = add_indices(model, surface);
  primitive.material = add_material(model, part.name, part.colour);
  tinygltf::Mesh mesh;
  mesh.name = part.name;
  mesh.primitives.push_back(primitive);
  model.meshes.push_back(mesh);
  return static_cast<int>(model.meshes.size()) - 1;
}

}  // namespace

std::string glb_bytes(const std::vector<GltfPart>& parts) {
  tinygltf::Model model = empty_gltf();
  tinygltf::Scene scene;
  for (const GltfPart& part : parts) {
    tinygltf::Node node;
    node.name = part.name;
    node.mesh = add_mesh(model, part);
    if (!part.aside_mm.isZero()) {
      const Vec3 aside = gltf_axes(part.aside_mm) * kMetresPerMm;
      node.translation = {aside.x(), aside.y(), aside.z()};
    }
    model.nodes.push_back(node);
    scene.nodes.push_back(static_cast<int>(model.nodes.size()) - 1);
  }
  model.scenes.push_back(scene);
  model.defaultScene = 0;
  return glb_of(model);
}

}  // namespace packmerger
