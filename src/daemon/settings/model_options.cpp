#include "daemon/settings/model_options.h"

#include <fmt/format.h>

#include <limits>

#include "base/error.h"
#include "base/files.h"
#include "job/compare/advice.h"

namespace packmerger {
namespace {

constexpr std::uint64_t kMostBytes = 64 << 10;
constexpr std::int64_t kMostCopies = 1000;
constexpr int kMostDepth = 4;  // of tables below [set]

void read_units(TableReader& reader, ModelOptions& options) {
  reader.text("units", "one of mm, cm, m, in", [&](const std::string& text) {
    options.units = text;
    return text == "mm" || text == "cm" || text == "m" || text == "in";
  });
}

void read_size(TableReader& reader, const std::string& size, ModelOptions& options) {
  reader.number(size, 0.001, 1e6, "a number above 0 to 1000000 (mm)",
                [&](double value) { options.size_mm = value; });
  reader.number("scale", 1e-6, 1e6, "a number from 0.000001 to 1000000",
                [&](double value) { options.scale = value; });
}

void read_variant(TableReader& reader, ModelOptions& options) {
  reader.text("variant", fmt::format("one of {}", fmt::join(variant_names(), ", ")),
              [&](const std::string& text) {
                options.variant = text;
                return variant_named(text).has_value();
              });
}

// As --set takes a value; nothing for what it cannot take.
std::optional<std::string> value_text(const toml::node& node) {
  if (const auto text = node.value_exact<std::string>()) return *text;
  if (const auto whole = node.value_exact<std::int64_t>()) return std::to_string(*whole);
  if (const auto number = node.value_exact<double>()) return fmt::format("{}", *number);
  const toml::array* list = node.as_array();
  if (list == nullptr) return std::nullopt;
  std::string text;
  for (const toml::node& item : *list) {
    const auto one = item.is_array() ? std::nullopt : value_text(item);
    if (!one) return std::nullopt;
    text += (text.empty() ? "" : ",") + *one;
  }
  return text;
}

// A printer's own affairs, which its settings decide.
bool is_of_the_printer(const std::string& name) {
  return name == "id" || name == "name" || name == "dialect" || name == "document" ||
         name.starts_with("link.");
}

class SetTable {
 public:
  SetTable(const fs::path& file, const Profile& profile, ModelOptions& options)
      : file_(file), profile_(profile), options_(options) {}

  void read(const toml::table& table, const std::string& prefix = {}, int depth = 1) {
    for (const auto& [key, node] : table) {
      const std::string name = prefix + std::string(key.str());
      if (node.is_table() && depth < kMostDepth)
        read(*node.as_table(), name + ".", depth + 1);
      else
        take(name, node);
    }
  }

 private:
  void take(const std::string& name, const toml::node& node) {
    const std::optional<std::string> text = value_text(node);
    if (!text || text->find('\0') != std::string::npos)
      refuse(file_, line_of(node), "set." + name + ": expected what the profile's key takes");
    if (is_of_the_printer(name))
      refuse(file_, line_of(node), "set." + name + " is the printer's, not a model's");
    options_.set.push_back(name + "=" + *text);
    try {
      set_profile_key(profile_, options_.set.back());
    } catch (const Error& error) {
      refuse(file_, line_of(node), std::string("set: ") + error.what());
    }
  }

  const fs::path& file_;
  Profile profile_;
  ModelOptions& options_;
};

void read_settings_keys(TableReader& reader, const fs::path& file, const Profile& profile,
                        ModelOptions& options) {
  read_units(reader, options);
  read_size(reader, "size", options);
  reader.integer("copies", 1, kMostCopies, "an integer from 1 to 1000",
                 [&](std::int64_t value) { options.copies = value; });
  read_variant(reader, options);
  reader.flag("no_split", [&](bool value) { options.split = !value; });
  reader.flag("no_hollow", [&](bool value) { options.hollow = !value; });
  reader.integer("seed", 0, std::numeric_limits<std::int64_t>::max(), "an integer from 0 up",
                 [&](std::int64_t value) { options.seed = value; });
  reader.number("budget", 0, 1e6, "a number from 0 to 1000000 (s)",
                [&](double value) { options.budget_s = value; });
  reader.key("set", "a table of the profile's keys", [&](const toml::node& node) {
    if (!node.is_table()) return false;
    SetTable(file, profile, options).read(*node.as_table());
    return true;
  });
  reader.done();
}

std::string text_of_settings(const fs::path& file, const fs::path& shown) {
  if (!fs::is_regular_file(fs::symlink_status(file)))
    refuse(shown, 1, "it is no file any more, or a link to one");
  try {
    return read_file(file, kMostBytes);
  } catch (const Error& error) {
    refuse(shown, 1, "it cannot be read, or is larger than 64 KiB");
  }
}

toml::table table_of(const std::string& text, const fs::path& shown) {
  try {
    return toml::parse(std::string_view(text), shown.string());
  } catch (const toml::parse_error& error) {
    refuse(shown, std::max(1, static_cast<int>(error.source().begin.line)),
           std::string(error.description()));
  }
}

template <typename Value>
void take_over(std::optional<Value>& below, const std::optional<Value>& above) {
  if (above) below = above;
}

void add(std::vector<std::string>& arguments, const char* option, const std::string& value) {
  arguments.insert(arguments.end(), {option, value});
}

}  // namespace

ModelOptions read_model_settings(const fs::path& file, const Profile& profile) {
  const fs::path shown = file.filename();
  const toml::table table = table_of(text_of_settings(file, shown), shown);
  ModelOptions options;
  TableReader reader(shown, &table, "", nullptr);
  read_settings_keys(reader, shown, profile, options);
  if (options.size_mm && options.scale)
    refuse(shown, line_of(*table.get("scale")), "there cannot be both size and scale");
  return options;
}

std::vector<DaemonKey> model_settings_keys() {
  std::vector<DaemonKey> keys;
  ModelOptions options;
  const fs::path file;
  TableReader reader(file, nullptr, "", &keys);
  read_settings_keys(reader, file, Profile{}, options);
  return keys;
}

void read_printer_options(TableReader& reader, ModelOptions& options) {
  read_units(reader, options);
  read_size(reader, "size_mm", options);
  read_variant(reader, options);
  reader.flag("split", [&](bool value) { options.split = value; });
  reader.flag("hollow", [&](bool value) { options.hollow = value; });
  reader.key("set", "a list of texts \"key=value\" that the profile takes",
             [&](const toml::node& node) {
               const toml::array* list = node.as_array();
               if (list == nullptr) return false;
               for (const toml::node& item : *list) {
                 const auto text = item.value_exact<std::string>();
                 if (!text) return false;
                 options.set.push_back(*text);
               }
               return true;
             });
}

ModelOptions laid_over(ModelOptions below, const ModelOptions& above) {
  if (above.size_mm || above.scale) below.size_mm = below.scale = std::nullopt;
  take_over(below.units, above.units);
  take_over(below.size_mm, above.size_mm);
  take_over(below.scale, above.scale);
  take_over(below.copies, above.copies);
  take_over(below.variant, above.variant);
  take_over(below.split, above.split);
  take_over(below.hollow, above.hollow);
  take_over(below.seed, above.seed);
  take_over(below.budget_s, above.budget_s);
  below.set.insert(below.set.end(), above.set.begin(), above.set.end());
  return below;
}

std::vector<std::string> arguments_of(const ModelOptions& options) {
  std::vector<std::string> arguments;
  if (options.seed) add(arguments, "--seed", std::to_string(*options.seed));
  if (options.budget_s) add(arguments, "--budget", fmt::format("{}", *options.budget_s));
  if (options.units) add(arguments, "--units", *options.units);
  if (options.size_mm) add(arguments, "--size", fmt::format("{}", *options.size_mm));
  if (options.scale) add(arguments, "--scale", fmt::format("{}", *options.scale));
  if (options.copies) add(arguments, "--copies", std::to_string(*options.copies));
  if (options.variant) add(arguments, "--variant", *options.variant);
  if (options.split == false) arguments.emplace_back("--no-split");
  if (options.hollow == false) arguments.emplace_back("--no-hollow");
  const std::vector<std::string> set = profile_arguments_of(options);
  arguments.insert(arguments.end(), set.begin(), set.end());
  return arguments;
}

std::vector<std::string> profile_arguments_of(const ModelOptions& options) {
  std::vector<std::string> arguments;
  for (const std::string& assignment : options.set) add(arguments, "--set", assignment);
  return arguments;
}

}  // namespace packmerger
