#include "firmware_io/ports/devices.h"

#include <libserialport.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <utility>

#include "base/error.h"
#include "firmware_io/ports/usb_library.h"

namespace packmerger {

namespace {

namespace fs = std::filesystem;

// A device on its bus, as both libraries count it.
using BusAddress = std::pair<int, int>;

std::string text(const char* value) { return value == nullptr ? "" : value; }

std::string usb_id(int vendor, int product) {
  std::array<char, 10> id;
  std::snprintf(id.data(), id.size(), "%04x:%04x", vendor & 0xffff, product & 0xffff);
  return id.data();
}

std::string first_line(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  return line;
}

bool may_write(const std::string& file) { return ::access(file.c_str(), R_OK | W_OK) == 0; }

std::string link_to(const std::string& port) {
  std::error_code failed;
  for (const fs::directory_entry& link : fs::directory_iterator("/dev/serial/by-id", failed))
    if (is_same_device(link.path(), port)) return link.path();
  return {};
}

std::string driver_of(const std::string& port) {
  std::error_code failed;
  const fs::path name = fs::path(port).filename();
  return fs::read_symlink("/sys/class/tty" / name / "device/driver", failed).filename();
}

SerialDevice described(const sp_port* port, std::set<BusAddress>& on_usb) {
  SerialDevice device;
  device.port = text(sp_get_port_name(port));
  device.link = link_to(device.port);
  device.driver = driver_of(device.port);
  device.may_open = may_write(device.port);
  if (sp_get_port_transport(port) != SP_TRANSPORT_USB) return device;
  int vendor = 0;
  int product = 0;
  if (sp_get_port_usb_vid_pid(port, &vendor, &product) == SP_OK)
    device.usb.id = usb_id(vendor, product);
  device.usb.serial_number = text(sp_get_port_usb_serial(port));
  device.usb.manufacturer = text(sp_get_port_usb_manufacturer(port));
  device.usb.product = text(sp_get_port_usb_product(port));
  BusAddress at;
  if (sp_get_port_usb_bus_address(port, &at.first, &at.second) == SP_OK) on_usb.insert(at);
  return device;
}

// Enters where those on USB are.
std::vector<SerialDevice> serial_devices(std::set<BusAddress>& on_usb) {
  // Without this folder, as on a machine of no terminals at all, libserialport fails.
  if (std::error_code failed; !fs::exists("/sys/class/tty", failed)) return {};
  sp_port** list = nullptr;
  if (sp_list_ports(&list) != SP_OK)
    throw Error(Fault::kIo, "The system does not tell its serial ports",
                "Check that /sys is mounted.");
  const std::unique_ptr<sp_port*, void (*)(sp_port**)> freed(list, sp_free_port_list);
  std::vector<SerialDevice> devices;
  for (sp_port** port = list; *port != nullptr; ++port) devices.push_back(described(*port, on_usb));
  std::sort(devices.begin(), devices.end(),
            [](const SerialDevice& a, const SerialDevice& b) { return a.port < b.port; });
  return devices;
}

bool has_printer_interface(libusb_device* device) {
  const usb::Configuration config = usb::configuration_of(device);
  if (!config) return false;
  for (int i = 0; i < config->bNumInterfaces; ++i)
    for (int k = 0; k < config->interface[i].num_altsetting; ++k)
      if (config->interface[i].altsetting[k].bInterfaceClass == LIBUSB_CLASS_PRINTER) return true;
  return false;
}

// The texts are Linux's: libusb would have to open the device for them.
UsbDevice described(libusb_device* device, const libusb_device_descriptor& descriptor) {
  UsbDevice found;
  found.at = usb::place_of(device);
  const fs::path folder = "/sys/bus/usb/devices/" + found.at;
  found.usb = {usb_id(descriptor.idVendor, descriptor.idProduct), first_line(folder / "serial"),
               first_line(folder / "manufacturer"), first_line(folder / "product")};
  found.is_printer = has_printer_interface(device);
  std::array<char, 32> node;
  std::snprintf(node.data(), node.size(), "/dev/bus/usb/%03d/%03d", libusb_get_bus_number(device),
                libusb_get_device_address(device));
  found.may_open = may_write(node.data());
  return found;
}

std::vector<UsbDevice> usb_devices(const std::set<BusAddress>& serial_ports) {
  const usb::Context context = usb::open_context();
  std::vector<UsbDevice> devices;
  for (const usb::Device& device : usb::devices_of(context.get())) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(device.get(), &descriptor) != 0) continue;
    if (descriptor.bDeviceClass == LIBUSB_CLASS_HUB) continue;
    if (serial_ports.contains(
            {libusb_get_bus_number(device.get()), libusb_get_device_address(device.get())}))
      continue;
    devices.push_back(described(device.get(), descriptor));
  }
  std::sort(devices.begin(), devices.end(),
            [](const UsbDevice& a, const UsbDevice& b) { return a.at < b.at; });
  return devices;
}

}  // namespace

// std::filesystem::equivalent refuses devices.
bool is_same_device(const std::string& a, const std::string& b) {
  struct stat one {};
  struct stat other {};
  return ::stat(a.c_str(), &one) == 0 && ::stat(b.c_str(), &other) == 0 &&
         one.st_dev == other.st_dev && one.st_ino == other.st_ino;
}

std::vector<SerialDevice> connected_serial_ports() {
  std::set<BusAddress> on_usb;
  return serial_devices(on_usb);
}

Devices connected_devices() {
  Devices devices;
  std::set<BusAddress> on_usb;
  devices.serial = serial_devices(on_usb);
  devices.usb = usb_devices(on_usb);
  return devices;
}

}  // namespace packmerger
