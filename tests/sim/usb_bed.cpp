#include "sim/usb_bed.h"

#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>

namespace packmerger::test {

namespace {

constexpr std::uint8_t kOut = 0x02;
constexpr std::uint8_t kIn = 0x81;
constexpr std::size_t kSetupBytes = 8;

std::string numbered(const char* format, int number) {
  std::array<char, 64> text;
  std::snprintf(text.data(), text.size(), format, number);
  return text.data();
}

std::string little_endian(int value) {
  return {static_cast<char>(value & 0xFF), static_cast<char>(value >> 8 & 0xFF)};
}

std::string descriptors(const UsbPrinterTraits& traits) {
  std::string device("\x12\x01\x00\x02\x00\x00\x00\x40", 8);
  device += little_endian(traits.vendor) + little_endian(traits.product);
  device += std::string("\x00\x01\x01\x02\x03\x01", 6);
  std::string interface("\x09\x04\x00\x00\x02", 5);
  interface += static_cast<char>(traits.interface_class);
  interface += '\x01';
  interface += static_cast<char>(traits.protocol);
  interface += '\x00';
  std::string endpoints;
  for (const std::uint8_t address : {kOut, kIn}) {
    endpoints += std::string("\x07\x05", 2) + static_cast<char>(address);
    endpoints += std::string("\x02\x40\x00\x00", 4);
  }
  std::string configuration("\x09\x02", 2);
  configuration += little_endian(static_cast<int>(9 + interface.size() + endpoints.size()));
  configuration += std::string("\x01\x01\x00\xC0\x00", 5);
  return device + configuration + interface + endpoints;
}

std::string upper_hex(const std::string& bytes) {
  std::string text;
  for (const char c : bytes) text += numbered("%02X", static_cast<unsigned char>(c));
  return text;
}

template <typename T>
T read_as(UMockdevIoctlData* data) {
  T value;
  std::memcpy(&value, data->data, sizeof value);
  return value;
}

template <typename T>
void put(UMockdevIoctlData* data, std::size_t offset, const T& value) {
  std::array<guint8, sizeof value> bytes;
  std::memcpy(bytes.data(), &value, sizeof value);
  umockdev_ioctl_data_update(data, offset, bytes.data(), static_cast<gint>(bytes.size()));
}

// What the request's argument points at.
GObjectPointer<UMockdevIoctlData> pointed(UMockdevIoctlData* data, std::size_t offset,
                                          std::size_t size) {
  UMockdevIoctlData* found = umockdev_ioctl_data_resolve(data, offset, size, nullptr);
  if (found == nullptr) throw std::runtime_error("umockdev reads no memory of its client");
  return GObjectPointer<UMockdevIoctlData>(found);
}

}  // namespace

std::string usb_sys_path(const std::string& place) {
  return "/devices/pci0000:00/0000:00:14.0/usb1/" + place;
}

std::string usb_description(const UsbPrinterTraits& traits, int number) {
  const std::string blob = upper_hex(descriptors(traits));
  const std::string node = "bus/usb/001/" + numbered("%03d", number);
  return "P: " + usb_sys_path(traits.place) + "\nN: " + node + "=" + blob + "\nE: DEVNAME=/dev/" +
         node + "\nE: DEVTYPE=usb_device\nE: SUBSYSTEM=usb\nE: BUSNUM=001" +
         "\nE: DEVNUM=" + numbered("%03d", number) +
         "\nA: idVendor=" + numbered("%04x", traits.vendor) +
         "\nA: idProduct=" + numbered("%04x", traits.product) +
         "\nA: busnum=1\nA: devnum=" + std::to_string(number) +
         "\nA: speed=480\nA: bConfigurationValue=1\nA: serial=" + traits.serial_number +
         "\nA: product=Print bridge\nH: descriptors=" + blob + "\n\n";
}

UsbBed::UsbBed() : bed_(umockdev_testbed_new()), handler_(umockdev_ioctl_base_new()) {
  if (umockdev_in_mock_environment() == FALSE)
    throw std::runtime_error("run it under umockdev-wrapper");
  g_signal_connect(handler_.get(), "handle-ioctl", G_CALLBACK(&UsbBed::handle), this);
}

UsbBed::~UsbBed() {
  if (!node_.empty()) umockdev_testbed_detach_ioctl(bed_.get(), node_.c_str(), nullptr);
}

void UsbBed::plug(const std::string& description, const std::vector<std::string>& sys_paths) {
  if (umockdev_testbed_add_from_string(bed_.get(), description.c_str(), nullptr) == FALSE)
    throw std::runtime_error("umockdev does not take the device");
  for (const std::string& path : sys_paths)
    umockdev_testbed_uevent(bed_.get(), ("/sys" + path).c_str(), "add");
}

void UsbBed::unplug(const std::vector<std::string>& sys_paths) {
  for (const std::string& path : sys_paths) {
    umockdev_testbed_uevent(bed_.get(), ("/sys" + path).c_str(), "remove");
    umockdev_testbed_remove_device(bed_.get(), ("/sys" + path).c_str());
  }
}

void UsbBed::plug_printer(const UsbPrinterTraits& traits) {
  const int number = ++devices_ + 1;
  if (!node_.empty()) umockdev_testbed_detach_ioctl(bed_.get(), node_.c_str(), nullptr);
  {
    const std::lock_guard lock(mutex_);
    traits_ = traits;
    node_ = "/dev/bus/usb/001/" + numbered("%03d", number);
    gone_ = unplugs_ = halted_ = deaf_ = false;
    urbs_.clear();
  }
  plug(usb_description(traits, number), {usb_sys_path(traits.place)});
  if (umockdev_testbed_attach_ioctl(bed_.get(), node_.c_str(), handler_.get(), nullptr) == FALSE)
    throw std::runtime_error("umockdev does not answer for " + node_);
}

void UsbBed::unplug_printer() {
  {
    const std::lock_guard lock(mutex_);
    go();
  }
  // The handler stays: whoever has the device open goes on asking, and is told that it is gone.
  unplug({usb_sys_path(traits_.place)});
}

std::string UsbBed::received() const {
  const std::lock_guard lock(mutex_);
  return received_;
}

std::vector<std::string> UsbBed::events() const {
  const std::lock_guard lock(mutex_);
  return events_;
}

gboolean UsbBed::handle(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self) {
  const int result = static_cast<UsbBed*>(self)->answer(client);
  umockdev_ioctl_client_complete(client, result < 0 ? -1 : result, std::max(0, -result));
  return TRUE;
}

// 0, or an error number below 0.
int UsbBed::answer(UMockdevIoctlClient* client) {
  const std::lock_guard lock(mutex_);
  UMockdevIoctlData* arg = umockdev_ioctl_client_get_arg(client);
  const gulong request = umockdev_ioctl_client_get_request(client);
  if (request == USBDEVFS_REAPURB || request == USBDEVFS_REAPURBNDELAY) return reap(arg);
  if (gone_) return -ENODEV;
  switch (request) {
    case USBDEVFS_GET_CAPABILITIES:
      put(pointed(arg, 0, 4).get(), 0, std::uint32_t{USBDEVFS_CAP_BULK_CONTINUATION});
      return 0;
    case USBDEVFS_CLAIMINTERFACE:
      return claim("");
    case USBDEVFS_DISCONNECT_CLAIM:
      return claim("usblp");
    case USBDEVFS_RELEASEINTERFACE:
      note("release");
      return 0;
    case USBDEVFS_IOCTL:  // of which libusb needs one: CONNECT
      note("attach usblp");
      return 0;
    case USBDEVFS_CLEAR_HALT:
      note("clear halt");
      halted_ = false;
      return 0;
    case USBDEVFS_SUBMITURB:
      return submit(arg);
    case USBDEVFS_DISCARDURB:
      return discard(arg);
    default:
      return -ENOTTY;
  }
}

int UsbBed::claim(const std::string& driver) {
  if (traits_.busy) return -EBUSY;
  if (traits_.driver && driver.empty()) return -EBUSY;
  if (traits_.driver) note("detach " + driver);
  note("claim");
  deaf_ = false;
  return 0;
}

int UsbBed::submit(UMockdevIoctlData* arg) {
  auto urb = std::make_unique<Urb>();
  urb->data = pointed(arg, 0, sizeof(usbdevfs_urb));
  const auto told = read_as<usbdevfs_urb>(urb->data.get());
  const auto buffer = pointed(urb->data.get(), offsetof(usbdevfs_urb, buffer),
                              static_cast<std::size_t>(told.buffer_length));
  urb->ended = true;
  if (told.type == USBDEVFS_URB_TYPE_CONTROL)
    control(*urb, *buffer);
  else if (told.endpoint == kOut)
    bulk(*urb, *buffer);
  else
    urb->ended = false;  // nothing to tell
  urbs_.push_back(std::move(urb));
  if (unplugs_) go();
  return 0;
}

void UsbBed::control(Urb& urb, UMockdevIoctlData& buffer) {
  const std::uint8_t type = buffer.data[0];
  const std::uint8_t request = buffer.data[1];
  const std::size_t room = static_cast<std::size_t>(buffer.data_len) - kSetupBytes;
  std::string reply;
  if (type == 0xA1 && request == 0 && !traits_.device_id.empty()) {
    const int length = static_cast<int>(traits_.device_id.size()) + 2;
    reply = little_endian(length) + traits_.device_id;
    std::swap(reply[0], reply[1]);
  } else if (const auto status = on_status ? on_status() : std::optional(kReady);
             type == 0xA1 && request == 1 && status) {
    reply = static_cast<char>(*status);
  } else if (type == 0x21 && request == 2) {
    note("soft reset");
    deaf_ = traits_.forgets_after_reset;
  } else {
    urb.status = -EPIPE;
  }
  reply.resize(std::min(reply.size(), room));
  std::vector<guint8> bytes(reply.begin(), reply.end());
  umockdev_ioctl_data_update(&buffer, kSetupBytes, bytes.data(), static_cast<gint>(bytes.size()));
  urb.moved = bytes.size();
}

void UsbBed::bulk(Urb& urb, UMockdevIoctlData& buffer) {
  const auto offered = static_cast<std::size_t>(buffer.data_len);
  BulkAnswer answer{offered, BulkAnswer::End::kTaken};
  if (halted_)
    answer = {0, BulkAnswer::End::kStall};
  else if (deaf_)
    answer = {0, BulkAnswer::End::kSilence};
  else if (on_bulk)
    answer = on_bulk(received_.size(), offered);
  urb.moved = std::min(answer.bytes, offered);
  received_.append(reinterpret_cast<const char*>(buffer.data), urb.moved);
  halted_ = halted_ || answer.end == BulkAnswer::End::kStall;
  unplugs_ = answer.end == BulkAnswer::End::kUnplugged;
  if (halted_) urb.status = -EPIPE;
  urb.ended = answer.end != BulkAnswer::End::kSilence && answer.end != BulkAnswer::End::kUnplugged;
}

// As the kernel does: what is under way ends, and can still be reaped.
void UsbBed::go() {
  gone_ = true;
  for (const std::unique_ptr<Urb>& urb : urbs_) {
    if (urb->ended) continue;
    urb->ended = true;
    urb->status = -ESHUTDOWN;
  }
}

int UsbBed::reap(UMockdevIoctlData* arg) {
  const auto found =
      std::find_if(urbs_.begin(), urbs_.end(), [](const auto& urb) { return urb->ended; });
  if (found == urbs_.end()) return gone_ ? -ENODEV : -EAGAIN;
  const std::unique_ptr<Urb> urb = std::move(*found);
  urbs_.erase(found);
  put(urb->data.get(), offsetof(usbdevfs_urb, status), urb->status);
  put(urb->data.get(), offsetof(usbdevfs_urb, actual_length), static_cast<int>(urb->moved));
  const auto place = pointed(arg, 0, sizeof(void*));
  umockdev_ioctl_data_set_ptr(place.get(), 0, urb->data.get());
  return 0;
}

int UsbBed::discard(UMockdevIoctlData* arg) {
  const auto address = read_as<gulong>(arg);
  const auto found = std::find_if(urbs_.begin(), urbs_.end(), [&](const auto& urb) {
    return urb->data->client_addr == address && !urb->ended;
  });
  if (found == urbs_.end()) return -EINVAL;
  (*found)->ended = true;
  (*found)->status = -ENOENT;
  return 0;
}

}  // namespace packmerger::test
