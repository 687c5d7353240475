#include "daemon/reload.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace packmerger {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

PrinterConfig printer(const std::string& name, const std::string& port = "/dev/a") {
  PrinterConfig printer;
  printer.name = name;
  printer.port = port;
  return printer;
}

const auto kIdle = [](const std::string&) { return false; };

TEST(Reload, IdlePrintersAreExchanged) {
  const Exchange exchange =
      exchanged({printer("gone"), printer("moved"), printer("same")},
                {printer("moved", "/dev/b"), printer("new"), printer("same")}, kIdle);
  EXPECT_THAT(exchange.changed, ElementsAre("gone", "moved", "new"));
  ASSERT_EQ(exchange.printers.size(), 3U);
  EXPECT_EQ(exchange.printers[0].port, "/dev/b");
  EXPECT_EQ(exchange.printers[1].name, "new");
  EXPECT_EQ(exchange.printers[2].name, "same");
  EXPECT_FALSE(exchange.waits);
}

TEST(Reload, BusyPrintersKeepTheirSettings) {
  const Exchange exchange =
      exchanged({printer("gone"), printer("moved")}, {printer("moved", "/dev/b"), printer("new")},
                [](const std::string&) { return true; });
  EXPECT_THAT(exchange.changed, ElementsAre("new"));
  ASSERT_EQ(exchange.printers.size(), 3U);
  EXPECT_EQ(exchange.printers[0].name, "gone");
  EXPECT_EQ(exchange.printers[1].port, "/dev/a");
  EXPECT_TRUE(exchange.waits);
}

TEST(Reload, EverySettingOfAPrinterCounts) {
  const PrinterConfig before = printer("p");
  std::vector<PrinterConfig> others(8, before);
  others[0].profile = "other";
  others[1].folder = "/other";
  others[2].port = "/dev/b";
  others[3].handoff_folder = "/other";
  others[4].approve = Approve::kAuto;
  others[5].simulated = true;
  others[6].options.size_mm = 3;
  others[7].abilities.link.baud = 250000;
  for (const PrinterConfig& after : others)
    EXPECT_THAT(exchanged({before}, {after}, kIdle).changed, ElementsAre("p"));
  EXPECT_THAT(exchanged({before}, {before}, kIdle).changed, IsEmpty());
}

TEST(Reload, SomeSettingsNeedARestart) {
  DaemonConfig now;
  DaemonConfig wanted;
  EXPECT_THAT(needing_restart(now, wanted), IsEmpty());
  wanted.state = "/other";
  wanted.socket = "/s";
  wanted.socket_mode = 0660;
  EXPECT_THAT(needing_restart(now, wanted), ElementsAre("state", "socket", "socket_mode"));
}

}  // namespace
}  // namespace packmerger
