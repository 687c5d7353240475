#include "delivery/find_port.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"

namespace packmerger {
namespace {

using testing::HasSubstr;

SerialDevice serial(const std::string& port, const std::string& id, const std::string& number,
                    const std::string& link = "") {
  SerialDevice device;
  device.port = port;
  device.link = link;
  device.usb.id = id;
  device.usb.serial_number = number;
  return device;
}

UsbDevice usb(const std::string& at, const std::string& id, const std::string& number,
              bool is_printer = true) {
  return {at, {id, number, "", ""}, is_printer, true};
}

// /dev/null stands for a port that is there.
const std::vector<SerialDevice> kPorts = {
    serial("/dev/null", "1a86:7523", ""), serial("/dev/ttyACM1", "23c1:d314", "A:7"),
    serial("/dev/ttyACM2", "23c1:b404", "B", "/dev/serial/by-id/usb-B"),
    serial("/dev/ttyS0", "", "")};
const std::vector<UsbDevice> kDevices = {usb("1-1", "0525:a4a8", "A"), usb("1-2", "0525:a4a8", ""),
                                         usb("1-3", "046d:c077", "C", false)};

template <typename Check>
Error refusal(const Check& check) {
  try {
    check();
  } catch (const Error& error) {
    EXPECT_FALSE(error.hint().empty());
    return error;
  }
  throw std::runtime_error("was not refused");
}

TEST(FindPort, ByTheProfilesUsbIds) {
  EXPECT_EQ(find_port(kPorts, "", {"ffff:ffff", "23c1:d314"}), "/dev/ttyACM1");
  EXPECT_EQ(refusal([] { find_port(kPorts, "", {"0000:0000"}); }).fault(), Fault::kUnavailable);
  EXPECT_EQ(refusal([] { find_port(kPorts, "", {}); }).fault(), Fault::kUsage);
  const Error several = refusal([] { find_port(kPorts, "", {"23c1:d314", "23c1:b404"}); });
  EXPECT_EQ(several.fault(), Fault::kUsage);
  EXPECT_THAT(several.what(), HasSubstr("usb:23c1:d314:A:7, /dev/serial/by-id/usb-B"));
}

TEST(FindPort, ByAUsbAddress) {
  EXPECT_EQ(find_port(kPorts, "usb:23C1:D314", {}), "/dev/ttyACM1");
  EXPECT_EQ(find_port(kPorts, "usb:23c1:d314:A:7", {"23c1:d314"}), "/dev/ttyACM1");
  for (const char* wrong : {"usb:23c1:d314:A", "usb:23c1:ffff"})
    EXPECT_EQ(refusal([&] { find_port(kPorts, wrong, {}); }).fault(), Fault::kUnavailable) << wrong;
  for (const char* wrong :
       {"usb:", "usb:23c1", "usb:23c1:d31", "usb:23c1:d314:", "usb:23c1:d3145", "usb:23c1;d314"})
    EXPECT_EQ(refusal([&] { find_port(kPorts, wrong, {}); }).fault(), Fault::kUsage) << wrong;
  EXPECT_EQ(refusal([] { find_port(kPorts, "usb:1a86:7523", {"23c1:d314"}); }).fault(),
            Fault::kUnavailable);
}

TEST(FindPort, OtherAddressesStayAndAreCheckedWhereTheyAreOnUsb) {
  for (const char* port : {"/dev/ttyS0", "/dev/pts/0", "/dev/nonexistent"})
    EXPECT_EQ(find_port(kPorts, port, {"23c1:d314"}), port);
  EXPECT_EQ(find_port(kPorts, "/dev/null", {}), "/dev/null");
  EXPECT_THAT(refusal([] { find_port(kPorts, "/dev/null", {"23c1:d314"}); }).what(),
              HasSubstr("another one (USB id 1a86:7523 instead of 23c1:d314)"));
}

TEST(FindPort, PrintersOfThePrinterClass) {
  EXPECT_EQ(find_usb_printer(kDevices, "usb:0525:a4a8:A", {}).at, "1-1");
  const Error several = refusal([] { find_usb_printer(kDevices, "usb:0525:a4a8", {}); });
  EXPECT_EQ(several.fault(), Fault::kUnavailable);
  EXPECT_THAT(several.what(), HasSubstr("usb:0525:a4a8:A at 1-1, usb:0525:a4a8 at 1-2"));
  EXPECT_EQ(refusal([] { find_usb_printer(kDevices, "", {"0525:a4a8"}); }).fault(), Fault::kUsage);
  EXPECT_EQ(refusal([] { find_usb_printer(kDevices, "usb:046d:c077", {}); }).fault(),
            Fault::kUnavailable)
      << "no printer";
  EXPECT_EQ(refusal([] { find_usb_printer(kDevices, "/dev/usb/lp0", {}); }).fault(), Fault::kUsage);
}

TEST(FindPort, AdvisesNamesThatStay) {
  const std::vector<SerialDevice> none;
  EXPECT_THAT(advice_on("/dev/ttyUSB0", none).value_or(""), HasSubstr("packmerger devices"));
  EXPECT_FALSE(advice_on("/dev/ttyS0", kPorts));
  EXPECT_FALSE(advice_on("/dev/pts/1", kPorts));
  EXPECT_FALSE(advice_on("tcp:host:2001", kPorts));
  EXPECT_FALSE(advice_on("/dev/serial/by-id/usb-B", kPorts));
}

}  // namespace
}  // namespace packmerger
