#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "unit/daemon/workshop.h"

namespace packmerger {
namespace {

using testing::HasSubstr;

const Failure kAbsent{Fault::kUnavailable, "No printer is there", "Connect it."};

Devices with_serial_port(const std::string& id, const std::string& number = "") {
  SerialDevice device;
  device.port = "/dev/ttyACM7";
  device.usb.id = id;
  device.usb.serial_number = number;
  return {{device}, {}};
}

// One printer, "sim", at the address.
class DevicesOfThePrinters : public testing::Test {
 protected:
  void put_at(const std::string& address, Dialect dialect = Dialect::kGcode) {
    shop_.config_.printers[2].port = address;
    shop_.config_.printers[2].abilities.dialect = dialect;
    shop_.start();
  }

  // A job that was tried and has to wait.
  void let_a_job_wait() {
    shop_.drop("sim", "a.stl");
    shop_.prepare(*shop_.prepare_order());
    ASSERT_TRUE(shop_.send_order("sim"));
    shop_.tell(SendEnded{1, SendOutcome::kNotStarted, kAbsent, ""});
    ASSERT_FALSE(shop_.send_order("sim")) << "it is tried again later";
  }

  json connected() {
    return shop_.ask({{"verb", "printers.list"}}).at("result").at(2).at("connected");
  }

  Workshop shop_;
};

TEST_F(DevicesOfThePrinters, AJobStartsAtOnceWhenItsPortIsBack) {
  const fs::path port = shop_.folder_.path() / "ttyACM0";
  std::ofstream(port).flush();
  put_at(port.string());
  let_a_job_wait();
  fs::remove(port);
  shop_.job_manager_->advance(shop_.now_s_);
  EXPECT_EQ(connected(), false);
  EXPECT_EQ(shop_.view(1).at("waits_for"), "not_connected");
  std::ofstream(port).flush();
  shop_.job_manager_->advance(shop_.now_s_);
  EXPECT_EQ(connected(), true);
  EXPECT_TRUE(shop_.send_order("sim")) << "without the rest of its time";
}

TEST_F(DevicesOfThePrinters, AUsbAddressIsWhatTheSystemTells) {
  put_at("usb:23c1:d314:A");
  EXPECT_EQ(connected(), nullptr) << "nobody has looked";
  let_a_job_wait();
  shop_.tell(DevicesSeen{with_serial_port("23c1:d314", "B"), {}});
  EXPECT_EQ(connected(), false) << "another one of the kind";
  EXPECT_EQ(shop_.view(1).at("waits_for"), "not_connected");
  EXPECT_FALSE(shop_.send_order("sim"));
  shop_.tell(DevicesSeen{with_serial_port("23c1:d314", "A"), {}});
  EXPECT_EQ(connected(), true);
  EXPECT_TRUE(shop_.send_order("sim"));
  EXPECT_THAT(shop_.log_, HasSubstr("printer sim: not connected\n"));
  EXPECT_THAT(shop_.log_, HasSubstr("printer sim: connected\n"));
}

TEST_F(DevicesOfThePrinters, APrinterOfDialectUsbIsNoSerialPort) {
  put_at("usb:0525:a4a8", Dialect::kUsb);
  shop_.tell(DevicesSeen{with_serial_port("0525:a4a8"), {}});
  EXPECT_EQ(connected(), false);
  shop_.tell(DevicesSeen{Devices{{}, {{"1-1", {"0525:a4a8", "", "", ""}, true, true}}}, {}});
  EXPECT_EQ(connected(), true);
}

TEST_F(DevicesOfThePrinters, ASystemThatDoesNotTellStopsNothing) {
  put_at("usb:23c1:d314");
  shop_.tell(DevicesSeen{{}, Failure{Fault::kIo, "No /sys", "Mount it."}});
  EXPECT_EQ(connected(), nullptr);
  EXPECT_THAT(shop_.log_, HasSubstr("No /sys. Mount it.\n"));
  shop_.drop("sim", "a.stl");
  shop_.prepare(*shop_.prepare_order());
  EXPECT_TRUE(shop_.send_order("sim"));
}

TEST_F(DevicesOfThePrinters, BehindASerialServerTheLastJobTells) {
  put_at("tcp:127.0.0.1:1");
  EXPECT_EQ(connected(), nullptr);
  let_a_job_wait();
  EXPECT_EQ(connected(), false);
  EXPECT_NE(shop_.view(1).at("waits_for"), "not_connected") << "only another attempt tells";
  shop_.now_s_ += shop_.config_.retry_s;
  shop_.job_manager_->advance(shop_.now_s_);
  ASSERT_TRUE(shop_.send_order("sim"));
  PrintReport report;
  shop_.tell(SendProgress{1, report});
  EXPECT_EQ(connected(), false);
  report.state = PrintState::kPrinting;
  shop_.tell(SendProgress{1, report});
  EXPECT_EQ(connected(), true);
  shop_.tell(SendEnded{1, SendOutcome::kFailed, {Fault::kIo, "is gone", "Look."}, ""});
  EXPECT_EQ(connected(), nullptr);
}

TEST_F(DevicesOfThePrinters, PortsWhoseNamesDoNotStayAreToldOnce) {
  put_at("/dev/ttyACM7");
  Devices devices = with_serial_port("23c1:d314", "A");
  shop_.tell(DevicesSeen{devices, {}});
  EXPECT_THAT(shop_.log_, HasSubstr("warning: printer sim: /dev/ttyACM7 may be another device"));
  shop_.log_.clear();
  shop_.tell(DevicesSeen{Devices{}, {}});
  EXPECT_EQ(shop_.log_.find("warning"), std::string::npos);
}

TEST_F(DevicesOfThePrinters, PortsSetByAReloadAreAdvisedOnToo) {
  put_at("/dev/serial/by-id/usb-B");
  shop_.tell(DevicesSeen{Devices{}, {}});
  EXPECT_EQ(shop_.log_.find("warning"), std::string::npos);
  shop_.config_.printers[2].port = "/dev/ttyACM7";
  shop_.job_manager_->advance(shop_.now_s_);
  EXPECT_THAT(shop_.log_, HasSubstr("warning: printer sim: /dev/ttyACM7 may be another device"));
}

TEST_F(DevicesOfThePrinters, WhatIsHandedOverIsNotConnected) {
  EXPECT_EQ(shop_.ask({{"verb", "printers.list"}}).at("result").at(0).at("connected"), nullptr);
}

// Job 1 is with the sender of a printer whose bed was clear.
void send_one(Workshop& shop) {
  shop.job_manager_->clear("real");
  shop.drop("real", "a.stl");
  shop.prepare(*shop.prepare_order());
  ASSERT_TRUE(shop.send_order("real"));
}

TEST(JobManager, APrintThatEndsBeforeItBeganLeavesTheBedClear) {
  struct Ending {
    SendOutcome outcome;
    Failure failure;
    bool untouched;
    JobState state;
    std::string reason;
  };
  const Failure cancelled{Fault::kInterrupted, "Cancelled before the print began", ""};
  const Failure refused{Fault::kBadInput, "The program has no command", "Prepare it again."};
  for (const Ending& ending : std::vector<Ending>{
           {SendOutcome::kCancelled, cancelled, true, JobState::kCancelled,
            "cancelled before the print began"},
           {SendOutcome::kFailed, refused, true, JobState::kFailed, refused.what},
           {SendOutcome::kCancelled, cancelled, false, JobState::kCancelled,
            "cancelled while printing"},
           {SendOutcome::kFailed, refused, false, JobState::kFailed, refused.what}}) {
    Workshop shop;
    ASSERT_NO_FATAL_FAILURE(send_one(shop));
    EXPECT_FALSE(shop.store_->printer("real").bed_clear);
    SendEnded end{1, ending.outcome, ending.failure, ""};
    end.untouched = ending.untouched;
    shop.tell(end);
    EXPECT_EQ(shop.job(1).state, ending.state);
    EXPECT_EQ(shop.job(1).reason, ending.reason);
    EXPECT_EQ(shop.store_->printer("real").bed_clear, ending.untouched);
  }
}

TEST(JobManager, AStopBeforeThePrintBeganLosesNothing) {
  Workshop shop;
  ASSERT_NO_FATAL_FAILURE(send_one(shop));
  shop.job_manager_->stop();
  SendEnded end{1, SendOutcome::kCancelled, {Fault::kInterrupted, "Cancelled", ""}, ""};
  end.untouched = true;
  shop.tell(end);
  EXPECT_EQ(shop.job(1).state, JobState::kApproved);
  EXPECT_EQ(shop.job(1).reason, "the daemon was stopped before the print began");
  EXPECT_TRUE(shop.store_->printer("real").bed_clear);
}

// The sender tells that it is tried again, and somebody cancels it before that is heard.
TEST(JobManager, WhatWasCancelledIsNotTriedAgain) {
  for (const Fault fault : {Fault::kUnavailable, Fault::kBusy})
    for (const bool is_stopping : {false, true}) {
      Workshop shop;
      ASSERT_NO_FATAL_FAILURE(send_one(shop));
      shop.job_manager_->cancel(1);
      if (is_stopping) shop.job_manager_->stop();
      SendEnded end{1, SendOutcome::kNotStarted, {fault, "Nobody answers", ""}, ""};
      end.untouched = fault != Fault::kBusy;
      shop.tell(end);
      EXPECT_EQ(shop.job(1).state, JobState::kCancelled);
      EXPECT_EQ(shop.store_->printer("real").bed_clear, fault != Fault::kBusy);
    }
}

}  // namespace
}  // namespace packmerger
