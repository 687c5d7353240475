#include "daemon/find_port.h"

#include <algorithm>
#include <fstream>

#include "base/error.h"

namespace packmerger {
namespace {

namespace fs = std::filesystem;

std::string first_word(const fs::path& file) {
  std::ifstream stream(file);
  std::string word;
  stream >> word;
  return word;
}

bool is_one_of(const std::string& id, const std::vector<std::string>& ids) {
  return std::find(ids.begin(), ids.end(), id) != ids.end();
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

}  // namespace

std::string usb_id_of_port(const fs::path& port, const fs::path& sys) {
  std::error_code failed;
  const fs::path device = fs::canonical(port, failed);
  const std::string name = (failed ? port : device).filename().string();
  fs::path folder = fs::canonical(sys / name / "device", failed);
  if (failed) return {};
  // the tty hangs below an interface, the interface below the device that has the ids
  for (int level = 0; level < 4 && folder.has_relative_path(); ++level) {
    const std::string vendor = first_word(folder / "idVendor");
    const std::string product = first_word(folder / "idProduct");
    if (!vendor.empty() && !product.empty()) return vendor + ":" + product;
    folder = folder.parent_path();
  }
  return {};
}

std::string find_port(const std::vector<std::string>& usb_ids, const fs::path& sys) {
  if (usb_ids.empty())
    throw Error(Fault::kUsage, "The profile does not tell how to recognise the printer",
                "Name its port with --port, for example --port /dev/ttyACM0.");
  std::vector<std::string> ports;
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(sys, failed)) {
    const std::string name = entry.path().filename().string();
    if (is_one_of(usb_id_of_port(name, sys), usb_ids)) ports.push_back("/dev/" + name);
  }
  if (ports.empty())
    throw Error(Fault::kUnavailable, "No printer with the USB id " + joined(usb_ids) + " is there",
                "Connect it and switch it on, or name its port with --port.");
  std::sort(ports.begin(), ports.end());
  if (ports.size() > 1)
    throw Error(Fault::kUsage, "Several such printers are there: " + joined(ports),
                "Choose one with --port.");
  return ports.front();
}

void check_port(const fs::path& port, const std::vector<std::string>& usb_ids,
                const fs::path& sys) {
  const std::string id = usb_id_of_port(port, sys);
  if (id.empty() || usb_ids.empty() || is_one_of(id, usb_ids)) return;
  throw Error(Fault::kUnavailable,
              "The device at " + port.string() + " is another one (USB id " + id + " instead of " +
                  joined(usb_ids) + ")",
              "Name the port of the printer that the job was prepared for.");
}

}  // namespace packmerger
