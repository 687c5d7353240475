#include "daemon/settings/config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "base/error.h"
#include "base/files.h"
#include "daemon/settings/model_options.h"

namespace packmerger {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class ConfigTest : public testing::Test {
 protected:
  fs::path write(const std::string& text) {
    const fs::path file = folder_.path() / "d.toml";
    std::ofstream(file) << text;
    return file;
  }

  std::string refusal(const std::string& text) {
    try {
      read_config(write(text));
    } catch (const Error& error) {
      EXPECT_EQ(error.fault(), Fault::kBadProfile) << error.what();
      EXPECT_FALSE(error.hint().empty());
      return error.what();
    }
    return "accepted";
  }

  TemporaryFolder folder_;
};

const char* const kPrinter = "[printer.m]\nprofile = \"marlin\"\nport = \"/dev/ttyUSB0\"\n";

TEST_F(ConfigTest, AddressesOnUsb) {
  const auto printer = [](const std::string& profile, const std::string& port) {
    return "[printer.m]\nprofile = \"" + profile + "\"\nport = \"" + port + "\"\n";
  };
  EXPECT_THAT(refusal(printer("objet30", "usb:nonsense")), HasSubstr("takes no job by wire"))
      << "such a port is not to be corrected, it has to go";
  EXPECT_EQ(refusal(printer("marlin", "usb:23c1:D314:A:1")), "accepted");
  EXPECT_THAT(refusal(printer("marlin", "usb:23c1")), HasSubstr("usb:VID:PID:SERIAL"));
  const std::string set = "set = [\"dialect=usb\"]\n";
  EXPECT_EQ(refusal(printer("objet30", "usb:0525:a4a8") + set), "accepted");
  EXPECT_THAT(refusal(printer("objet30", "/dev/usb/lp0") + set), HasSubstr("its dialect is usb"));
}

TEST_F(ConfigTest, ReadsEveryKey) {
  const DaemonConfig config = read_config(write(R"(
state = "state"
socket = "/run/x.sock"
socket_mode = "0660"
retry_s = 5
[prepare]
program = "./fake"
time_s = 60
memory_bytes = 1073741824
nice = 5
seed = 4
budget_s = 1.5
[watch]
rescan_s = 2
still_s = 0.5
give_up_s = 10
[printer.m]
profile = "marlin"
port = "/dev/ttyUSB0"
folder = "drop"
approve = "auto"
simulated = true
units = "in"
size_mm = 60
variant = "cheapest"
split = false
hollow = false
set = ["gap_mm=0", "wall_mm=2"]
[printer.o]
profile = "objet30"
handoff_folder = "/mnt/share"
)"));
  EXPECT_EQ(config.state, folder_.path() / "state");
  EXPECT_EQ(config.socket, "/run/x.sock");
  EXPECT_EQ(config.socket_mode, 0660U);
  EXPECT_EQ(config.prepare.program, folder_.path() / "fake");
  EXPECT_EQ(config.prepare.memory_bytes, 1073741824U);
  EXPECT_EQ(config.prepare.budget_s, 1.5);
  EXPECT_EQ(config.watch.give_up_s, 10);
  ASSERT_EQ(config.printers.size(), 2U);
  const PrinterConfig& marlin = *config.printer("m");
  EXPECT_EQ(marlin.folder, folder_.path() / "drop");
  EXPECT_THAT(arguments_of(marlin.options),
              ElementsAre("--units", "in", "--size", "60", "--variant", "cheapest", "--no-split",
                          "--no-hollow", "--set", "gap_mm=0", "--set", "wall_mm=2"));
  EXPECT_FALSE(marlin.has_bed());
  EXPECT_TRUE(config.printer("o")->hands_over());
  EXPECT_EQ(config.printer("o")->folder, config.state / "folders/o");
  EXPECT_EQ(config.printer("x"), nullptr);
}

TEST_F(ConfigTest, TellsFileLineAndWhatWasExpected) {
  const std::string printer = kPrinter;
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"state = 3\n" + printer, "d.toml:1: state: expected the path of a folder"},
      {"\nretry_s = \"5\"\n" + printer, "d.toml:2: retry_s: expected a number from 0.1"},
      {"retry_s = nan\n" + printer, "d.toml:1: retry_s: expected a number"},
      {"stat = \"x\"\n" + printer, "d.toml:1: unknown key stat"},
      {"prepare = 1\n" + printer, "d.toml:1: expected a table [prepare]"},
      {"[prepare]\ntime_s = 0\n" + printer, "d.toml:2: prepare.time_s: expected a number from 1"},
      {"[prepare]\nnice = 2.5\n" + printer, "d.toml:2: prepare.nice: expected an integer"},
      {"[watch]\nfoo = 1\n" + printer, "d.toml:2: unknown key watch.foo"},
      {printer + "approve = \"yes\"\n",
       "d.toml:4: printer.m.approve: expected \"auto\" or \"ask\""},
      {printer + "simulated = \"true\"\n", "d.toml:4: printer.m.simulated: expected true or false"},
      {printer + "set = [1]\n", "d.toml:4: printer.m.set: expected a list of texts"},
      {printer + "set = [\"nonsense=1\"]\n", "d.toml:1: [printer.m]: "},
      {printer + "size_mm = 2\nscale = 3\n", "cannot have both size_mm and scale"},
      {printer + "handoff_folder = \"/x\"\n", "cannot have a handoff_folder"},
      {"[printer.m]\nprofile = \"marlin\"\n", "d.toml:1: [printer.m] needs the key port"},
      {"[printer.m]\nport = \"/dev/x\"\n", "d.toml:1: [printer.m] needs the key profile"},
      {"[printer.m]\nprofile = \"nosuch\"\nport = \"/dev/x\"\n", "d.toml:1: [printer.m]: "},
      {"[printer.o]\nprofile = \"objet30\"\n", "needs the key handoff_folder"},
      {"[printer.\"a/b\"]\n", "expected a name of letters"},
      {"[printer.\"..\"]\n", "expected a name of letters"},
      {printer + "[printer.n]\nprofile = \"marlin\"\nport = \"/dev/ttyUSB0\"\n",
       "d.toml:4: [printer.n] has the port of another printer"},
      {"socket = \"/" + std::string(200, 'x') + "\"\n" + printer, "d.toml:1: socket: expected"},
      {printer + "prefer = \"cheapest\"\n", "has a prefer without profile = \"auto\""},
      {printer + "[printer.any]\nprofile = \"auto\"\nport = \"/dev/x\"\n",
       "d.toml:4: [printer.any] stands for all printers"},
      {printer + "[printer.any]\nprofile = \"auto\"\nprefer = \"best\"\n",
       "d.toml:6: printer.any.prefer: expected \"cheapest\" or \"soonest\""},
      {printer + "[printer.any]\nprofile = \"auto\"\nset = [\"nonsense=1\"]\n",
       "d.toml:4: [printer.any], for m: "},
      {"[printer.any]\nprofile = \"auto\"\n", "compares the printers, and there is none"},
      {printer + "set = [\"cost.currency=USD\"]\n[printer.o]\nprofile = \"objet30\"\n"
                 "handoff_folder = \"/x\"\n[printer.any]\nprofile = \"auto\"\n",
       "cannot tell the cheapest: GBP and USD are two currencies"},
      {"[printer.m\n", "d.toml:1: "},
      {"webhook = 1\n" + printer, "d.toml:1: webhook: expected tables [[webhook]]"},
      {"[[webhook]]\nsecret = \"x\"\n", "d.toml:1: [[webhook]] needs the key url"},
      {"[[webhook]]\nurl = \"ftp://x/\"\n", "d.toml:2: webhook.url: expected an address"},
      {"[[webhook]]\nurl = \"http://x y/\"\n", "d.toml:2: webhook.url: expected an address"},
      {"[[webhook]]\nurl = \"http://x/\"\nkey = 1\n", "d.toml:3: unknown key webhook.key"},
      {"[mqtt]\ntopic = \"a\"\n", "d.toml:1: [mqtt] needs the key broker"},
      {"[mqtt]\nbroker = \"mqtt://x\"\n", "d.toml:2: mqtt.broker: expected HOST"},
      {"[mqtt]\nbroker = \"x\"\ntopic = \"a/#\"\n", "d.toml:3: mqtt.topic: expected a topic"},
      {"[mqtt]\nbroker = \"x\"\npassword_file = \"none\"\n", "d.toml:3: mqtt.password_file:"},
  };
  for (const auto& [text, expected] : cases)
    EXPECT_THAT(refusal(text), HasSubstr(expected)) << text;
}

TEST_F(ConfigTest, NamesWhoIsTold) {
  std::ofstream(folder_.path() / "word") << "pass word\nmore\n";
  std::ofstream(folder_.path() / "n.toml") << R"(state = "s"
[[webhook]]
url = "https://a.example/x"
secret = "y"
[[webhook]]
url = "http://b.example/"
[mqtt]
broker = "c.example:99"
topic = "a/b"
user = "me"
password_file = "word"
tls = true
ca_file = "ca.pem"
)";
  const DaemonConfig config = read_config(folder_.path() / "n.toml");
  ASSERT_EQ(config.webhooks.size(), 2U);
  EXPECT_EQ(config.webhooks[0].secret, "y");
  EXPECT_EQ(config.webhooks[1].url, "http://b.example/");
  EXPECT_EQ(config.mqtt.broker, "c.example:99");
  EXPECT_EQ(config.mqtt.topic, "a/b");
  EXPECT_EQ(config.mqtt.password, "pass word");
  EXPECT_TRUE(config.mqtt.tls);
  EXPECT_EQ(config.mqtt.ca_file, (folder_.path() / "ca.pem").string());
}

TEST_F(ConfigTest, ModelsOfThreadArePreparedTheCheapestWay) {
  std::ofstream(folder_.path() / "v.toml") << R"(state = "s"
[printer.fdm]
profile = "marlin"
port = "/dev/null"
[printer.named]
profile = "marlin"
port = "/dev/zero"
variant = "packed"
[printer.jet]
profile = "objet30"
handoff_folder = "out"
)";
  const DaemonConfig config = read_config(folder_.path() / "v.toml");
  EXPECT_EQ(config.printer("fdm")->options.variant, "cheapest");
  EXPECT_EQ(config.printer("named")->options.variant, "packed");
  EXPECT_EQ(config.printer("jet")->options.variant, std::nullopt) << "prepare's own default";
}

TEST_F(ConfigTest, PrintersMayComeLater) {
  std::ofstream(folder_.path() / "none-yet.toml") << "state = \"s\"\n";
  EXPECT_TRUE(read_config(folder_.path() / "none-yet.toml").printers.empty());
}

TEST_F(ConfigTest, TheSocketLiesInTheServicesRuntimeFolder) {
  std::ofstream(folder_.path() / "r.toml") << "state = \"s\"\n";
  setenv("RUNTIME_DIRECTORY", "/run/packmerger", 1);
  const DaemonConfig config = read_config(folder_.path() / "r.toml");
  unsetenv("RUNTIME_DIRECTORY");
  EXPECT_EQ(config.socket, "/run/packmerger/packmergerd.sock");
  EXPECT_EQ(read_config(folder_.path() / "r.toml").socket, folder_.path() / "s/packmergerd.sock");
}

TEST_F(ConfigTest, AMissingFileIsNoInput) {
  try {
    read_config(folder_.path() / "none.toml");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.fault(), Fault::kNoInput);
  }
}

TEST_F(ConfigTest, TheManualNamesEveryKey) {
  const char* source = std::getenv("PACKMERGER_SOURCE");
  if (source == nullptr) GTEST_SKIP() << "PACKMERGER_SOURCE is not set; run it with ctest";
  std::ifstream file(fs::path(source) / "docs/DAEMON.md");
  std::stringstream text;
  text << file.rdbuf();
  for (const DaemonKey& key : daemon_keys())
    EXPECT_THAT(text.str(), HasSubstr("| `" + key.name + "` | " + key.expected)) << key.name;
}

}  // namespace
}  // namespace packmerger
