// Whatever the texts in a slicer's project say, the answer is a sound model or Error{kBadInput}.
// The input holds four texts, ended by form feeds: the root model, another one that it may name,
// and the settings in PrusaSlicer's and in Bambu Studio's way; they are packed anew, so that no
// checksum keeps them from the reader.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "fuzz/reading.h"
#include "unit/shape/written.h"

namespace {

constexpr std::array<const char*, 4> kNames = {"3D/3dmodel.model", "3D/Objects/object_1.model",
                                               "Metadata/Slic3r_PE_model.config",
                                               "Metadata/model_settings.config"};

std::string project_of(std::string_view texts) {
  std::vector<std::pair<std::string, std::string>> entries{
      {"_rels/.rels",
       "<Relationships><Relationship Target=\"/3D/3dmodel.model\" "
       "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>"}};
  for (const char* name : kNames) {
    const std::size_t end = std::min(texts.find('\f'), texts.size());
    if (end > 0) entries.emplace_back(name, texts.substr(0, end));
    texts.remove_prefix(std::min(end + 1, texts.size()));
  }
  return packmerger::written::zipped(entries);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  packmerger::fuzz::check_reading(project_of({reinterpret_cast<const char*>(data), size}), "3mf");
  return 0;
}
