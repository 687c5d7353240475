// Core 3MF: a ZIP archive with an XML model part (3MF Core Specification 1.3). Only that part and
// the relationships are read, into memory: no name in the archive is ever used as a path on disk.
#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>

#include <pugixml.hpp>

#include "base/error.h"
#include "base/zip_archive.h"
#include "shape/formats.h"

namespace packmerger {
namespace {

constexpr std::uint64_t kMaxInflated = std::uint64_t{512} << 20;
constexpr double kMaxTreeBytes = 2e9;  // of the XML as a tree in memory
constexpr double kNodeBytes = 72;      // of a node in pugixml's tree, with its share of a page
constexpr double kAttributeBytes = 40;
constexpr int kMaxDepth = 64;
constexpr int kMaxVisits = 1'000'000;  // components may double at every level

constexpr std::string_view kModelRelationship =
    "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
// Extensions that may be required without changing the shapes: production (without p:path) and
// materials.
constexpr std::array<std::string_view, 2> kHarmlessExtensions = {
    "http://schemas.microsoft.com/3dmanufacturing/production/2015/06",
    "http://schemas.microsoft.com/3dmanufacturing/material/2015/02"};

std::string_view local(const char* name) {
  const std::string_view whole = name;
  const std::size_t colon = whole.find(':');
  return colon == whole.npos ? whole : whole.substr(colon + 1);
}

pugi::xml_node child(const pugi::xml_node& node, std::string_view name) {
  for (const pugi::xml_node& each : node.children())
    if (local(each.name()) == name) return each;
  return {};
}

// The tree can be twenty times as large as its text.
void check_tree_size(std::string_view text) {
  const auto count = [&](char c) {
    return static_cast<double>(std::count(text.begin(), text.end(), c));
  };
  if (kNodeBytes * count('<') + kAttributeBytes * count('=') > kMaxTreeBytes)
    throw Error(Fault::kBadInput, "The 3MF file holds more elements than a model can need",
                "Reduce the model, or export it as binary STL.");
}

pugi::xml_document parsed(std::string& text) {
  check_tree_size(text);
  pugi::xml_document document;
  if (!document.load_buffer_inplace(text.data(), text.size()))
    refuse_file("its XML is not well-formed");
  return document;
}

// The name of the root model part.
std::string model_part(const ZipArchive& archive) {
  if (auto text = archive.entry("_rels/.rels")) {
    const pugi::xml_document document = parsed(*text);
    for (const pugi::xml_node& relationship : child(document, "Relationships").children())
      if (relationship.attribute("Type").value() == kModelRelationship) {
        std::string target = relationship.attribute("Target").value();
        target.erase(0, target.find_first_not_of('/'));
        return target;
      }
  }
  return "3D/3dmodel.model";
}

double unit_mm(const std::string& unit) {
  static const std::map<std::string, double> kUnits = {
      {"", 1},        {"micron", 1e-3}, {"millimeter", 1}, {"centimeter", 10},
      {"inch", 25.4}, {"foot", 304.8},  {"meter", 1000}};
  const auto found = kUnits.find(unit);
  if (found == kUnits.end()) refuse_file("its unit is not one of 3MF's");
  return found->second;
}

// p' = linear · p + offset; the file gives the rows of the transposed matrix, then the offset.
struct Transform {
  Mat3 linear = Mat3::Identity();
  Vec3 offset = Vec3::Zero();

  Transform operator*(const Transform& inner) const {
    return {linear * inner.linear, linear * inner.offset + offset};
  }
};

Transform transform_of(const pugi::xml_node& node) {
  std::string_view text = node.attribute("transform").value();
  Transform transform;
  if (text.empty()) return transform;
  std::array<double, 12> numbers{};
  for (double& number : numbers) {
    const auto word = to_double(take_word(text));
    if (!word) refuse_file("a transform does not hold twelve numbers");
    number = *word;
  }
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      transform.linear(column, row) = numbers[3 * row + column];
  transform.offset = {numbers[9], numbers[10], numbers[11]};
  if (!(std::abs(transform.linear.determinant()) > 0))
    refuse_file("a transform flattens its object");
  return transform;
}

std::int64_t index_of(const pugi::xml_node& node, const char* name) {
  const auto index = to_integer(node.attribute(name).value());
  if (!index || *index < 0) refuse_file("a triangle's corner is not a number");
  return *index;
}

void refuse_other_parts(const pugi::xml_node& node) {
  for (const pugi::xml_attribute& attribute : node.attributes())
    if (local(attribute.name()) == "path")
      throw Error(Fault::kBadInput, "The 3MF file keeps its objects in several parts (p:path)",
                  "Export it without the production extension, or as STL.");
}

class ModelReader {
 public:
  ModelReader(const pugi::xml_node& model, const Progress& progress)
      : unit_(unit_mm(model.attribute("unit").value())), progress_(progress) {
    for (const pugi::xml_node& object : child(model, "resources").children()) {
      if (local(object.name()) != "object") continue;
      if (!objects_.emplace(object.attribute("id").value(), object).second)
        refuse_file("two of its objects have the same id");
    }
  }

  TriangleSoup read(const pugi::xml_node& build) {
    for (const pugi::xml_node& item : build.children()) {
      if (local(item.name()) != "item" || is_not_printed(item)) continue;
      add_object(item, transform_of(item), 0);
    }
    return soup_.finish();
  }

 private:
  static bool is_not_printed(const pugi::xml_node& item) {
    const std::string_view printable = item.attribute("printable").value();
    return printable == "0" || printable == "false";
  }

  // referrer: an item or a component.
  void add_object(const pugi::xml_node& referrer, const Transform& transform, int depth) {
    progress_.check();
    refuse_other_parts(referrer);
    if (depth > kMaxDepth || ++visits_ > kMaxVisits) refuse_file("its components nest without end");
    const std::string id = referrer.attribute("objectid").value();
    const auto object = objects_.find(id);
    if (object == objects_.end()) refuse_file("it refers to an object that is not there");
    const std::string_view type = object->second.attribute("type").value();
    if (type == "support" || type == "solidsupport" || type == "other") return;
    if (!open_.insert(id).second) refuse_file("one of its objects contains itself");
    if (const pugi::xml_node mesh = child(object->second, "mesh")) add_mesh(mesh, transform);
    for (const pugi::xml_node& component : child(object->second, "components").children())
      if (local(component.name()) == "component")
        add_object(component, transform * transform_of(component), depth + 1);
    open_.erase(id);
  }

  void add_mesh(const pugi::xml_node& mesh, const Transform& transform) {
    const std::int64_t base = soup_.point_count();
    for (const pugi::xml_node& vertex : child(mesh, "vertices").children()) {
      if (local(vertex.name()) != "vertex") continue;
      Vec3 point;
      int axis = 0;
      for (const char* name : {"x", "y", "z"}) {
        const auto number = to_double(vertex.attribute(name).value());
        if (!number) refuse_file("a vertex lacks a coordinate");
        point[axis++] = *number;
      }
      // The unit holds for vertices and for translations, so it comes last.
      soup_.add_point(unit_ * (transform.linear * point + transform.offset));
    }
    const std::int64_t count = soup_.point_count() - base;
    const bool mirrored = transform.linear.determinant() < 0;
    for (const pugi::xml_node& triangle : child(mesh, "triangles").children()) {
      if (local(triangle.name()) != "triangle") continue;
      std::array<std::int64_t, 3> corners{index_of(triangle, "v1"), index_of(triangle, "v2"),
                                          index_of(triangle, "v3")};
      for (std::int64_t& corner : corners) {
        if (corner >= count) refuse_file("a triangle names a vertex that is not there");
        corner += base;
      }
      if (mirrored) std::swap(corners[1], corners[2]);
      soup_.add_polygon(corners);
    }
  }

  double unit_;
  const Progress& progress_;
  std::map<std::string, pugi::xml_node> objects_;
  std::set<std::string> open_;  // objects that are being added, to find cycles
  int visits_ = 0;
  SoupBuilder soup_;
};

void refuse_required_extensions(const pugi::xml_node& model) {
  std::string_view prefixes = model.attribute("requiredextensions").value();
  for (auto prefix = take_word(prefixes); !prefix.empty(); prefix = take_word(prefixes)) {
    const std::string uri = model.attribute(("xmlns:" + std::string(prefix)).c_str()).value();
    if (std::find(kHarmlessExtensions.begin(), kHarmlessExtensions.end(), uri) ==
        kHarmlessExtensions.end())
      throw Error(Fault::kBadInput,
                  "The 3MF file requires an extension that is not supported (" +
                      (uri.empty() ? std::string(prefix) : uri) + ")",
                  "Export it as core 3MF, or as STL.");
  }
}

}  // namespace

TriangleSoup read_3mf(std::string_view bytes, const Progress& progress) {
  const ZipArchive archive(bytes, kMaxInflated);
  auto text = archive.entry(model_part(archive));
  if (!text) refuse_file("its ZIP archive holds no 3D model part");
  progress.check();
  const pugi::xml_document document = parsed(*text);
  const pugi::xml_node model = child(document, "model");
  if (!model) refuse_file("its 3D model part holds no model");
  refuse_required_extensions(model);
  return ModelReader(model, progress).read(child(model, "build"));
}

}  // namespace packmerger
