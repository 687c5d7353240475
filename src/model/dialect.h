// The dialects of printers: what a printer is given. A row a dialect, in the order of the
// enumeration; how printers of a dialect are reached is its way of delivery (src/delivery/way.h).
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace packmerger {

// The language of the programs that a printer executes.
struct ProgramLanguage {
  std::string_view extension;     // of a program's file, without the dot
  std::string_view gcode_flavor;  // that PrusaSlicer writes for it; empty: as slicer.options say
  bool from_gpx;  // gpx makes it of the slicer's G-code, and reads that by its rules
};

inline constexpr ProgramLanguage kGcodeLanguage{"gcode", "", false};
inline constexpr ProgramLanguage kX3gLanguage{"x3g", "sailfish", true};

enum class Dialect { kHandoff, kGcode, kS3g, kUsb, kCount };

struct DialectRow {
  Dialect dialect;
  std::string_view name;            // as profiles have it
  std::string_view given;           // what the printer is given, in words
  const ProgramLanguage* language;  // nullptr: it is given the tray as a document
};

inline constexpr std::array<DialectRow, static_cast<std::size_t>(Dialect::kCount)> kDialects = {{
    {Dialect::kHandoff, "handoff", "a document for its maker's program", nullptr},
    {Dialect::kGcode, "gcode", "G-code", &kGcodeLanguage},
    {Dialect::kS3g, "s3g", "x3g", &kX3gLanguage},
    {Dialect::kUsb, "usb", "a document over USB (printer class)", nullptr},
}};

// Whether a table has a row for every dialect, in their order.
template <typename Table>
constexpr bool has_every_dialect(const Table& table) {
  for (std::size_t i = 0; i < table.size(); ++i)
    if (table[i].dialect != static_cast<Dialect>(i)) return false;
  return table.size() == static_cast<std::size_t>(Dialect::kCount);
}
static_assert(has_every_dialect(kDialects), "a dialect has no row");

constexpr const DialectRow& row_of(Dialect dialect) {
  return kDialects[static_cast<std::size_t>(dialect)];
}

}  // namespace packmerger
