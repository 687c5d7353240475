// Readers for the tests, written apart from what is tested.
#pragma once

#include <gtest/gtest.h>
#include <zip.h>
#include <pugixml.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "base/geometry.h"

namespace packmerger::read_back {

using Corner = std::array<float, 3>;
using Facet = std::array<Corner, 3>;

inline std::vector<Facet> stl_facets(const std::string& bytes) {
  std::vector<Facet> facets;
  if (bytes.size() < 84) {
    ADD_FAILURE() << "too short for an STL";
    return facets;
  }
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, 4);
  EXPECT_EQ(bytes.size(), 84 + std::size_t{50} * count);
  facets.resize(count);
  for (std::uint32_t i = 0; i < count; ++i)
    std::memcpy(&facets[i], bytes.data() + 84 + 50 * std::size_t{i} + 12, 36);
  return facets;
}

// Every directed edge between equal positions is there once, and its opposite too: closed,
// oriented, no edge with more than two sides.
inline bool is_closed(const std::vector<Facet>& facets) {
  std::map<std::pair<Corner, Corner>, int> edges;
  for (const Facet& facet : facets)
    for (int i = 0; i < 3; ++i) {
      if (facet[i] == facet[(i + 1) % 3]) return false;
      ++edges[{facet[i], facet[(i + 1) % 3]}];
    }
  return std::ranges::all_of(edges, [&](const auto& entry) {
    const auto opposite = edges.find({entry.first.second, entry.first.first});
    return entry.second == 1 && opposite != edges.end() && opposite->second == 1;
  });
}

inline double volume(const std::vector<Facet>& facets) {
  double six = 0;
  for (const Facet& facet : facets) {
    const auto at = [&](int i) { return Vec3(facet[i][0], facet[i][1], facet[i][2]); };
    six += at(0).dot(at(1).cross(at(2)));
  }
  return six / 6;
}

inline std::map<std::string, std::string> zip_entries(const std::string& bytes) {
  std::map<std::string, std::string> entries;
  zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, nullptr);
  zip_t* archive = zip_open_from_source(source, ZIP_RDONLY | ZIP_CHECKCONS, nullptr);
  if (archive == nullptr) {
    ADD_FAILURE() << "not a zip archive";
    zip_source_free(source);
    return entries;
  }
  for (zip_int64_t i = 0; i < zip_get_num_entries(archive, 0); ++i) {
    zip_stat_t stat;
    zip_stat_index(archive, static_cast<zip_uint64_t>(i), 0, &stat);
    std::string text(stat.size, '\0');
    zip_file_t* file = zip_fopen_index(archive, static_cast<zip_uint64_t>(i), 0);
    EXPECT_EQ(zip_fread(file, text.data(), text.size()), static_cast<zip_int64_t>(text.size()));
    zip_fclose(file);
    entries[stat.name] = text;
  }
  zip_close(archive);
  return entries;
}

struct Object3mf {
  std::vector<Vec3> points;
  std::vector<std::array<int, 3>> triangles;
  Pose pose = Pose::Identity();  // of its build item
};

inline std::vector<Object3mf> objects_3mf(const std::string& bytes) {
  std::vector<Object3mf> objects;
  const auto entries = zip_entries(bytes);
  if (!entries.contains("3D/3dmodel.model")) {
    ADD_FAILURE() << "no model part";
    return objects;
  }
  pugi::xml_document document;
  EXPECT_TRUE(document.load_string(entries.at("3D/3dmodel.model").c_str()));
  const pugi::xml_node model = document.child("model");
  EXPECT_STREQ(model.attribute("unit").value(), "millimeter");
  std::map<std::string, pugi::xml_node> by_id;
  for (const pugi::xml_node node : model.child("resources").children("object")) {
    EXPECT_FALSE(by_id.contains(node.attribute("id").value()));
    by_id[node.attribute("id").value()] = node;
  }
  for (const pugi::xml_node item : model.child("build").children("item")) {
    Object3mf object;
    std::istringstream numbers(item.attribute("transform").value());
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 3; ++row) numbers >> object.pose.matrix()(row, column);
    EXPECT_TRUE(numbers);
    const pugi::xml_node mesh = by_id.at(item.attribute("objectid").value()).child("mesh");
    for (const pugi::xml_node v : mesh.child("vertices").children("vertex"))
      object.points.emplace_back(v.attribute("x").as_double(), v.attribute("y").as_double(),
                                 v.attribute("z").as_double());
    for (const pugi::xml_node t : mesh.child("triangles").children("triangle"))
      object.triangles.push_back({t.attribute("v1").as_int(-1), t.attribute("v2").as_int(-1),
                                  t.attribute("v3").as_int(-1)});
    objects.push_back(object);
  }
  EXPECT_EQ(objects.size(), by_id.size());
  return objects;
}

}  // namespace packmerger::read_back
