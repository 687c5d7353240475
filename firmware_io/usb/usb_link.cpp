#include "firmware_io/usb/usb_link.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "base/descriptor.h"
#include "base/error.h"
#include "firmware_io/conversation.h"
#include "firmware_io/usb/usb_printer.h"

namespace packmerger {

namespace {

// What the kernel moves in one transfer, and a multiple of every packet size.
constexpr std::size_t kBlock = 16384;
// Longest transfer, so that a cancel acts within a second.
constexpr double kTransfer_s = 0.5;

[[noreturn]] void throw_cancelled() {
  throw Error(Fault::kInterrupted, "The print was cancelled", "");
}

class Document {
 public:
  explicit Document(const std::filesystem::path& path)
      : path_(path.string()), file_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
    struct stat status {};
    if (file_.get() < 0 || ::fstat(file_.get(), &status) != 0 || !S_ISREG(status.st_mode) ||
        status.st_size == 0)
      throw Error(Fault::kNoInput, "There is no document to print in " + path_,
                  "Prepare the job again.");
    size_ = static_cast<std::size_t>(status.st_size);
  }

  std::size_t size() const { return size_; }

  // From the offset, at most a block; stays true until the next call.
  std::string_view block(std::size_t offset) {
    const std::size_t wanted = std::min(kBlock, size_ - offset);
    const ssize_t count = ::pread(file_.get(), block_.data(), wanted, static_cast<off_t>(offset));
    if (count != static_cast<ssize_t>(wanted))
      throw Error(Fault::kIo,
                  "Cannot read " + path_ + ": " +
                      (count < 0 ? std::strerror(errno) : "it was changed while it was sent"),
                  "Check the disk, then print the job again.");
    return {block_.data(), wanted};
  }

 private:
  std::string path_;
  Descriptor file_;
  std::size_t size_ = 0;
  std::array<char, kBlock> block_;
};

class UsbPrint {
 public:
  UsbPrint(UsbPort& port, Document& document, const StreamOptions& options, Reporter& reporter,
           PrintControl& control)
      : port_(port),
        document_(document),
        timeout_s_(options.timeout_s),
        reporter_(reporter),
        control_(control) {}

  void check_name(const std::string& wanted) {
    if (wanted.empty()) return;
    const UsbPrinterId id = read_usb_printer_id(port_.device_id());
    check_machine(port_.name(), id.manufacturer + " " + id.model, wanted);
  }

  void run() {
    moved_at_s_ = port_.now_s();
    await_ready();
    reporter_.state(PrintState::kPrinting);
    while (sent_ < document_.size()) {
      if (control_.cancelled() || control_.stopped()) cancel();
      stand_paused();
      const std::string_view block = document_.block(sent_);
      // A transfer that timed out or stalled may have moved some bytes: they are not sent again.
      const std::size_t taken = port_.write(block, kTransfer_s);
      sent_ += taken;
      reporter_.done(sent_);
      reporter_.tick();
      if (taken > 0) moved_at_s_ = port_.now_s();
      if (taken == 0) pause();
      if (taken < block.size()) await_ready();
    }
  }

  // Otherwise the next document would be taken for the rest of this one.
  void drop_quietly() {
    if (sent_ == 0) return;
    try {
      port_.soft_reset();
    } catch (const Error&) {
      // The printer is gone; the failure that led here is what the user must read.
    }
  }

 private:
  // Waits until the printer says that it can go on.
  void await_ready() {
    bool waited = false;
    for (std::string trouble = find_trouble(); !trouble.empty(); trouble = find_trouble()) {
      reporter_.state(PrintState::kWaiting, trouble);
      if (port_.now_s() - moved_at_s_ > timeout_s_) give_up(trouble);
      pause();
      waited = true;
    }
    if (waited) moved_at_s_ = port_.now_s();
    if (port_.now_s() - moved_at_s_ > timeout_s_) give_up("it takes no more data");
    if (reporter_.current() == PrintState::kWaiting) reporter_.state(PrintState::kPrinting);
  }

  void stand_paused() {
    paused_ = control_.take_pause_request().value_or(paused_);
    if (!paused_) return;
    reporter_.state(PrintState::kPaused, "the rest of the document is held back");
    while (paused_) {
      pause();
      paused_ = control_.take_pause_request().value_or(paused_);
    }
    reporter_.state(PrintState::kPrinting);
    moved_at_s_ = port_.now_s();
  }

  std::string find_trouble() {
    const auto status = port_.port_status();
    return status ? trouble_of(read_usb_printer_status(*status)) : std::string();
  }

  // A printer may stop until somebody takes what it has to say; it is not looked at. Without the
  // pause, one that stalls again and again would keep a processor busy.
  void pause() {
    std::array<char, 512> answers;
    for (const double end_s = port_.now_s() + kSlice_s; port_.now_s() < end_s;) {
      if (control_.cancelled() || control_.stopped()) cancel();
      port_.read(answers.data(), answers.size(), end_s - port_.now_s());
    }
  }

  void cancel() {
    if (control_.stopped()) throw_stopped();
    reporter_.state(PrintState::kCancelling);
    throw_cancelled();
  }

  [[noreturn]] void give_up(const std::string& why) const {
    throw Error(sent_ == 0 ? Fault::kUnavailable : Fault::kIo,
                "The printer at " + port_.name() + " does not go on: " + why,
                "See what the printer shows, then print the job again. A printer that takes its "
                "data only as it prints needs a larger link.timeout_s.");
  }

  UsbPort& port_;
  Document& document_;
  double timeout_s_;
  Reporter& reporter_;
  PrintControl& control_;
  std::size_t sent_ = 0;
  bool paused_ = false;
  double moved_at_s_ = 0;
};

}  // namespace

void print_usb(UsbPort& port, const std::filesystem::path& document, const StreamOptions& options,
               const PrintListener& listener, PrintControl& control) {
  Document source(document);
  Reporter reporter(port, listener, options, source.size(), RemainingTime({}));
  UsbPrint print(port, source, options, reporter, control);
  print.check_name(options.machine);
  try {
    print.run();
  } catch (...) {
    print.drop_quietly();
    throw;
  }
  reporter.state(PrintState::kDone);
}

}  // namespace packmerger
