// Whatever a printer answers and whatever a program file holds is read without harm.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "base/error.h"
#include "firmware_io/gcode/gcode.h"
#include "firmware_io/s3g/s3g.h"
#include "firmware_io/s3g/s3g_actions.h"
#include "firmware_io/usb/usb_printer.h"

namespace {

using namespace packmerger;

void s3g_replies(std::string_view bytes) {
  s3g::ReplyReader reader;
  const std::size_t half = bytes.size() / 2;
  reader.push(bytes.substr(0, half));
  while (reader.next()) {
  }
  reader.push(bytes.substr(half));
  while (const auto reply = reader.next())
    if (reply->intact && reply->payload.empty()) std::abort();  // has no code
}

template <typename Read>
void refused_or_read(const Read& read) {
  try {
    read();
  } catch (const Error& error) {
    if (error.fault() != Fault::kBadInput || error.hint().empty()) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data + 1), size - 1);
  switch (data[0] % 5) {
    case 0:
      read_gcode_reply(bytes);
      break;
    case 1:
      s3g_replies(bytes);
      break;
    case 2:
      refused_or_read([&] { check_gcode_commands(gcode_commands(bytes)); });
      break;
    case 3:
      for (const char c : read_usb_printer_id(bytes).model)
        if (c < ' ' || c > '~') std::abort();
      break;
    default:
      refused_or_read([&] {
        std::size_t sum = 0;
        for (const std::string_view action : s3g::Actions(bytes)) sum += action.size();
        if (sum != bytes.size()) std::abort();  // every byte is sent, and once
      });
  }
  return 0;
}
