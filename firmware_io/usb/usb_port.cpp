#include "firmware_io/usb/usb_port.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <thread>
#include <utility>

#include "base/error.h"
#include "firmware_io/ports/fd_port.h"
#include "firmware_io/ports/usb_library.h"

namespace packmerger {

namespace {

// Control requests are answered at once or never; a cancel must not wait longer for them.
constexpr unsigned kControl_ms = 500;

// bmRequestType: a request of the class to or from an interface.
constexpr std::uint8_t kFromInterface = 0xA1;
constexpr std::uint8_t kToInterface = 0x21;
constexpr std::uint16_t kFirstConfiguration = 0;  // what every printer answers for
enum Request : std::uint8_t { kGetDeviceId = 0, kGetPortStatus = 1, kSoftReset = 2 };

// The alternate setting of an interface that takes documents.
struct PrinterInterface {
  int number = 0;
  int setting = 0;
  int settings = 1;  // how many the interface has
  std::uint8_t out = 0;
  std::optional<std::uint8_t> in;
};

// 2 (both ways) before 1 (one way) before 3 (both ways, made for another protocol on top).
int preference(int protocol) { return protocol == 2 ? 3 : protocol == 1 ? 2 : protocol == 3; }

bool is_bulk(const libusb_endpoint_descriptor& endpoint, int direction) {
  return (endpoint.bmAttributes & LIBUSB_TRANSFER_TYPE_MASK) == LIBUSB_TRANSFER_TYPE_BULK &&
         (endpoint.bEndpointAddress & LIBUSB_ENDPOINT_DIR_MASK) == direction;
}

std::optional<std::uint8_t> endpoint_of(const libusb_interface_descriptor& setting, int direction) {
  for (int i = 0; i < setting.bNumEndpoints; ++i)
    if (is_bulk(setting.endpoint[i], direction)) return setting.endpoint[i].bEndpointAddress;
  return std::nullopt;
}

std::optional<PrinterInterface> find_interface(const libusb_config_descriptor& configuration) {
  std::optional<PrinterInterface> best;
  int best_preference = 0;
  for (int i = 0; i < configuration.bNumInterfaces; ++i) {
    const libusb_interface& interface = configuration.interface[i];
    for (int k = 0; k < interface.num_altsetting; ++k) {
      const libusb_interface_descriptor& setting = interface.altsetting[k];
      const int preferred = preference(setting.bInterfaceProtocol);
      const auto out = endpoint_of(setting, LIBUSB_ENDPOINT_OUT);
      if (setting.bInterfaceClass != LIBUSB_CLASS_PRINTER || !out || preferred <= best_preference)
        continue;
      best_preference = preferred;
      best = {
          setting.bInterfaceNumber, setting.bAlternateSetting, interface.num_altsetting, *out, {}};
      if (setting.bInterfaceProtocol != 1) best->in = endpoint_of(setting, LIBUSB_ENDPOINT_IN);
    }
  }
  return best;
}

unsigned milliseconds(double seconds) {
  // libusb takes 0 for ever
  return std::max(1U, static_cast<unsigned>(seconds * 1000));
}

[[noreturn]] void throw_cannot(const std::string& name, const std::string& what, int result) {
  if (result == LIBUSB_ERROR_BUSY) throw_busy(name);
  throw Error(Fault::kUnavailable,
              "Cannot " + what + " the USB printer " + name + ": " + usb::message_of(result),
              result == LIBUSB_ERROR_ACCESS
                  ? "Give your user the right to its device below /dev/bus/usb (on Debian: the "
                    "group lp)."
                  : "Check the cable and the printer's power.");
}

class LibusbPort : public UsbPort {
 public:
  LibusbPort(std::string name, usb::Context context, usb::Handle handle,
             const PrinterInterface& interface)
      : name_(std::move(name)),
        context_(std::move(context)),
        handle_(std::move(handle)),
        interface_(interface) {}
  ~LibusbPort() override { libusb_release_interface(handle_.get(), interface_.number); }

  std::size_t read(char* data, std::size_t size, double timeout_s) override {
    if (!interface_.in || timeout_s <= 0) {
      std::this_thread::sleep_for(std::chrono::duration<double>(std::max(0.0, timeout_s)));
      return 0;
    }
    int count = 0;
    const int result = transfer(*interface_.in, data, size, count, timeout_s);
    // a printer that refuses to tell anything is not asked again
    if (result == LIBUSB_ERROR_PIPE) interface_.in.reset();
    return static_cast<std::size_t>(count);
  }

  std::size_t write(std::string_view bytes, double timeout_s) override {
    int count = 0;
    // libusb does not write to what it sends
    transfer(interface_.out, const_cast<char*>(bytes.data()), bytes.size(), count, timeout_s);
    return static_cast<std::size_t>(count);
  }

  std::string name() const override { return name_; }

  std::string device_id() override {
    std::array<char, 1024> answer;
    const auto place = static_cast<std::uint16_t>(interface_.number << 8 | interface_.setting);
    const int count = control(kFromInterface, kGetDeviceId, kFirstConfiguration, place,
                              answer.data(), answer.size());
    return {answer.data(), static_cast<std::size_t>(std::max(0, count))};
  }

  std::optional<std::uint8_t> port_status() override {
    char answer = 0;
    const auto place = static_cast<std::uint16_t>(interface_.number);
    if (control(kFromInterface, kGetPortStatus, 0, place, &answer, 1) != 1) return std::nullopt;
    return static_cast<std::uint8_t>(answer);
  }

  void soft_reset() override {
    const auto place = static_cast<std::uint16_t>(interface_.number);
    control(kToInterface, kSoftReset, 0, place, nullptr, 0);
  }

 private:
  // Returns LIBUSB_SUCCESS, LIBUSB_ERROR_TIMEOUT or LIBUSB_ERROR_PIPE, the halt lifted; count tells
  // what was transferred in each case.
  int transfer(std::uint8_t endpoint, char* data, std::size_t size, int& count, double timeout_s) {
    const int result =
        libusb_bulk_transfer(handle_.get(), endpoint, reinterpret_cast<unsigned char*>(data),
                             static_cast<int>(size), &count, milliseconds(timeout_s));
    if (result == LIBUSB_ERROR_NO_DEVICE) throw_gone(name_);
    if (result == LIBUSB_ERROR_PIPE) {
      const int lifted = libusb_clear_halt(handle_.get(), endpoint);
      if (lifted == LIBUSB_ERROR_NO_DEVICE) throw_gone(name_);
      if (lifted != LIBUSB_SUCCESS) throw_failed(lifted);
      return result;
    }
    if (result != LIBUSB_SUCCESS && result != LIBUSB_ERROR_TIMEOUT) throw_failed(result);
    return result;
  }

  // How many bytes came; a negative number where the printer does not know the request.
  int control(std::uint8_t type, std::uint8_t request, std::uint16_t value, std::uint16_t index,
              char* data, std::size_t size) {
    const int result = libusb_control_transfer(handle_.get(), type, request, value, index,
                                               reinterpret_cast<unsigned char*>(data),
                                               static_cast<std::uint16_t>(size), kControl_ms);
    if (result == LIBUSB_ERROR_NO_DEVICE) throw_gone(name_);
    if (result < 0 && result != LIBUSB_ERROR_PIPE && result != LIBUSB_ERROR_TIMEOUT)
      throw_failed(result);
    return result;
  }

  [[noreturn]] void throw_failed(int result) const {
    throw Error(Fault::kIo,
                "The connection to the printer at " + name_ + " failed: " + usb::message_of(result),
                "Check the cable and the printer's power, then print the job again.");
  }

  std::string name_;
  usb::Context context_;
  usb::Handle handle_;
  PrinterInterface interface_;
};

usb::Device device_at(libusb_context* context, const UsbDevice& wanted, const std::string& name) {
  for (usb::Device& device : usb::devices_of(context))
    if (usb::place_of(device.get()) == wanted.at) return std::move(device);
  throw_cannot(name, "find", LIBUSB_ERROR_NO_DEVICE);
}

}  // namespace

std::unique_ptr<UsbPort> open_usb_port(const UsbDevice& device, const std::string& name) {
  usb::Context context = usb::open_context();
  usb::Device found = device_at(context.get(), device, name);
  const usb::Configuration configuration = usb::configuration_of(found.get());
  const auto interface =
      configuration ? find_interface(*configuration) : std::optional<PrinterInterface>();
  if (!interface)
    throw Error(Fault::kUnavailable, "The USB device " + name + " is no printer",
                "packmerger devices lists what is here; printers are marked (printer class).");
  libusb_device_handle* opened = nullptr;
  if (const int failed = libusb_open(found.get(), &opened); failed != 0)
    throw_cannot(name, "open", failed);
  usb::Handle handle(opened, libusb_close);
  found.reset();  // the handle keeps it, and nothing may keep it longer than the context lives
  libusb_set_auto_detach_kernel_driver(opened, 1);
  if (const int failed = libusb_claim_interface(opened, interface->number); failed != 0)
    throw_cannot(name, "claim", failed);
  auto port = std::make_unique<LibusbPort>(name, std::move(context), std::move(handle), *interface);
  if (interface->settings > 1)
    if (const int failed =
            libusb_set_interface_alt_setting(opened, interface->number, interface->setting);
        failed != 0)
      throw_cannot(name, "set up", failed);
  return port;
}

}  // namespace packmerger
