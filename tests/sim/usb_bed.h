// A computer with USB devices that do not exist, made by umockdev: an unchanged libusb sees them
// below /sys and /dev and speaks with them through the kernel's own requests (usbdevice_fs.h). One
// of them is a printer of the printer class, with faults on its line. Runs where umockdev's library
// is preloaded (umockdev-wrapper). No codec of the links is used.
#pragma once

#include <umockdev.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace packmerger::test {

struct GObjectUnref {
  void operator()(void* object) const { g_object_unref(object); }
};
template <typename T>
using GObjectPointer = std::unique_ptr<T, GObjectUnref>;

// What the printer makes of one bulk transfer.
struct BulkAnswer {
  enum class End {
    kTaken,    // ends well, with fewer bytes than offered if `bytes` says so
    kStall,    // the endpoint halts until the host lifts it
    kSilence,  // NAK until the host gives up
    kUnplugged
  };
  std::size_t bytes = 0;
  End end = End::kTaken;
};

struct UsbPrinterTraits {
  std::string place = "1-1";
  int vendor = 0x0525;
  int product = 0xA4A8;
  std::string serial_number = "B-1";
  int interface_class = 7;
  int protocol = 2;
  std::string device_id = "MFG:Acme;MDL:Print bridge;CMD:3MF,STL;CLS:PRINTER;";
  bool busy = false;                // another program holds its interface
  bool driver = true;               // the kernel's usblp does
  bool forgets_after_reset = true;  // takes nothing after a SOFT_RESET until it is opened again
};

class UsbBed {
 public:
  UsbBed();
  UsbBed(const UsbBed&) = delete;
  UsbBed& operator=(const UsbBed&) = delete;
  ~UsbBed();

  // Connects a device as umockdev describes one (umockdev-record), and tells the system.
  void plug(const std::string& description, const std::vector<std::string>& sys_paths);
  void unplug(const std::vector<std::string>& sys_paths);

  void plug_printer(const UsbPrinterTraits& traits = {});
  void unplug_printer();

  // Called with what came so far and what is offered now; without it everything is taken. Set it
  // before anything is sent.
  std::function<BulkAnswer(std::size_t received, std::size_t offered)> on_bulk;
  // The answer to GET_PORT_STATUS; nothing: the request is refused.
  std::function<std::optional<std::uint8_t>()> on_status;

  std::string received() const;
  // "claim", "detach usblp", "release", "attach usblp", "clear halt", "soft reset", in order.
  std::vector<std::string> events() const;

  static constexpr std::uint8_t kReady = 0x18;

 private:
  struct Urb {
    GObjectPointer<UMockdevIoctlData> data;
    std::size_t moved = 0;
    int status = 0;
    bool ended = false;
  };

  static gboolean handle(UMockdevIoctlBase* base, UMockdevIoctlClient* client, gpointer self);
  int answer(UMockdevIoctlClient* client);
  int submit(UMockdevIoctlData* arg);
  int reap(UMockdevIoctlData* arg);
  int discard(UMockdevIoctlData* arg);
  int claim(const std::string& driver);
  void control(Urb& urb, UMockdevIoctlData& buffer);
  void go();
  void bulk(Urb& urb, UMockdevIoctlData& buffer);
  void note(const std::string& event) { events_.push_back(event); }

  GObjectPointer<UMockdevTestbed> bed_;
  GObjectPointer<UMockdevIoctlBase> handler_;
  UsbPrinterTraits traits_;
  std::string node_;
  int devices_ = 0;

  mutable std::mutex mutex_;
  std::vector<std::unique_ptr<Urb>> urbs_;
  std::string received_;
  std::vector<std::string> events_;
  bool halted_ = false;
  bool deaf_ = false;
  bool unplugs_ = false;  // with the transfer that is being submitted
  bool gone_ = false;
};

// One USB device for plug(), with an interface of two bulk endpoints, 0x02 out and 0x81 in.
std::string usb_description(const UsbPrinterTraits& traits, int number);

// Its path below /sys.
std::string usb_sys_path(const std::string& place);

}  // namespace packmerger::test
