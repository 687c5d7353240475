// Finding a printer's serial port by what libserialport tells of the devices that umockdev plays.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "delivery/find_port.h"
#include "sim/usb_bed.h"

namespace packmerger::test {
namespace {

using testing::HasSubstr;

// A device with a serial port of the driver cdc_acm.
void plug_serial(UsbBed& bed, const std::string& place, int number, const std::string& serial) {
  UsbPrinterTraits traits;
  traits.place = place;
  traits.vendor = 0x23C1;
  traits.product = 0xD314;
  traits.serial_number = serial;
  traits.interface_class = 2;
  const std::string device = usb_sys_path(place);
  const std::string interface = device + "/" + place + ":1.0";
  const std::string name = "ttyACM" + std::to_string(number);
  const std::string tty = "P: " + interface +
                          "\nE: DEVTYPE=usb_interface\nE: SUBSYSTEM=usb\n"
                          "L: driver=../../../../../../bus/usb/drivers/cdc_acm\n\nP: " +
                          interface + "/tty/" + name + "\nN: " + name + "\nE: DEVNAME=/dev/" +
                          name + "\nE: SUBSYSTEM=tty\nL: device=../../../" + place + ":1.0\n\n";
  bed.plug(usb_description(traits, number + 2) + tty, {device});
}

std::string found(const std::string& address, const std::vector<std::string>& usb_ids = {}) {
  try {
    return find_port(connected_serial_ports(), address, usb_ids);
  } catch (const Error& error) {
    return error.what();
  }
}

TEST(UsbPorts, AreFoundByIdAndSerialNumber) {
  UsbBed bed;
  EXPECT_THAT(found("usb:23c1:d314"), HasSubstr("No printer is at usb:23c1:d314"));
  plug_serial(bed, "1-1", 0, "A");
  EXPECT_EQ(found("usb:23c1:d314"), "/dev/ttyACM0");
  EXPECT_EQ(found("", {"23c1:d314"}), "/dev/ttyACM0");
  plug_serial(bed, "1-2", 1, "B");
  EXPECT_EQ(found("usb:23c1:d314:B"), "/dev/ttyACM1");
  EXPECT_THAT(found("usb:23c1:d314"), HasSubstr("usb:23c1:d314:A, usb:23c1:d314:B"));
  EXPECT_THAT(found("/dev/ttyACM1", {"1a86:7523"}), HasSubstr("USB id 23c1:d314"));
  EXPECT_EQ(found("/dev/ttyACM1", {"23c1:d314"}), "/dev/ttyACM1");
  EXPECT_THAT(advice_on("/dev/ttyACM1", connected_serial_ports()).value_or(""),
              HasSubstr("write usb:23c1:d314:B instead"));
  bed.unplug({usb_sys_path("1-1")});
  EXPECT_EQ(found("usb:23c1:d314"), "/dev/ttyACM1");
}

}  // namespace
}  // namespace packmerger::test
