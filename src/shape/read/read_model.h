// Reads a model file: STL (binary and ASCII), OBJ, PLY (ASCII and binary), OFF and 3MF (Core
// Specification 1.x of the 3MF Consortium). STL as 3D Systems, OBJ as Wavefront, PLY as Turk
// (1994) and OFF as Geomview describe them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/files.h"
#include "base/progress.h"
#include "model/mesh.h"

namespace packmerger {

constexpr std::uint64_t kMaxModelBytes = std::uint64_t{1} << 30;

struct ModelFile {
  TriangleSoup soup;      // the file's unit; mm where has_unit
  bool has_unit = false;  // 3MF declares its unit and was converted; the other formats have none
  std::string format;     // the ending of model/files/file_format.h, without its dot
  std::string left_out;   // "2 modifiers": what a 3MF holds besides matter to print; or empty
};

// The content decides the format where it can (a ZIP holding a 3D model part is 3MF; "ply" and
// "OFF" as first words; 84 + 50·n bytes are a binary STL whatever the header says; "solid" with
// facets is an ASCII STL), else the extension does. Text may be in
// UTF-8 or, of either byte order, in UTF-16; a byte order mark is passed over. Compressed files,
// and some that are no meshes are refused by name.
//
// Faces with more than three corners are cut into triangles: fans from the first corner, as in
// slicers, and ears where they are concave. Every triangle that is returned has
// indices within points and every coordinate is finite; nothing else is promised: see repair().
// 3MF: items, components and their transforms are applied, in mm; objects of type "support" and
// "other" and items that are not to be printed are left out. So are the modifiers, support blockers
// and support enforcers of PrusaSlicer's, Bambu Studio's, OrcaSlicer's and Cura's projects. Refused
// are a project with a negative volume or a mould, objects of types that are not known, and shapes
// that are told by more than meshes: beams, slices (unless the mesh is called their equal) and the
// like.
//
// Nothing in the file is trusted: counts are checked against the bytes that are there before
// memory is taken. Limits: 1 GiB a file; 512 MiB, and 200 times the archive's size, what is read of
// a 3MF once inflated; 30 million triangles after polygons are cut and components are repeated; 64
// levels of components; coordinates up to 1e9. Memory stays below 100 times the file's size (for
// 3MF, of the inflated part) plus the returned soup.
//
// bytes: what the file at path holds; errors name the file. Throws Error: kBadInput (unknown
// format, broken or truncated file, no triangles, non-finite coordinates, above a limit),
// kInterrupted.
ModelFile read_model(std::string_view bytes, const fs::path& path, const Progress& progress);

// The same for bytes without a name; extension with or without its dot, any case, may be empty.
ModelFile read_model_bytes(std::string_view bytes, std::string_view extension,
                           const Progress& progress);

}  // namespace packmerger
