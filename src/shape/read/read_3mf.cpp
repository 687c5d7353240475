// Core 3MF: a ZIP archive with an XML model part (3MF Core Specification 1.3), those that it refers
// to (production extension), and what slicers' projects say about them.
#include <array>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "base/error.h"
#include "shape/read/archive_3mf.h"
#include "shape/read/formats.h"
#include "shape/read/unread_3mf.h"
#include "shape/read/volume_roles.h"

namespace packmerger {
namespace {

constexpr int kMaxDepth = 64;
constexpr int kMaxVisits = 1'000'000;  // components may double at every level

constexpr std::string_view kModelRelationship =
    "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
std::string without_slash(std::string name) {
  name.erase(0, name.find_first_not_of('/'));
  return name;
}

// The name of the root model part.
std::string model_part(Archive3mf& archive) {
  std::set<std::string> found;
  if (const auto relations = archive.part("_rels/.rels"))
    for (const pugi::xml_node& relationship :
         child_named(relations->tree, "Relationships").children())
      if (relationship.attribute("Type").value() == kModelRelationship)
        found.insert(without_slash(relationship.attribute("Target").value()));
  if (found.size() > 1)
    throw Error(Fault::kBadInput, "The 3MF file names several root models, where one is meant",
                "Export the models one by one.");
  return found.empty() ? "3D/3dmodel.model" : *found.begin();
}

double unit_mm(const std::string& unit) {
  static const std::map<std::string, double> kUnits = {
      {"", 1},        {"micron", 1e-3}, {"millimeter", 1}, {"centimeter", 10},
      {"inch", 25.4}, {"foot", 304.8},  {"meter", 1000}};
  const auto found = kUnits.find(unit);
  if (found == kUnits.end()) refuse_file("its unit is not one of 3MF's");
  return found->second;
}

// p' = linear · p + offset, in mm; the file gives the rows of the transposed matrix, then the
// offset.
struct Transform {
  Mat3 linear = Mat3::Identity();
  Vec3 offset = Vec3::Zero();

  Transform operator*(const Transform& inner) const {
    return {linear * inner.linear, linear * inner.offset + offset};
  }
};

// unit: of the model part that the node stands in; the offset becomes millimetres.
Transform transform_of(const pugi::xml_node& node, double unit) {
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
  transform.offset = unit * Vec3(numbers[9], numbers[10], numbers[11]);
  if (!(std::abs(transform.linear.determinant()) > 0))
    refuse_file("a transform flattens its object");
  return transform;
}

std::int64_t index_of(const pugi::xml_node& node, const char* name) {
  const auto index = to_integer(node.attribute(name).value());
  if (!index || *index < 0) refuse_file("a triangle's corner is not a number");
  return *index;
}

// The p:path of an item or a component; empty: the part that it stands in.
std::string path_of(const pugi::xml_node& referrer) {
  for (const pugi::xml_attribute& attribute : referrer.attributes())
    if (local_name(attribute.name()) == "path") return without_slash(attribute.value());
  return "";
}

enum class ObjectUse { kMatter, kSupport, kOther };

ObjectUse use_of(const pugi::xml_node& object) {
  const std::string_view type = object.attribute("type").value();
  if (type.empty() || type == "model" || type == "surface") return ObjectUse::kMatter;
  if (type == "support" || type == "solidsupport") return ObjectUse::kSupport;
  if (type == "other") return ObjectUse::kOther;
  // one that is not known may mean that there is no matter
  throw Error(Fault::kBadInput,
              "The 3MF file holds an object of a type that is not known (" +
                  std::string(type.substr(0, 40)) + ")",
              "Export it as core 3MF, or as STL.");
}

// A model part of the archive.
struct ModelPart {
  std::unique_ptr<XmlPart> xml;
  double unit = 1;
  std::map<std::string, pugi::xml_node> objects;
};

class ModelReader {
 public:
  ModelReader(Archive3mf& archive, const Progress& progress)
      : archive_(archive), progress_(progress), root_(model_part(archive)) {}

  Parts3mf read() {
    const ModelPart& root = part(root_);
    const pugi::xml_node model = child_named(root.xml->tree, "model");
    roles_ = read_volume_roles(archive_, model);
    progress_.check();
    for (const pugi::xml_node& item : child_named(model, "build").children()) {
      if (local_name(item.name()) != "item") continue;
      if (is_not_printed(item)) {
        ++left_out_.unprinted_items;
        continue;
      }
      if (const VolumeRole role = cura_role(item, model); role != VolumeRole::kPart) {
        count_left_out(role);
        continue;
      }
      const std::string path = path_of(item);
      add_object(item, path.empty() ? root_ : path, transform_of(item, root.unit), 0);
    }
    TriangleSoup soup = soup_.finish();
    if (soup.triangles.empty())
      throw Error(Fault::kBadInput, "The 3MF file's build holds nothing to print",
                  "Put the model on the plate in the program that made the file, and export it "
                  "again.");
    return {std::move(soup), left_out_};
  }

 private:
  static bool is_not_printed(const pugi::xml_node& item) {
    const std::string_view printable = item.attribute("printable").value();
    return printable == "0" || printable == "false";
  }

  const ModelPart& part(const std::string& path) {
    const auto known = parts_.find(path);
    if (known != parts_.end()) return known->second;
    ModelPart part;
    part.xml = archive_.part(path);
    if (!part.xml)
      throw Error(Fault::kBadInput,
                  "The model file is a ZIP archive that holds no 3D model part (" + path + ")",
                  "If models are packed in it, unpack it and give them; else export the model "
                  "again.");
    progress_.check();
    const pugi::xml_node model = child_named(part.xml->tree, "model");
    if (!model) refuse_file("its 3D model part holds no model");
    refuse_required_extensions(model);
    part.unit = unit_mm(model.attribute("unit").value());
    for (const pugi::xml_node& object : child_named(model, "resources").children()) {
      if (local_name(object.name()) != "object") continue;
      if (!part.objects.emplace(object.attribute("id").value(), object).second)
        refuse_file("two of its objects have the same id");
    }
    return parts_.emplace(path, std::move(part)).first->second;
  }

  // referrer: an item or a component; path: the model part that its object stands in.
  void add_object(const pugi::xml_node& referrer, const std::string& path,
                  const Transform& transform, int depth) {
    progress_.check();
    if (depth > kMaxDepth || ++visits_ > kMaxVisits) refuse_file("its components nest without end");
    const ModelPart& here = part(path);
    const std::string id = referrer.attribute("objectid").value();
    const auto object = here.objects.find(id);
    if (object == here.objects.end()) refuse_file("it refers to an object that is not there");
    if (const ObjectUse use = use_of(object->second); use != ObjectUse::kMatter) {
      ++(use == ObjectUse::kSupport ? left_out_.support_objects : left_out_.other_objects);
      return;
    }
    refuse_unread_shapes(object->second);
    if (!open_.insert({path, id}).second) refuse_file("one of its objects contains itself");
    static const ObjectRoles kNoRoles;
    const auto told = path == root_ ? roles_.find(id) : roles_.end();
    const ObjectRoles& roles = told == roles_.end() ? kNoRoles : told->second;
    if (const pugi::xml_node mesh = child_named(object->second, "mesh"))
      add_mesh(mesh, here.unit, transform, roles, id);
    for (const pugi::xml_node& component : child_named(object->second, "components").children()) {
      if (local_name(component.name()) != "component") continue;
      const auto role = roles.components.find(component.attribute("objectid").value());
      if (role != roles.components.end() && !is_matter(role->second, id)) {
        count_left_out(role->second);
        continue;
      }
      const std::string other = path_of(component);
      add_object(component, other.empty() ? path : other,
                 transform * transform_of(component, here.unit), depth + 1);
    }
    open_.erase({path, id});
  }

  static bool is_matter(VolumeRole role, const std::string& object) {
    if (role == VolumeRole::kNegative) refuse_negative_volume(object);
    return role == VolumeRole::kPart;
  }

  void count_left_out(VolumeRole role) {
    ++(role == VolumeRole::kModifier ? left_out_.modifiers : left_out_.support_helpers);
  }

  void add_mesh(const pugi::xml_node& mesh, double unit, const Transform& transform,
                const ObjectRoles& roles, const std::string& id) {
    const std::int64_t base = soup_.point_count();
    for (const pugi::xml_node& vertex : child_named(mesh, "vertices").children()) {
      if (local_name(vertex.name()) != "vertex") continue;
      Vec3 point;
      int axis = 0;
      for (const char* name : {"x", "y", "z"}) {
        const auto number = to_double(vertex.attribute(name).value());
        if (!number) refuse_file("a vertex lacks a coordinate");
        point[axis++] = *number;
      }
      soup_.add_point(transform.linear * (unit * point) + transform.offset);
    }
    for (const ObjectRoles::Range& range : roles.ranges)
      if (!is_matter(range.role, id)) count_left_out(range.role);
    const std::int64_t count = soup_.point_count() - base;
    const bool mirrored = transform.linear.determinant() < 0;
    std::int64_t number = 0;
    for (const pugi::xml_node& triangle : child_named(mesh, "triangles").children()) {
      if (local_name(triangle.name()) != "triangle") continue;
      std::array<std::int64_t, 3> corners{index_of(triangle, "v1"), index_of(triangle, "v2"),
                                          index_of(triangle, "v3")};
      for (std::int64_t& corner : corners) {
        if (corner >= count) refuse_file("a triangle names a vertex that is not there");
        corner += base;
      }
      if (roles.of_triangle(number++) != VolumeRole::kPart) continue;
      if (mirrored) std::swap(corners[1], corners[2]);
      soup_.add_polygon(corners);
    }
  }

  Archive3mf& archive_;
  const Progress& progress_;
  std::string root_;
  std::map<std::string, ModelPart> parts_;  // that were needed so far
  std::map<std::string, ObjectRoles> roles_;
  std::set<std::pair<std::string, std::string>> open_;  // being added, to find cycles
  int visits_ = 0;
  LeftOut3mf left_out_;
  SoupBuilder soup_;
};

}  // namespace

Parts3mf read_3mf(std::string_view bytes, const Progress& progress) {
  Archive3mf archive(bytes);
  return ModelReader(archive, progress).read();
}

}  // namespace packmerger
