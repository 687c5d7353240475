#include "shape/read/archive_3mf.h"

#include <algorithm>

#include "base/error.h"
#include "shape/read/formats.h"

namespace packmerger {
namespace {

constexpr std::uint64_t kMaxInflated = std::uint64_t{512} << 20;
constexpr double kMaxTreeBytes = 2e9;  // of the XML as trees in memory
constexpr double kNodeBytes = 72;      // of a node in pugixml's tree, with its share of a page
constexpr double kAttributeBytes = 40;

// The tree can be twenty times as large as its text.
double tree_size(std::string_view text) {
  const auto count = [&](char c) {
    return static_cast<double>(std::count(text.begin(), text.end(), c));
  };
  return kNodeBytes * count('<') + kAttributeBytes * count('=');
}

}  // namespace

Archive3mf::Archive3mf(std::string_view bytes) : zip_(bytes, kMaxInflated) {}

std::unique_ptr<XmlPart> Archive3mf::part(std::string_view name) {
  name.remove_prefix(std::min(name.find_first_not_of('/'), name.size()));
  auto text = zip_.entry(std::string(name));
  if (!text) return nullptr;
  tree_bytes_ += tree_size(*text);
  if (tree_bytes_ > kMaxTreeBytes)
    throw Error(Fault::kBadInput, "The 3MF file holds more elements than a model can need",
                "Reduce the model, or export it as binary STL.");
  auto part = std::make_unique<XmlPart>();
  part->text = std::move(*text);
  if (!part->tree.load_buffer_inplace(part->text.data(), part->text.size()))
    refuse_file("its XML is not well-formed");
  // the parser takes what follows the root for more of it
  if (part->tree.document_element().next_sibling()) refuse_file("its XML holds more than one root");
  return part;
}

std::string_view local_name(const char* name) {
  const std::string_view whole = name;
  const std::size_t colon = whole.find(':');
  return colon == whole.npos ? whole : whole.substr(colon + 1);
}

pugi::xml_node child_named(const pugi::xml_node& node, std::string_view name) {
  for (const pugi::xml_node& each : node.children())
    if (local_name(each.name()) == name) return each;
  return {};
}

}  // namespace packmerger
