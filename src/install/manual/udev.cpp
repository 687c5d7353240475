// Rules for udev.
#include <fmt/format.h>

#include "install/manual/write.h"

namespace packmerger::manual {

// The rules run after 60-serial.rules, which tells the serial number and the place of a port.
std::string udev_rules(const std::vector<Profile>& profiles) {
  std::string text =
      "# The printers that PackMerger's profiles know by their USB ids; made from the profiles.\n"
      "# Each serial port gets a name that stays: /dev/packmerger/PROFILE-SERIAL, or where the\n"
      "# device tells no serial number /dev/packmerger/PROFILE-PLACE, its place on the bus.\n"
      "ACTION==\"remove\", GOTO=\"packmerger_end\"\n"
      "SUBSYSTEM!=\"usb|tty\", GOTO=\"packmerger_end\"\n";
  for (const Profile& profile : profiles)
    for (const std::string& id : profile.link.usb_ids) {
      const std::string vendor = id.substr(0, 4);
      const std::string product = id.substr(5, 4);
      text += fmt::format(
          "\n# {0}: {1}\n"
          "SUBSYSTEM==\"usb\", ENV{{DEVTYPE}}==\"usb_device\", ATTR{{idVendor}}==\"{2}\", "
          "ATTR{{idProduct}}==\"{3}\", GROUP=\"dialout\", "
          "MODE=\"0660\", ENV{{ID_MM_DEVICE_IGNORE}}=\"1\"\n"
          "SUBSYSTEM==\"tty\", ATTRS{{idVendor}}==\"{2}\", ATTRS{{idProduct}}==\"{3}\", "
          "GROUP=\"dialout\", MODE=\"0660\", "
          "ENV{{ID_MM_DEVICE_IGNORE}}=\"1\", ENV{{ID_MM_PORT_IGNORE}}=\"1\"\n"
          "SUBSYSTEM==\"tty\", ATTRS{{idVendor}}==\"{2}\", ATTRS{{idProduct}}==\"{3}\", "
          "ENV{{ID_SERIAL_SHORT}}==\"?*\", "
          "SYMLINK+=\"packmerger/{0}-$env{{ID_SERIAL_SHORT}}\"\n"
          "SUBSYSTEM==\"tty\", ATTRS{{idVendor}}==\"{2}\", ATTRS{{idProduct}}==\"{3}\", "
          "ENV{{ID_SERIAL_SHORT}}!=\"?*\", ENV{{ID_PATH_TAG}}==\"?*\", "
          "SYMLINK+=\"packmerger/{0}-$env{{ID_PATH_TAG}}\"\n",
          profile.id, profile.name, vendor, product);
    }
  return text + "\nLABEL=\"packmerger_end\"\n";
}

}  // namespace packmerger::manual
