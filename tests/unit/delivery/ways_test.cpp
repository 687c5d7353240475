#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <set>

#include "base/error.h"
#include "base/files.h"
#include "delivery/way.h"
#include "firmware_io/simulated/firmwares.h"

namespace packmerger {
namespace {

using ::testing::HasSubstr;

std::string page(const char* name) {
  const char* source = std::getenv("PACKMERGER_SOURCE");
  return read_file(fs::path(source != nullptr ? source : ".") / "docs" / name, 1 << 20);
}

std::string yes_or_no(bool is_so) { return is_so ? "yes" : "no"; }

// A row as docs/PROTOCOLS has it.
std::string row_told(const DialectRow& row) {
  const DeliveryWay& way = way_of(row.dialect);
  std::string simulated;
  for (const std::string_view firmware : way.simulated)
    simulated += (simulated.empty() ? "`" : ", `") + std::string(firmware) + "`";
  return "| `" + std::string(row.name) + "` | " +
         (row.language != nullptr ? "`." + std::string(row.language->extension) + "`"
                                  : "the profile's `document`") +
         " | " + (way.hands_over ? "`handoff_folder`" : "`port`") + " | " +
         (way.hands_over ? "none" : std::string(way.unit) + "s") + " | " + yes_or_no(way.has_bed) +
         " | " + yes_or_no(way.tells_end) + " | " + (simulated.empty() ? "none" : simulated) + " |";
}

TEST(Ways, EveryDialectHasARowAndAWayOfItsOwn) {
  std::set<std::string_view> names;
  std::set<const DeliveryWay*> ways;
  for (const DialectRow& row : kDialects) {
    names.insert(row.name);
    const DeliveryWay& way = way_of(row.dialect);
    ways.insert(&way);
    EXPECT_NE(way.fault_of_settings, nullptr) << row.name;
    EXPECT_NE(way.check_program, nullptr) << row.name;
    EXPECT_NE(way.find_printer, nullptr) << row.name;
    EXPECT_NE(way.is_connected, nullptr) << row.name;
    EXPECT_NE(way.give, nullptr) << row.name;
    for (const std::string_view firmware : way.simulated)
      EXPECT_EQ(simulated::firmware_named(firmware).name, firmware);
  }
  EXPECT_EQ(names.size(), kDialects.size());
  EXPECT_EQ(ways.size(), kDialects.size());
}

// Whoever reads such a program asks for its language (delivery/ready_program).
TEST(Ways, NoneTakesProgramsWithoutALanguage) {
  Profile profile;
  for (const DialectRow& row : kDialects) {
    profile.dialect = row.dialect;
    if (row.language != nullptr) continue;
    for (const FileKind kind : {FileKind::kGcode, FileKind::kX3g, FileKind::kSliced})
      EXPECT_THROW(way_of(row.dialect).check_program(profile, kind), Error) << row.name;
  }
}

TEST(Ways, ATableThatLacksADialectIsNoticed) {
  constexpr std::array<DialectRow, 1> kOne = {kDialects[0]};
  static_assert(!has_every_dialect(kOne));
  constexpr auto kLast = static_cast<std::size_t>(Dialect::kCount) - 1;
  constexpr auto kHole = [] {
    auto rows = kDialects;
    rows[kLast] = {};  // as where a row was not written
    return rows;
  }();
  static_assert(!has_every_dialect(kHole));
  static_assert(has_every_dialect(kDialects));
}

TEST(Ways, RowsSayWhatTheDocsSay) {
  const std::string profiles = page("PROFILES.md");
  const std::string protocols = page("PROTOCOLS.md");
  std::string names;
  for (const DialectRow& row : kDialects) {
    names += (names.empty() ? "" : ", ") + std::string(row.name);
    EXPECT_THAT(protocols, HasSubstr(row_told(row)));
    EXPECT_THAT(profiles, HasSubstr(std::string(row.given)));
  }
  EXPECT_THAT(profiles, HasSubstr("| `dialect` | one of " + names + " |"));
}

TEST(Ways, WhatTheyAskOfSettings) {
  const auto fault = [](const char* dialect, const char* port, const char* folder) {
    for (const DialectRow& row : kDialects)
      if (row.name == dialect)
        return way_of(row.dialect).fault_of_settings(port, folder).value_or("");
    return std::string("no such dialect");
  };
  for (const char* dialect : {"gcode", "s3g"}) {
    EXPECT_EQ(fault(dialect, "/dev/ttyS0", ""), "");
    EXPECT_EQ(fault(dialect, "tcp:localhost:4000", ""), "");
    EXPECT_EQ(fault(dialect, "usb:23c1:d314", ""), "");
  }
  for (const char* dialect : {"gcode", "s3g", "usb"}) {
    EXPECT_EQ(fault(dialect, "", ""), "needs the key port");
    EXPECT_THAT(fault(dialect, "usb:23c1:d314", "/x"), HasSubstr("cannot have a handoff_folder"));
  }
  EXPECT_EQ(fault("usb", "usb:23c1:d314", ""), "");
  EXPECT_THAT(fault("usb", "/dev/usb/lp0", ""), HasSubstr("its dialect is usb"));
  EXPECT_EQ(fault("handoff", "", "/x"), "");
  EXPECT_THAT(fault("handoff", "", ""), HasSubstr("needs the key handoff_folder"));
  EXPECT_THAT(fault("handoff", "/dev/ttyS0", "/x"), HasSubstr("cannot have a port"));
}

TEST(Ways, WhetherAPrinterIsThere) {
  const auto is_there = [](Dialect dialect, const char* port,
                           const std::optional<Devices>& devices) {
    return way_of(dialect).is_connected(port, devices);
  };
  Devices devices;
  devices.serial.push_back({"/dev/ttyACM0", "", "", {"23c1:d314", "A", "", ""}, true});
  devices.usb.push_back({"1-1", {"0525:a4a8", "B", "", ""}, true, true});
  for (const Dialect serial : {Dialect::kGcode, Dialect::kS3g}) {
    EXPECT_EQ(is_there(serial, "usb:23c1:d314:A", devices), true);
    EXPECT_EQ(is_there(serial, "usb:0525:a4a8:B", devices), false) << "it is no serial port";
    EXPECT_EQ(is_there(serial, "usb:23c1:d314:A", std::nullopt), std::nullopt);
    EXPECT_EQ(is_there(serial, "/dev/null", std::nullopt), true);
    EXPECT_EQ(is_there(serial, "/dev/no-such-port", devices), false);
    EXPECT_EQ(is_there(serial, "tcp:localhost:4000", devices), std::nullopt);
  }
  EXPECT_EQ(is_there(Dialect::kUsb, "usb:0525:a4a8:B", devices), true);
  EXPECT_EQ(is_there(Dialect::kUsb, "usb:23c1:d314:A", devices), false);
  EXPECT_EQ(is_there(Dialect::kUsb, "usb:0525:a4a8:B", std::nullopt), std::nullopt);
  EXPECT_EQ(is_there(Dialect::kHandoff, "", devices), std::nullopt);
}

}  // namespace
}  // namespace packmerger
