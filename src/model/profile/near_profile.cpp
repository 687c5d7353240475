#include "model/profile/near_profile.h"

#include <algorithm>
#include <array>
#include <cctype>

#include <fmt/format.h>

#include "base/nearest.h"

namespace packmerger {
namespace {

struct Family {
  std::string_view profile;
  std::string_view what;
  std::vector<std::string_view> words;  // in the names of its machines
};

// The last one is for whatever the others do not name.
const std::array<Family, 5> kFamilies = {{
    {"objet30",
     "for printers that harden droplets of resin (PolyJet)",
     {"objet", "polyjet", "connex", "eden", "stratasysj"}},
    {"fuse1",
     "for printers that fuse powder (SLS, MJF)",
     {"fuse", "sinter", "multijetfusion", "formiga", "eosint"}},
    {"uprint",
     "for Stratasys' printers that are handed a file",
     {"uprint", "dimension", "fortus", "stratasys", "mojo"}},
    {"replicator",
     "for MakerBot's printers and their like, which take x3g",
     {"replicator", "makerbot", "sailfish", "flashforge", "ctc", "x3g", "s3g", "thingomatic"}},
    {"marlin", "for printers that melt filament and take G-code", {""}},
}};

// "Ender-3 V2" is "ender3v2".
std::string bare(std::string_view name) {
  std::string letters;
  for (const char c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return letters;
}

bool is_of(const Family& family, std::string_view letters) {
  return std::any_of(family.words.begin(), family.words.end(), [&](std::string_view word) {
    return letters.find(word) != std::string_view::npos;
  });
}

}  // namespace

std::string near_profile(std::string_view name, const std::vector<std::string>& ids) {
  if (std::string meant = did_you_mean(name, ids); !meant.empty()) return meant;
  const std::string letters = bare(name);
  const auto family = std::find_if(kFamilies.begin(), kFamilies.end(),
                                   [&](const Family& each) { return is_of(each, letters); });
  if (std::find(ids.begin(), ids.end(), family->profile) == ids.end()) return "";
  return fmt::format(
      "The nearest is \"{0}\", {1}: --profile {0} --set build_mm=X,Y,Z takes it with your volume. ",
      family->profile, family->what);
}

}  // namespace packmerger
