// Finished prints as people state them to `calibrate`: options in groups, or the lines of a file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "model/printer.h"

namespace packmerger::cli {

struct StatedPrint {
  std::string name;            // as it was given, for messages and tables
  std::filesystem::path path;  // a job folder or a model file
  std::optional<double> time_s;
  std::optional<double> model_g;
  std::optional<double> support_g;
  std::optional<double> size_mm;  // of a model file: its longest side
  double scale = 1;               // of a model file; instead of size_mm
  std::optional<int> tray;        // of a job folder: that tray alone
};

// What a print may be told of besides its path: "took", "model", "support", "size", "scale",
// "tray". They are the options' names and the file's columns.
const std::vector<std::string>& stated_fields();

// Fills one of them. Volumes (60.6cm3, 3.7in3) become masses by the profile's densities. where:
// "--took" or "prints.csv:3: took", which begins the message. Throws Error{fault}.
void state(StatedPrint& print, const std::string& field, const std::string& text,
           const Profile& profile, Fault fault, const std::string& where);

// A table of comma or semicolon separated values whose first line names the columns, `print` among
// them; empty fields are not stated, lines that begin with # are passed over, paths are taken from
// the file's folder. Throws Error{kNoInput}, Error{kBadInput} with file and line.
std::vector<StatedPrint> read_stated_prints(const std::filesystem::path& file,
                                            const Profile& profile);

}  // namespace packmerger::cli
