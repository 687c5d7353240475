#include "cli/stated_prints.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/files.h"
#include "base/time/read_duration.h"

namespace packmerger::cli {
namespace {

constexpr std::uint64_t kMaxTableBytes = 16 << 20;
constexpr double kCm3OfIn3 = 16.387064;

// A number above 0 and the word behind it.
struct Measured {
  double value = 0;
  std::string unit;
};

std::optional<Measured> measured(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || !std::isfinite(value) || !(value > 0)) return std::nullopt;
  std::string_view unit(end, static_cast<std::size_t>(text.data() + text.size() - end));
  unit.remove_prefix(std::min(unit.find_first_not_of(' '), unit.size()));
  return Measured{value, std::string(unit)};
}

std::optional<double> grams(std::string_view text, double density_g_cm3) {
  const auto mass = measured(text);
  if (!mass) return std::nullopt;
  if (mass->unit.empty() || mass->unit == "g") return mass->value;
  if (mass->unit == "kg") return 1000 * mass->value;
  if (mass->unit == "cm3" || mass->unit == "cm³" || mass->unit == "ml")
    return mass->value * density_g_cm3;
  if (mass->unit == "in3" || mass->unit == "in³") return mass->value * kCm3OfIn3 * density_g_cm3;
  return std::nullopt;
}

std::optional<double> plain_number(std::string_view text, std::string_view unit) {
  const auto number = measured(text);
  if (!number || !(number->unit.empty() || number->unit == unit)) return std::nullopt;
  return number->value;
}

std::string trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(" \t\r") - first + 1));
}

// Fields may stand in quotes, with quotes doubled inside.
std::vector<std::string> fields_of(std::string_view line, char separator) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"')
      fields.back() += line[++i];
    else if (c == '"')
      quoted = !quoted;
    else if (c == separator && !quoted)
      fields.emplace_back();
    else
      fields.back() += c;
  }
  for (std::string& field : fields) field = trimmed(field);
  return fields;
}

[[noreturn]] void refuse_line(const std::filesystem::path& file, std::size_t line,
                              const std::string& what) {
  throw Error(Fault::kBadInput, fmt::format("{}:{}: {}", file.string(), line, what),
              "The first line names the columns, print,took,model,support,size,scale,tray or some "
              "of them; docs/ESTIMATES.md has an example.");
}

class Table {
 public:
  Table(const std::filesystem::path& file, const Profile& profile)
      : file_(file), profile_(profile) {}

  std::vector<StatedPrint> read() {
    const std::string bytes = read_file(file_, kMaxTableBytes);
    std::string_view rest = bytes;
    if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);
    for (std::size_t number = 1; !rest.empty(); ++number) {
      const std::size_t end = std::min(rest.find('\n'), rest.size());
      const std::string line = trimmed(rest.substr(0, end));
      rest.remove_prefix(std::min(end + 1, rest.size()));
      if (line.empty() || line[0] == '#') continue;
      columns_.empty() ? take_head(line, number) : take_print(line, number);
    }
    if (prints_.empty()) refuse_line(file_, 1, "there is no print in it");
    return std::move(prints_);
  }

 private:
  void take_head(const std::string& line, std::size_t number) {
    separator_ = line.find(';') == std::string::npos ? ',' : ';';
    columns_ = fields_of(line, separator_);
    const std::vector<std::string>& known = stated_fields();
    for (const std::string& column : columns_)
      if (column != "print" && std::find(known.begin(), known.end(), column) == known.end())
        refuse_line(file_, number, fmt::format("there is no column \"{}\"", column));
    if (std::count(columns_.begin(), columns_.end(), "print") != 1)
      refuse_line(file_, number, "one column must be named print");
  }

  void take_print(const std::string& line, std::size_t number) {
    const std::vector<std::string> fields = fields_of(line, separator_);
    if (fields.size() > columns_.size())
      refuse_line(
          file_, number,
          fmt::format("{} fields where the first line names {}", fields.size(), columns_.size()));
    StatedPrint print;
    for (std::size_t i = 0; i < fields.size(); ++i) {
      if (fields[i].empty()) continue;
      if (columns_[i] == "print") {
        print.name = fields[i];
        print.path = file_.parent_path() / fields[i];
      } else {
        state(print, columns_[i], fields[i], profile_, Fault::kBadInput,
              fmt::format("{}:{}: {}", file_.string(), number, columns_[i]));
      }
    }
    if (print.name.empty()) refuse_line(file_, number, "it names no print");
    prints_.push_back(std::move(print));
  }

  const std::filesystem::path file_;
  const Profile& profile_;
  char separator_ = ',';
  std::vector<std::string> columns_;
  std::vector<StatedPrint> prints_;
};

}  // namespace

const std::vector<std::string>& stated_fields() {
  static const std::vector<std::string> kFields = {"took", "model", "support",
                                                   "size", "scale", "tray"};
  return kFields;
}

void state(StatedPrint& print, const std::string& field, const std::string& text,
           const Profile& profile, Fault fault, const std::string& where) {
  const auto kept = [&](std::optional<double> value, const char* what, const char* hint) {
    if (!value) throw Error(fault, fmt::format("{}: \"{}\" is no {}", where, text, what), hint);
    return *value;
  };
  const char* const mass_hint = "Write it as 120g, 0.12kg, 60.6cm3 or 3.7in3.";
  if (field == "took") {
    print.time_s = kept(read_duration(text), "duration",
                        "Write it as 6h23m, 6:23:00, 383min or 1.5h, pauses left out.");
  } else if (field == "model") {
    print.model_g =
        kept(grams(text, profile.material.model_density_g_cm3), "mass or volume", mass_hint);
  } else if (field == "support") {
    print.support_g = kept(grams(text, profile.material.support_density_g_cm3), "mass or volume",
                           "Write it as 110g, 0.11kg, 60.6cm3 or 3.7in3, and leave it out where "
                           "there was none.");
  } else if (field == "size") {
    print.size_mm = kept(plain_number(text, "mm"), "length", "Write it in mm, as 80 or 80mm.");
  } else if (field == "scale") {
    print.scale = kept(plain_number(text, ""), "factor", "Write a number above 0, as 25.4.");
  } else {
    const double tray = kept(plain_number(text, ""), "tray", "Trays are counted from 1.");
    if (tray != std::floor(tray) || tray > 10000) kept({}, "tray", "Trays are counted from 1.");
    print.tray = static_cast<int>(tray);
  }
}

std::vector<StatedPrint> read_stated_prints(const std::filesystem::path& file,
                                            const Profile& profile) {
  return Table(file, profile).read();
}

}  // namespace packmerger::cli
