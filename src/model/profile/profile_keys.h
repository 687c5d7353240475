// The keys of a printer profile, each named once: reader, --set, writer and documentation all walk
// this list, and so does job.json. Everyone else includes model/printer.h.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "model/printer.h"

namespace packmerger {

// What a number may be. Neither end may be infinite.
struct Limits {
  double least = 0;
  double most = 0;
  bool open_below = false;  // least itself is not allowed
};

// What a text may be; words completes "expected text: …".
struct TextForm {
  std::string words;
  bool (*accepts)(std::string_view text) = nullptr;  // nullptr: any text
};

struct NumberKey {
  double* value;
  Limits limits;
};
struct IntegerKey {
  int* value;
  Limits limits;
};
struct TextKey {
  std::string* value;
  TextForm form;
};
struct ChoiceKey {
  std::vector<std::string> names;
  std::function<std::size_t()> get;
  std::function<void(std::size_t)> set;
};
struct Numbers3Key {
  std::array<double, 3>* value;
  Limits limits;
};
struct PolygonKey {
  Polygon* value;
};
struct PolygonsKey {
  std::vector<Polygon>* value;
};
struct TextsKey {
  std::vector<std::string>* value;
  TextForm form;
};
struct TextTableKey {
  std::map<std::string, std::string>* value;
  TextForm form;  // of each value
};

struct Key {
  std::string name;  // "gap_mm", "polyjet.swath_s"
  std::variant<NumberKey, IntegerKey, TextKey, ChoiceKey, Numbers3Key, PolygonKey, PolygonsKey,
               TextsKey, TextTableKey>
      kind;
  std::string unit;     // may be empty
  std::string meaning;  // one sentence
  bool required = false;
};

// Every key, bound to the members of profile, top-level keys first and each table in one piece.
std::vector<Key> keys_of(Profile& profile);

// A value as it was read, before anyone knows whether the key takes it.
using RawValue =
    std::variant<std::int64_t, double, std::string, std::vector<double>, std::vector<std::string>,
                 Polygon, std::vector<Polygon>, std::map<std::string, std::string>>;

// Sets the key when the value has its type and lies in its range; otherwise changes nothing and
// returns false. A table of texts is added to, entry by entry: so a profile changes its base's.
bool assign(const Key& key, const RawValue& value);

// "a number from 0 to 50 (mm)": what assign() takes.
std::string expected(const Key& key);

std::string type_name(const Key& key);
std::string toml_value(const Key& key);  // what the key holds now; a table of texts: its lines
std::string range_text(const Key& key);  // may be empty

// What is missing for this profile's technology and dialect: "polyjet.layer_s must be above 0 …",
// or empty.
std::string missing_for_abilities(const Profile& profile);

bool is_utf8_text(std::string_view text);   // no control characters but tab and line ends
bool is_profile_id(std::string_view text);  // letters, digits, "-", "_" and "."

}  // namespace packmerger
