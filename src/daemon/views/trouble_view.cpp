#include "daemon/views/trouble_view.h"

#include "base/json_values.h"

namespace packmerger {

using nlohmann::json;

json trouble_view(const std::optional<Trouble>& trouble) {
  if (!trouble) return nullptr;
  return {{"what", trouble->what},
          {"since_s", trouble->since_s},
          {"tries", trouble->tries},
          {"next_s", or_null(trouble->next_s)}};
}

json list_of(const Troubles& troubles) {
  json list = json::array();
  for (const auto& [about, trouble] : troubles) {
    list.push_back(trouble_view(trouble));
    list.back()["about"] = about;
  }
  return list;
}

std::string words_of(const Troubles& troubles) {
  std::string text;
  for (const auto& [about, trouble] : troubles) text += (text.empty() ? "" : "; ") + trouble.what;
  return text;
}

}  // namespace packmerger
