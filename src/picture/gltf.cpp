#include "picture/gltf.h"

#include <cmath>
#include <limits>
#include <sstream>

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#include <tiny_gltf.h>

#include "base/error.h"
#include "picture/corner_normals.h"

namespace packmerger {
namespace {

constexpr double kMetresPerMm = 1e-3;

// glTF's axes: y up, z towards the viewer.
Vec3 gltf_axes(const Vec3& v) { return {v.x(), v.z(), -v.y()}; }

// glTF's colours are linear; ours are as they appear on screen (sRGB).
double linear(float shown) {
  return shown <= 0.04045F ? shown / 12.92 : std::pow((shown + 0.055) / 1.055, 2.4);
}

int add_view(tinygltf::Model& model, const void* data, std::size_t bytes, int target) {
  std::vector<unsigned char>& buffer = model.buffers[0].data;
  tinygltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = buffer.size();
  view.byteLength = bytes;
  view.target = target;
  const auto* first = static_cast<const unsigned char*>(data);
  buffer.insert(buffer.end(), first, first + bytes);
  model.bufferViews.push_back(view);
  return static_cast<int>(model.bufferViews.size()) - 1;
}

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

int add_material(tinygltf::Model& model, const GltfPart& part) {
  tinygltf::Material material;
  material.name = part.name;
  material.pbrMetallicRoughness.baseColorFactor = {
      linear(part.colour.red), linear(part.colour.green), linear(part.colour.blue), 1.0};
  material.pbrMetallicRoughness.metallicFactor = 0;
  material.pbrMetallicRoughness.roughnessFactor = 0.6;
  model.materials.push_back(material);
  return static_cast<int>(model.materials.size()) - 1;
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
  primitive.material = add_material(model, part);
  tinygltf::Mesh mesh;
  mesh.name = part.name;
  mesh.primitives.push_back(primitive);
  model.meshes.push_back(mesh);
  return static_cast<int>(model.meshes.size()) - 1;
}

}  // namespace

std::string glb_bytes(const std::vector<GltfPart>& parts) {
  tinygltf::Model model;
  model.asset.version = "2.0";
  model.asset.generator = "PackMerger";
  model.buffers.emplace_back();
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

  std::ostringstream out;
  tinygltf::TinyGLTF writer;
  if (!writer.WriteGltfSceneToStream(&model, out, false, true) || !out)
    throw Error(Fault::kInternal, "The glTF scene could not be written",
                "Please report this together with the model.");
  return std::move(out).str();
}

}  // namespace packmerger
