// Documents sent through the real libusb to a printer that umockdev plays, with faults on the line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <future>
#include <set>

#include "base/error.h"
#include "base/files.h"
#include "firmware_io/ports/devices.h"
#include "firmware_io/usb/usb_link.h"
#include "sim/usb_bed.h"

namespace packmerger::test {
namespace {

using End = BulkAnswer::End;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kBlock = 16384;  // what is offered at a time

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

// No two stretches of it are alike, and its length is no multiple of any packet.
std::string document_of(std::size_t size) {
  std::string bytes;
  for (std::uint32_t word = 1; bytes.size() < size; ++word) {
    const std::uint32_t mixed = word * 2654435761U;
    bytes += {static_cast<char>(mixed >> 24U), static_cast<char>(mixed >> 16U),
              static_cast<char>(mixed >> 8U), static_cast<char>(word)};
  }
  bytes.resize(size);
  return bytes;
}

class UsbPrinting : public testing::Test {
 protected:
  void SetUp() override { std::ofstream(path(), std::ios::binary) << document_; }

  fs::path path() const { return folder_.path() / "tray.3mf"; }

  std::optional<Error> print(const std::string& wanted = "", double timeout_s = 30) {
    StreamOptions options;
    options.timeout_s = timeout_s;
    options.machine = wanted;
    const auto listener = [&](const PrintReport& report) {
      reports_.push_back(report);
      if (on_report_) on_report_(report);
    };
    try {
      const auto port = open_usb_port(connected_devices().usb.at(0), "usb:0525:a4a8");
      print_usb(*port, path(), options, listener, control_);
    } catch (const Error& error) {
      return error;
    }
    return std::nullopt;
  }

  void expect_printed(const std::optional<Error>& failure) {
    EXPECT_FALSE(failure) << failure->what();
    EXPECT_TRUE(bed_.received() == document_) << bed_.received().size() << " bytes came";
    EXPECT_THAT(bed_.events(), Not(Contains("soft reset")));
    EXPECT_EQ(reports_.back().state, PrintState::kDone);
    EXPECT_EQ(reports_.back().done, document_.size());
    EXPECT_EQ(reports_.back().total, document_.size());
  }

  void expect_failed(const std::optional<Error>& failure, Fault fault, const std::string& cause) {
    ASSERT_TRUE(failure);
    EXPECT_EQ(failure->fault(), fault) << failure->what();
    EXPECT_THAT(failure->what(), HasSubstr(cause));
    EXPECT_TRUE(document_.starts_with(bed_.received()));
    EXPECT_LT(bed_.received().size(), document_.size());
  }

  bool waited_for(const std::string& text) const {
    return std::any_of(reports_.begin(), reports_.end(), [&](const PrintReport& report) {
      return report.state == PrintState::kWaiting && report.text == text;
    });
  }

  const std::string document_ = document_of(300'001);
  TemporaryFolder folder_;
  UsbBed bed_;
  PrintControl control_;
  std::vector<PrintReport> reports_;
  PrintListener on_report_;
};

TEST_F(UsbPrinting, TakesTheWholeDocumentAndGivesTheDriverBack) {
  bed_.plug_printer();
  expect_printed(print("acme"));
  EXPECT_THAT(bed_.events(), ElementsAre("detach usblp", "claim", "release", "attach usblp"));
  EXPECT_EQ(reports_.front().state, PrintState::kConnecting);
}

TEST_F(UsbPrinting, OneWayPrinterWithoutIdAndStatus) {
  UsbPrinterTraits traits;
  traits.protocol = 1;
  traits.device_id.clear();
  traits.driver = false;
  bed_.on_status = [] { return std::nullopt; };
  bed_.plug_printer(traits);
  expect_printed(print());
  EXPECT_THAT(bed_.events(), Not(Contains("detach usblp")));
}

TEST_F(UsbPrinting, ShortTransfersGoOnFromWhatWasTaken) {
  bed_.plug_printer();
  bed_.on_bulk = [](std::size_t received, std::size_t offered) -> BulkAnswer {
    return {std::min(offered, 1 + received % 4001), End::kTaken};
  };
  expect_printed(print());
}

TEST_F(UsbPrinting, StallsAreLiftedAndNothingIsDoubled) {
  bed_.plug_printer();
  int transfers = 0;
  bed_.on_bulk = [&](std::size_t, std::size_t offered) -> BulkAnswer {
    ++transfers;
    if (transfers == 3) return {offered / 2, End::kStall};
    if (transfers == 5) return {0, End::kStall};
    return {offered, End::kTaken};
  };
  expect_printed(print());
  const auto events = bed_.events();
  EXPECT_EQ(std::count(events.begin(), events.end(), "clear halt"), 2);
}

// The host gives up a transfer of which part was taken.
TEST_F(UsbPrinting, SilenceIsWaitedOutFromWhereItBegan) {
  bed_.plug_printer();
  int transfers = 0;
  bed_.on_bulk = [&](std::size_t, std::size_t offered) -> BulkAnswer {
    ++transfers;
    if (transfers == 2) return {512, End::kSilence};
    if (transfers == 3) return {0, End::kSilence};
    if (transfers == 4) return {offered - 1, End::kSilence};
    return {offered, End::kTaken};
  };
  expect_printed(print());
}

TEST_F(UsbPrinting, WaitsWhileThePrinterIsOutOfMaterial) {
  bed_.plug_printer();
  int asked = 0;
  bed_.on_status = [&] { return std::optional<std::uint8_t>(++asked < 4 ? 0x38 : 0x18); };
  std::size_t taken_meanwhile = 0;
  bed_.on_bulk = [&](std::size_t, std::size_t offered) -> BulkAnswer {
    if (asked < 4) taken_meanwhile += offered;
    return {offered, End::kTaken};
  };
  expect_printed(print());
  EXPECT_TRUE(waited_for("it is out of paper or material"));
  EXPECT_EQ(taken_meanwhile, 0u);
}

TEST_F(UsbPrinting, StopsInTheMiddleAndGoesOn) {
  bed_.plug_printer();
  bool stopped = false;
  int asked = 0;
  bed_.on_bulk = [&](std::size_t received, std::size_t offered) -> BulkAnswer {
    if (received >= 5 * kBlock && !std::exchange(stopped, true)) return {100, End::kSilence};
    return {offered, End::kTaken};
  };
  bed_.on_status = [&] {
    return std::optional<std::uint8_t>(stopped && ++asked < 4 ? 0x08 : 0x18);
  };
  expect_printed(print());
  EXPECT_TRUE(waited_for("it is not on line"));
}

TEST_F(UsbPrinting, NotReadyForTooLongIsNoPrint) {
  bed_.plug_printer();
  bed_.on_status = [] { return std::optional<std::uint8_t>(0x10); };
  expect_failed(print("", 0.5), Fault::kUnavailable, "it reports an error");
  EXPECT_EQ(bed_.received(), "");
  EXPECT_THAT(bed_.events(), Not(Contains("soft reset")));
}

TEST_F(UsbPrinting, TakingNothingForTooLongFails) {
  bed_.plug_printer();
  bed_.on_bulk = [](std::size_t received, std::size_t offered) -> BulkAnswer {
    return received < 3 * kBlock ? BulkAnswer{offered, End::kTaken} : BulkAnswer{0, End::kSilence};
  };
  expect_failed(print("", 3), Fault::kIo, "it takes no more data");
  EXPECT_THAT(bed_.events(), Contains("soft reset"));
}

// A printer that stalls for ever ends the print too, and keeps no processor busy.
TEST_F(UsbPrinting, StallingForEverFails) {
  bed_.plug_printer();
  int transfers = 0;
  bed_.on_bulk = [&](std::size_t, std::size_t) -> BulkAnswer {
    ++transfers;
    return {0, End::kStall};
  };
  expect_failed(print("", 1), Fault::kUnavailable, "it takes no more data");
  EXPECT_LT(transfers, 20);
}

TEST_F(UsbPrinting, UnpluggedIsNoticedAtOnce) {
  bed_.plug_printer();
  Clock::time_point gone_at;
  bed_.on_bulk = [&](std::size_t received, std::size_t offered) -> BulkAnswer {
    if (received < 5 * kBlock) return {offered, End::kTaken};
    gone_at = Clock::now();
    return {77, End::kUnplugged};
  };
  expect_failed(print(), Fault::kIo, "is gone");
  EXPECT_LT(seconds_since(gone_at), 5);
}

TEST_F(UsbPrinting, UnpluggedWhileItIsSilent) {
  bed_.plug_printer();
  bed_.on_bulk = [](std::size_t, std::size_t) -> BulkAnswer { return {1000, End::kSilence}; };
  std::future<std::optional<Error>> done;
  on_report_ = [&](const PrintReport& report) {
    if (report.done > 0 && !done.valid())
      done = std::async(std::launch::async, [&] {
        bed_.unplug_printer();
        return std::optional<Error>();
      });
  };
  const auto begin = Clock::now();
  expect_failed(print(), Fault::kIo, "is gone");
  EXPECT_LT(seconds_since(begin), 5);
}

TEST_F(UsbPrinting, TheNextJobRunsWhenThePrinterIsBack) {
  bed_.plug_printer();
  bed_.on_bulk = [](std::size_t, std::size_t) -> BulkAnswer { return {10, End::kUnplugged}; };
  expect_failed(print(), Fault::kIo, "is gone");
  bed_.unplug_printer();
  EXPECT_TRUE(connected_devices().usb.empty());
  bed_.on_bulk = {};
  bed_.plug_printer();
  const std::optional<Error> failure = print();
  EXPECT_FALSE(failure) << failure->what();
  EXPECT_TRUE(bed_.received() == document_.substr(0, 10) + document_);
}

TEST_F(UsbPrinting, CancelActsWithinASecondAndResets) {
  bed_.plug_printer();
  bed_.on_bulk = [](std::size_t received, std::size_t offered) -> BulkAnswer {
    return received < 5 * kBlock ? BulkAnswer{offered, End::kTaken} : BulkAnswer{0, End::kSilence};
  };
  Clock::time_point asked;
  auto canceller = std::async(std::launch::async, [&] {
    for (int i = 0; i < 2000 && bed_.received().size() < 5 * kBlock; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_THAT(bed_.events(), Not(Contains("soft reset")));
    asked = Clock::now();
    control_.cancel();
  });
  expect_failed(print(), Fault::kInterrupted, "cancelled");
  EXPECT_LT(seconds_since(asked), 10) << "a second is what is promised";
  EXPECT_THAT(bed_.events(), Contains("soft reset"));
  EXPECT_EQ(reports_.back().state, PrintState::kCancelling);
}

TEST_F(UsbPrinting, CancelWhileItIsOutOfMaterial) {
  bed_.plug_printer();
  bed_.on_status = [] { return std::optional<std::uint8_t>(0x38); };
  on_report_ = [&](const PrintReport& report) {
    if (report.state == PrintState::kWaiting) control_.cancel();
  };
  expect_failed(print(), Fault::kInterrupted, "cancelled");
  EXPECT_THAT(bed_.events(), Not(Contains("soft reset"))) << "it was given nothing";
}

TEST_F(UsbPrinting, PausesHoldTheRestBackWithoutATimeOut) {
  bed_.plug_printer();
  std::size_t at_the_pause = 0;
  bed_.on_bulk = [&](std::size_t received, std::size_t offered) -> BulkAnswer {
    if (received == 5 * kBlock) control_.pause();
    return {offered, End::kTaken};
  };
  std::future<void> resumer;
  on_report_ = [&](const PrintReport& report) {
    if (report.state != PrintState::kPaused || resumer.valid()) return;
    at_the_pause = bed_.received().size();
    resumer = std::async(std::launch::async, [&] {
      std::this_thread::sleep_for(std::chrono::seconds(4));
      EXPECT_EQ(bed_.received().size(), at_the_pause);
      control_.resume();
    });
  };
  expect_printed(print("", 3));
  EXPECT_EQ(at_the_pause, 6 * kBlock);
}

TEST_F(UsbPrinting, StoppedAtOnceWhilePaused) {
  bed_.plug_printer();
  bed_.on_bulk = [&](std::size_t, std::size_t offered) -> BulkAnswer {
    control_.pause();
    return {offered, End::kTaken};
  };
  on_report_ = [&](const PrintReport& report) {
    if (report.state == PrintState::kPaused) control_.stop_at_once();
  };
  expect_failed(print(), Fault::kIo, "stopped at once");
  EXPECT_THAT(bed_.events(), Contains("soft reset"));
}

TEST_F(UsbPrinting, ABusyPrinterIsNotTouched) {
  UsbPrinterTraits traits;
  traits.busy = true;
  bed_.plug_printer(traits);
  expect_failed(print(), Fault::kBusy, "held by another program");
  EXPECT_TRUE(bed_.events().empty());
}

TEST_F(UsbPrinting, AnotherPrinterIsRefused) {
  bed_.plug_printer();
  expect_failed(print("Stratasys"), Fault::kUnavailable, "says that it is \"Acme Print bridge\"");
  EXPECT_THAT(bed_.events(), Contains("attach usblp"));
}

TEST_F(UsbPrinting, WhatIsNoPrinterIsRefused) {
  UsbPrinterTraits traits;
  traits.interface_class = 255;
  bed_.plug_printer(traits);
  expect_failed(print(), Fault::kUnavailable, "is no printer");
}

TEST_F(UsbPrinting, ADocumentThatIsNotThereIsRefused) {
  bed_.plug_printer();
  fs::remove(path());
  expect_failed(print(), Fault::kNoInput, "no document");
  std::ofstream(path()).flush();
  expect_failed(print(), Fault::kNoInput, "no document");
}

}  // namespace
}  // namespace packmerger::test
