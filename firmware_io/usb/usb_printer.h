// The bytes of the USB printer class, after the "USB Device Class Definition for Printing Devices"
// 1.1 and IEEE 1284: who a printer is and whether it is ready. No port is known here.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace packmerger {

// What a printer answers to GET_DEVICE_ID. What it does not tell is empty. Bytes that are no
// printable ASCII are '?'.
struct UsbPrinterId {
  std::string manufacturer;  // MFG or MANUFACTURER
  std::string model;         // MDL or MODEL
  std::string commands;      // CMD or COMMAND SET: the languages it understands
};

// `answer` as it came: two bytes of length, big-endian and counting themselves, then
// "KEY:value;KEY:value;…". A length that is not so is passed over, since printers that count
// otherwise are sold; all that came is then read. Anything is taken, never an error.
UsbPrinterId read_usb_printer_id(std::string_view answer);

// What a printer answers to GET_PORT_STATUS, one byte.
struct UsbPrinterStatus {
  bool paper_empty = false;  // of a machine that makes solids: the material
  bool selected = true;      // on line
  bool error = false;
};

UsbPrinterStatus read_usb_printer_status(std::uint8_t answer);

// Why the printer cannot go on, for people: "it is out of paper or material"; empty: it can.
std::string trouble_of(const UsbPrinterStatus& status);

}  // namespace packmerger
