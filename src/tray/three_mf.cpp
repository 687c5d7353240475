#include "tray/three_mf.h"

#include <fmt/format.h>
#include <zip.h>

#include <cmath>
#include <iterator>
#include <memory>

#include "base/error.h"
#include "model/stl.h"

namespace packmerger {
namespace {

constexpr char kContentTypes[] =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
 <Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
 <Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
)";

constexpr char kRelationships[] =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
 <Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>
)";

using Out = fmt::memory_buffer;

template <typename... Arguments>
void print(Out& out, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  fmt::format_to(std::back_inserter(out), format, std::forward<Arguments>(arguments)...);
}

int byte_of(float channel) { return static_cast<int>(std::lround(channel * 255)); }

// Resource 1 holds the colours; the object of part i (from 0) is resource i + 2.
void print_materials(Out& out, const std::vector<ThreeMfPart>& parts) {
  print(out, "  <basematerials id=\"1\">\n");
  for (const ThreeMfPart& part : parts)
    print(out, "   <base name=\"{}\" displaycolor=\"#{:02X}{:02X}{:02X}\"/>\n", part.name,
          byte_of(part.colour.red), byte_of(part.colour.green), byte_of(part.colour.blue));
  print(out, "  </basematerials>\n");
}

void print_object(Out& out, const ThreeMfPart& part, std::size_t index) {
  print(out, "  <object id=\"{}\" type=\"model\" name=\"{}\" pid=\"1\" pindex=\"{}\">\n", index + 2,
        part.name, index);
  print(out, "   <mesh>\n    <vertices>\n");
  const auto points = float_points({part.surface}).front();
  for (const Eigen::Vector3f& point : points)
    print(out, "     <vertex x=\"{}\" y=\"{}\" z=\"{}\"/>\n", point.x(), point.y(), point.z());
  print(out, "    </vertices>\n    <triangles>\n");
  for (const auto& [a, b, c] : part.surface->triangles())
    print(out, "     <triangle v1=\"{}\" v2=\"{}\" v3=\"{}\"/>\n", a, b, c);
  print(out, "    </triangles>\n   </mesh>\n  </object>\n");
}

// 3MF multiplies row vectors from the left: the matrix stands transposed, its last row is the
// translation.
void print_item(Out& out, const Pose& pose, std::size_t index) {
  print(out, "  <item objectid=\"{}\" transform=\"", index + 2);
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 3; ++row)
      print(out, "{}{:.12g}", column + row == 0 ? "" : " ", pose(row, column) + 0.0);
  print(out, "\"/>\n");
}

std::string model_xml(const std::vector<ThreeMfPart>& parts) {
  Out out;
  print(out,
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<model unit=\"millimeter\" xml:lang=\"en-US\" "
        "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n"
        " <metadata name=\"Application\">PackMerger</metadata>\n <resources>\n");
  print_materials(out, parts);
  for (std::size_t i = 0; i < parts.size(); ++i) print_object(out, parts[i], i);
  print(out, " </resources>\n <build>\n");
  for (std::size_t i = 0; i < parts.size(); ++i) print_item(out, parts[i].pose, i);
  print(out, " </build>\n</model>\n");
  return fmt::to_string(out);
}

[[noreturn]] void no_archive() {
  throw Error(Fault::kInternal, "The 3MF archive could not be made",
              "Please report this together with the model.");
}

struct Discard {
  void operator()(zip_t* archive) const { zip_discard(archive); }
};
struct Release {
  void operator()(zip_source_t* source) const { zip_source_free(source); }
};

// text must outlive the archive's closing.
void add_entry(zip_t* archive, const char* name, std::string_view text) {
  // Any fixed time will do: the same parts must give the same bytes. 1 January 2020, midnight.
  constexpr zip_uint16_t kDosDate = (2020 - 1980) << 9 | 1 << 5 | 1;
  zip_source_t* source = zip_source_buffer(archive, text.data(), text.size(), 0);
  if (source == nullptr) no_archive();
  const zip_int64_t index = zip_file_add(archive, name, source, ZIP_FL_ENC_UTF_8);
  if (index < 0) {
    zip_source_free(source);
    no_archive();
  }
  const auto entry = static_cast<zip_uint64_t>(index);
  if (zip_file_set_dostime(archive, entry, 0, kDosDate, 0) != 0) no_archive();
}

std::string bytes_of(zip_source_t* source) {
  zip_stat_t stat;
  zip_stat_init(&stat);
  if (zip_source_stat(source, &stat) != 0 || zip_source_open(source) != 0) no_archive();
  std::string bytes(stat.size, '\0');
  const zip_int64_t got = zip_source_read(source, bytes.data(), bytes.size());
  zip_source_close(source);
  if (got != static_cast<zip_int64_t>(bytes.size())) no_archive();
  return bytes;
}

}  // namespace

std::string three_mf_bytes(const std::vector<ThreeMfPart>& parts) {
  const std::string model = model_xml(parts);
  const std::unique_ptr<zip_source_t, Release> buffer(
      zip_source_buffer_create(nullptr, 0, 0, nullptr));
  if (!buffer) no_archive();
  std::unique_ptr<zip_t, Discard> archive(
      zip_open_from_source(buffer.get(), ZIP_CREATE | ZIP_TRUNCATE, nullptr));
  if (!archive) no_archive();
  zip_source_keep(buffer.get());  // the archive gives up its own share when it is closed
  add_entry(archive.get(), "[Content_Types].xml", kContentTypes);
  add_entry(archive.get(), "_rels/.rels", kRelationships);
  add_entry(archive.get(), "3D/3dmodel.model", model);
  if (zip_close(archive.get()) != 0) no_archive();
  static_cast<void>(archive.release());  // closed and freed
  return bytes_of(buffer.get());
}

}  // namespace packmerger
