#include "picture/gltf_file.h"

#include <cmath>
#include <sstream>

#include "base/error.h"

namespace packmerger {
namespace {

// glTF's colours are linear; ours are as they appear on screen (sRGB).
double linear(float shown) {
  return shown <= 0.04045F ? shown / 12.92 : std::pow((shown + 0.055) / 1.055, 2.4);
}

}  // namespace

tinygltf::Model empty_gltf() {
  tinygltf::Model model;
  model.asset.version = "2.0";
  model.asset.generator = "PackMerger";
  model.buffers.emplace_back();
  return model;
}

int add_view(tinygltf::Model& model, const void* data, std::size_t bytes, int target,
             std::size_t stride_bytes) {
  std::vector<unsigned char>& buffer = model.buffers[0].data;
  buffer.resize((buffer.size() + 3) / 4 * 4);
  tinygltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = buffer.size();
  view.byteLength = bytes;
  view.byteStride = stride_bytes;
  view.target = target;
  const auto* first = static_cast<const unsigned char*>(data);
  buffer.insert(buffer.end(), first, first + bytes);
  model.bufferViews.push_back(view);
  return static_cast<int>(model.bufferViews.size()) - 1;
}

int add_material(tinygltf::Model& model, const std::string& name, const Colour& colour) {
  tinygltf::Material material;
  material.name = name;
  material.pbrMetallicRoughness.baseColorFactor = {linear(colour.red), linear(colour.green),
                                                   linear(colour.blue), 1.0};
  material.pbrMetallicRoughness.metallicFactor = 0;
  material.pbrMetallicRoughness.roughnessFactor = 0.6;
  model.materials.push_back(material);
  return static_cast<int>(model.materials.size()) - 1;
}

std::string glb_of(tinygltf::Model& model) {
  std::ostringstream out;
  tinygltf::TinyGLTF writer;
  if (!writer.WriteGltfSceneToStream(&model, out, false, true) || !out)
    throw Error(Fault::kInternal, "The glTF scene could not be written",
                "Please report this together with the model.");
  return std::move(out).str();
}

}  // namespace packmerger
