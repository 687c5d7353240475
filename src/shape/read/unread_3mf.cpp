#include "shape/read/unread_3mf.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "base/error.h"
#include "shape/read/archive_3mf.h"
#include "shape/read/formats.h"

namespace packmerger {
namespace {

constexpr const char* kAsCore = "Export it as core 3MF, or as STL.";

// Extensions that may be required without changing the shapes: production and materials.
constexpr std::array<std::string_view, 2> kHarmlessExtensions = {
    "http://schemas.microsoft.com/3dmanufacturing/production/2015/06",
    "http://schemas.microsoft.com/3dmanufacturing/material/2015/02"};

[[noreturn]] void refuse_shape(const pugi::xml_node& object, const std::string& what) {
  throw Error(Fault::kBadInput,
              "The 3MF object " + std::string(object.attribute("id").value()) + " holds " + what +
                  ", which is not supported",
              kAsCore);
}

}  // namespace

void refuse_required_extensions(const pugi::xml_node& model) {
  std::string_view prefixes = model.attribute("requiredextensions").value();
  for (auto prefix = take_word(prefixes); !prefix.empty(); prefix = take_word(prefixes)) {
    const std::string uri = model.attribute(("xmlns:" + std::string(prefix)).c_str()).value();
    if (std::find(kHarmlessExtensions.begin(), kHarmlessExtensions.end(), uri) ==
        kHarmlessExtensions.end())
      throw Error(Fault::kBadInput,
                  "The 3MF file requires an extension that is not supported (" +
                      (uri.empty() ? std::string(prefix) : uri) + ")",
                  kAsCore);
  }
}

void refuse_unread_shapes(const pugi::xml_node& object) {
  bool has_slices = false;
  bool is_full = false;
  for (const pugi::xml_attribute& attribute : object.attributes()) {
    const std::string_view name = local_name(attribute.name());
    has_slices |= name == "slicestackid";
    is_full |= name == "meshresolution" && std::string_view(attribute.value()) == "fullres";
  }
  if (has_slices && !is_full) refuse_shape(object, "slices, of which its mesh is a rough copy");
  const pugi::xml_node mesh = child_named(object, "mesh");
  if (child_named(mesh, "beamlattice")) refuse_shape(object, "beams");
  if (mesh || child_named(object, "components")) return;
  const pugi::xml_node other = object.first_child();
  refuse_shape(object, other ? "<" + std::string(other.name()).substr(0, 40) + "> instead of a mesh"
                             : "no mesh");
}

void refuse_negative_volume(const std::string& object) {
  throw Error(Fault::kBadInput,
              "The 3MF project takes a negative volume away from object " + object +
                  ", which is not supported",
              "Export the model from the slicer as STL, or subtract the volume in the program it "
              "was drawn with.");
}

void refuse_unknown_role(std::string_view name) {
  throw Error(Fault::kBadInput,
              "The 3MF project holds a volume of a kind that is not known (" +
                  std::string(name.substr(0, 40)) + ")",
              "Export the model from the slicer as STL.");
}

void refuse_mould(const pugi::xml_node& object) {
  const std::string name = object.attribute("name").value();
  throw Error(Fault::kBadInput,
              "The 3MF project asks for a mould of the model" +
                  (name.empty() ? "" : " " + name.substr(0, 80)) + ", which is not supported",
              "Switch the mould off in the slicer, or draw it and export it as STL.");
}

}  // namespace packmerger
