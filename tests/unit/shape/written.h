// Model files written byte by byte, apart from the project's own writers.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <zip.h>

#include "model/mesh.h"

namespace packmerger::written {

template <typename T>
void put(std::string& bytes, T value, bool big_endian = false) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  for (std::size_t i = 0; i < sizeof(T); ++i) bytes += raw[big_endian ? sizeof(T) - 1 - i : i];
}

inline std::string binary_stl(const TriangleSoup& soup, std::string header = "solid") {
  header.resize(80, ' ');
  std::string bytes = header;
  put(bytes, static_cast<std::uint32_t>(soup.triangles.size()));
  for (const auto& triangle : soup.triangles) {
    for (int i = 0; i < 3; ++i) put(bytes, 0.0F);
    for (const int corner : triangle)
      for (int i = 0; i < 3; ++i) put(bytes, static_cast<float>(soup.points[corner][i]));
    put(bytes, std::uint16_t{0});
  }
  return bytes;
}

inline std::string ascii_stl(const TriangleSoup& soup, const std::string& name,
                             const char* end = "\n") {
  std::ostringstream out;
  out.precision(17);
  out << "solid " << name << end;
  for (const auto& triangle : soup.triangles) {
    out << "  facet normal 0 0 0" << end << "    outer loop" << end;
    for (const int corner : triangle)
      out << "      vertex " << soup.points[corner].transpose() << end;
    out << "    endloop" << end << "  endfacet" << end;
  }
  out << "endsolid " << name << end;
  return out.str();
}

inline std::string obj(const TriangleSoup& soup) {
  std::ostringstream out;
  out.precision(17);
  out << "# a comment\nmtllib nothing.mtl\no thing\n";
  for (const Vec3& point : soup.points) out << "v " << point.transpose() << "\n";
  out << "vn 0 0 1\nvt 0 0\n";
  for (const auto& [a, b, c] : soup.triangles)
    out << "f " << a + 1 << "/1/1 " << b + 1 << "//1 " << c + 1 << "\n";
  return out.str();
}

inline std::string off(const TriangleSoup& soup) {
  std::ostringstream out;
  out.precision(17);
  out << "OFF\n# a comment\n" << soup.points.size() << " " << soup.triangles.size() << " 0\n\n";
  for (const Vec3& point : soup.points) out << point.transpose() << "\n";
  for (const auto& [a, b, c] : soup.triangles)
    out << "3 " << a << " " << b << " " << c << "  255 0 0\n";
  return out.str();
}

enum class PlyCoding { kAscii, kLittle, kBig };

inline std::string ply(const TriangleSoup& soup, PlyCoding coding) {
  const char* names[] = {"ascii", "binary_little_endian", "binary_big_endian"};
  std::ostringstream out;
  out.precision(17);
  out << "ply\nformat " << names[static_cast<int>(coding)] << " 1.0\ncomment made by hand\n"
      << "element vertex " << soup.points.size()
      << "\nproperty double x\nproperty double y\nproperty double z\nproperty uchar red\n"
      << "element face " << soup.triangles.size()
      << "\nproperty float quality\nproperty list uchar int vertex_indices\nend_header\n";
  if (coding == PlyCoding::kAscii) {
    for (const Vec3& point : soup.points) out << point.transpose() << " 7\n";
    for (const auto& [a, b, c] : soup.triangles)
      out << "0.5 3 " << a << " " << b << " " << c << "\n";
    return out.str();
  }
  std::string bytes = out.str();
  const bool big = coding == PlyCoding::kBig;
  for (const Vec3& point : soup.points) {
    for (int i = 0; i < 3; ++i) put(bytes, point[i], big);
    put(bytes, std::uint8_t{7});
  }
  for (const auto& triangle : soup.triangles) {
    put(bytes, 0.5F, big);
    put(bytes, std::uint8_t{3});
    for (const int corner : triangle) put(bytes, static_cast<std::int32_t>(corner), big);
  }
  return bytes;
}

// A ZIP archive of the named entries.
inline std::string zipped(const std::vector<std::pair<std::string, std::string>>& entries) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* target = zip_source_buffer_create(nullptr, 0, 0, &error);
  zip_source_keep(target);
  zip_t* zip = zip_open_from_source(target, ZIP_TRUNCATE, &error);
  for (const auto& [name, content] : entries) {
    zip_source_t* source = zip_source_buffer(zip, content.data(), content.size(), 0);
    zip_file_add(zip, name.c_str(), source, ZIP_FL_ENC_UTF_8);
  }
  zip_close(zip);
  zip_source_open(target);
  zip_source_seek(target, 0, SEEK_END);
  std::string bytes(static_cast<std::size_t>(zip_source_tell(target)), '\0');
  zip_source_seek(target, 0, SEEK_SET);
  zip_source_read(target, bytes.data(), bytes.size());
  zip_source_close(target);
  zip_source_free(target);
  zip_error_fini(&error);
  return bytes;
}

inline std::string mesh_xml(const TriangleSoup& soup) {
  std::ostringstream out;
  out.precision(17);
  out << "<mesh><vertices>";
  for (const Vec3& p : soup.points)
    out << "<vertex x=\"" << p.x() << "\" y=\"" << p.y() << "\" z=\"" << p.z() << "\"/>";
  out << "</vertices><triangles>";
  for (const auto& [a, b, c] : soup.triangles)
    out << "<triangle v1=\"" << a << "\" v2=\"" << b << "\" v3=\"" << c << "\"/>";
  out << "</triangles></mesh>";
  return out.str();
}

// attributes: of <model>; resources, build: their inner XML.
inline std::string three_mf(const std::string& attributes, const std::string& resources,
                            const std::string& build,
                            const std::string& part = "3D/3dmodel.model") {
  return zipped(
      {{"[Content_Types].xml", "<Types/>"},
       {"_rels/.rels",
        "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">"
        "<Relationship Id=\"r\" Target=\"/" +
            part +
            "\" Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/>"
            "</Relationships>"},
       {part,
        "<?xml version=\"1.0\"?><model "
        "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" " +
            attributes + "><resources>" + resources + "</resources><build>" + build +
            "</build></model>"}});
}

inline std::string simple_three_mf(const TriangleSoup& soup) {
  return three_mf("unit=\"millimeter\"", "<object id=\"1\">" + mesh_xml(soup) + "</object>",
                  "<item objectid=\"1\"/>");
}

}  // namespace packmerger::written
