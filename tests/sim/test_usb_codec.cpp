// The bytes of the USB printer class.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "firmware_io/usb/usb_printer.h"

namespace packmerger::test {
namespace {

std::string with_length(std::size_t length, const std::string& text) {
  return std::string{static_cast<char>(length >> 8U), static_cast<char>(length & 0xFFU)} + text;
}

const std::string kText = "MFG:Acme;MDL:Print bridge;CMD:3MF,STL;CLS:PRINTER;";

void expect_acme(const UsbPrinterId& id) {
  EXPECT_EQ(id.manufacturer, "Acme");
  EXPECT_EQ(id.model, "Print bridge");
  EXPECT_EQ(id.commands, "3MF,STL");
}

TEST(UsbPrinterCodec, ReadsShortAndLongKeys) {
  expect_acme(read_usb_printer_id(with_length(kText.size() + 2, kText)));
  const std::string other =
      "manufacturer: Acme ;COMMAND SET:3MF,STL;\n MODEL:Print bridge ;SERIALNUMBER:7";
  expect_acme(read_usb_printer_id(with_length(other.size() + 2, other)));
}

// Not counting itself, little-endian, zero, or more than came.
TEST(UsbPrinterCodec, ALengthThatIsNotSoIsPassedOver) {
  const std::size_t size = kText.size();
  for (const std::size_t length : {size, (size + 2) << 8U, std::size_t{0}, std::size_t{0xFFFF}})
    expect_acme(read_usb_printer_id(with_length(length, kText)));
}

TEST(UsbPrinterCodec, WhatIsBehindTheLengthIsNotRead) {
  const std::string answer = with_length(kText.size() + 2, kText) + "MDL:rubbish;";
  expect_acme(read_usb_printer_id(answer));
  expect_acme(read_usb_printer_id(with_length(0, kText + std::string("\0MDL:rubbish;", 13))));
}

TEST(UsbPrinterCodec, AnyBytesAreTaken) {
  EXPECT_TRUE(rc::check([](const std::string& bytes) {
    const UsbPrinterId id = read_usb_printer_id(bytes);
    for (const std::string& text : {id.manufacturer, id.model, id.commands})
      for (const char c : text) RC_ASSERT(c >= ' ' && c <= '~');
  }));
}

TEST(UsbPrinterCodec, EveryIdComesBack) {
  EXPECT_TRUE(rc::check([](std::uint16_t length) {
    const auto word = rc::gen::container<std::string>(rc::gen::inRange('a', '{'));
    const std::string maker = *word;
    const std::string model = *word;
    const std::string text = "CLS:PRINTER;MDL:" + model + ";MFG:" + maker + ";";
    const bool cuts = length > 2 && length < text.size() + 2;
    const UsbPrinterId id = read_usb_printer_id(with_length(cuts ? 0 : length, text));
    RC_ASSERT(id.manufacturer == maker);
    RC_ASSERT(id.model == model);
  }));
}

TEST(UsbPrinterCodec, Status) {
  EXPECT_EQ(trouble_of(read_usb_printer_status(0x18)), "");
  EXPECT_EQ(trouble_of(read_usb_printer_status(0x38)), "it is out of paper or material");
  EXPECT_EQ(trouble_of(read_usb_printer_status(0x10)), "it reports an error");
  EXPECT_EQ(trouble_of(read_usb_printer_status(0x08)), "it is not on line");
}

}  // namespace
}  // namespace packmerger::test
