#include "firmware_io/usb/usb_printer.h"

#include <algorithm>
#include <cctype>

namespace packmerger {

namespace {

constexpr std::size_t kLengthBytes = 2;

std::string trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first == text.npos) return {};
  const auto last = text.find_last_not_of(" \t\r\n");
  std::string result(text.substr(first, last - first + 1));
  for (char& c : result)
    if (c < ' ' || c > '~') c = '?';
  return result;
}

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return result;
}

std::string_view text_of(std::string_view answer) {
  if (answer.size() <= kLengthBytes) return {};
  const std::size_t length = static_cast<unsigned char>(answer[0]) * std::size_t{256} +
                             static_cast<unsigned char>(answer[1]);
  const bool plausible = length > kLengthBytes && length <= answer.size();
  answer = answer.substr(0, plausible ? length : answer.size()).substr(kLengthBytes);
  return answer.substr(0, answer.find('\0'));
}

}  // namespace

UsbPrinterId read_usb_printer_id(std::string_view answer) {
  UsbPrinterId id;
  std::string_view text = text_of(answer);
  while (!text.empty()) {
    const std::string_view field = text.substr(0, text.find(';'));
    text.remove_prefix(std::min(text.size(), field.size() + 1));
    const auto colon = field.find(':');
    if (colon == field.npos) continue;
    const std::string key = upper(trimmed(field.substr(0, colon)));
    const std::string value = trimmed(field.substr(colon + 1));
    if (key == "MFG" || key == "MANUFACTURER") id.manufacturer = value;
    if (key == "MDL" || key == "MODEL") id.model = value;
    if (key == "CMD" || key == "COMMAND SET") id.commands = value;
  }
  return id;
}

UsbPrinterStatus read_usb_printer_status(std::uint8_t answer) {
  constexpr unsigned kPaperEmpty = 1U << 5U;
  constexpr unsigned kSelect = 1U << 4U;
  constexpr unsigned kNotError = 1U << 3U;
  return {(answer & kPaperEmpty) != 0, (answer & kSelect) != 0, (answer & kNotError) == 0};
}

std::string trouble_of(const UsbPrinterStatus& status) {
  if (status.paper_empty) return "it is out of paper or material";
  if (status.error) return "it reports an error";
  if (!status.selected) return "it is not on line";
  return {};
}

}  // namespace packmerger
