#include "delivery/job_file.h"

#include <algorithm>

#include "base/error.h"
#include "base/names.h"
#include "model/files/file_format.h"

namespace packmerger {
namespace {

constexpr std::size_t kLongestName = 200;

}  // namespace

std::string what_is_taken() {
  return "Send a model (" + model_format_names() + ") or a program (" + program_format_names() +
         ").";
}

std::string job_file_name(std::string_view given) {
  std::string name =
      last_bytes(printable(given.substr(given.find_last_of("/\\") + 1), '_'), kLongestName);
  name.erase(0, std::min(name.find_first_not_of(". ~"), name.size()));
  if (kind_of_file(name) == FileKind::kUnknown)
    throw Error(Fault::kBadInput, kNotTaken, what_is_taken());
  return name;
}

}  // namespace packmerger
