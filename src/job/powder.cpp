#include "job/powder.h"

#include <fmt/format.h>

#include <set>

#include "shape/solid/pockets.h"

namespace packmerger {
namespace {

constexpr double kOpening_mm = 5;

[[noreturn]] void refuse(const std::string& what) {
  throw Error(Fault::kBadInput, what,
              fmt::format("Give every cavity two openings of {:g} mm at least, so that the powder "
                          "can be blown out, print the model solid (--variant solid, or "
                          "--no-hollow), or divided into parts (--variant packed).",
                          kOpening_mm));
}

}  // namespace

void require_openings(const WholeModels& models, const Profile& profile, const Progress& progress) {
  if (profile.technology != Technology::kPowder) return;
  std::set<const Mesh*> looked_at;  // copies share their surface
  for (const auto& model : models) {
    if (!looked_at.insert(model.get()).second) continue;
    const std::size_t keeping = keeping_cavities(*model, kOpening_mm, progress);
    if (keeping > 0)
      refuse(fmt::format(
          "Powder would stay in the model: {} of its cavities {} two openings of {:g} mm", keeping,
          keeping == 1 ? "has no" : "have no", kOpening_mm));
  }
}

void require_no_sealed_cavity(const Arrangement& arrangement, const Profile& profile) {
  if (profile.technology != Technology::kPowder) return;
  for (const JobPart& part : arrangement.parts)
    if (sealed_cavities(part.surface) > 0)
      refuse(fmt::format("Powder would stay in part {}: a cavity of it has no opening", part.id));
}

}  // namespace packmerger
