// The checks that requests to the web server pass, its routes, and the streams of what changed.
#include <gtest/gtest.h>

#include <cctype>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "base/files.h"
#include "daemon/web/web_events.h"
#include "daemon/web/web_guard.h"
#include "daemon/web/web_routes.h"
#include "model/files/job_folder_names.h"

namespace packmerger {
namespace {

struct Door {
  TemporaryFolder folder;
  KeyRing keys{folder.path() / "keys.json"};
  std::string key = keys.add("me");
  WebGuard guard{{"printers.example"}, keys, true};

  int status(const HttpRequest& request, Access access, double now_s = 0) {
    const auto refusal = guard.refused(request, access, now_s);
    return refusal ? refusal->status : 200;
  }
};

HttpRequest request(std::vector<std::pair<std::string, std::string>> headers = {}) {
  HttpRequest request;
  request.method = "GET";
  request.path = "/";
  request.peer = "127.0.0.1";
  request.headers = std::move(headers);
  if (request.header("Host").empty()) request.headers.emplace_back("Host", "localhost:8080");
  return request;
}

TEST(WebGuard, OnlyKnownNamesLeadHere) {
  Door door;
  for (const char* host : {"localhost", "LOCALHOST:80", "127.0.0.1:8080", "192.168.1.7", "[::1]:80",
                           "printers.example:8080"})
    EXPECT_EQ(door.status(request({{"Host", host}}), Access::kOpen), 200) << host;
  for (const char* host : {"evil.example", "localhost.evil.example", "127.0.0.1.evil.example",
                           "printers.example.evil", "[evil]", ":80", "@localhost"})
    EXPECT_EQ(door.status(request({{"Host", host}}), Access::kOpen), 403) << host;
  HttpRequest none = request();
  none.headers.clear();
  EXPECT_EQ(door.status(none, Access::kOpen), 403);
}

TEST(WebGuard, ForeignPagesAreRefusedEvenWithAKey) {
  Door door;
  const auto from = [&](const char* origin) {
    return door.status(request({{"Origin", origin}, {"X-Api-Key", door.key}}), Access::kChange);
  };
  EXPECT_EQ(from("http://localhost:8080"), 200);
  for (const char* origin :
       {"null", "http://evil.example", "http://localhost", "http://localhost:8080.evil.example"})
    EXPECT_EQ(from(origin), 403) << origin;
}

TEST(WebGuard, ChangesNeedAKeyAndReadingFromElsewhereToo) {
  Door door;
  EXPECT_EQ(door.status(request(), Access::kRead), 200);
  EXPECT_EQ(door.status(request(), Access::kChange), 401);
  HttpRequest far = request();
  far.is_loopback = false;
  EXPECT_EQ(door.status(far, Access::kRead), 401);
  EXPECT_EQ(door.status(far, Access::kOpen), 200);
  far.headers.emplace_back("Authorization", "Bearer " + door.key);
  EXPECT_EQ(door.status(far, Access::kRead), 200);
  for (const char* header : {"X-Forwarded-For", "Forwarded", "Via"})
    EXPECT_EQ(door.status(request({{header, "10.0.0.9"}}), Access::kRead), 401) << header;
  EXPECT_EQ(door.status(request({{"X-Api-Key", "wrong"}}), Access::kRead), 401)
      << "a wrong key is told, where none would be needed too";
}

TEST(WebGuard, WrongKeysAreSlowedDownAndNeverShutOutTheRightOnes) {
  Door door;
  const HttpRequest wrong = request({{"X-Api-Key", "pm_guess"}});
  const HttpRequest right = request({{"X-Api-Key", door.key}});
  for (int i = 0; i < 10; ++i) EXPECT_EQ(door.status(wrong, Access::kChange, i * 0.1), 401);
  EXPECT_EQ(door.status(wrong, Access::kChange, 2), 429);
  EXPECT_EQ(door.status(right, Access::kChange, 2), 200);
  EXPECT_EQ(door.status(request(), Access::kRead, 2), 200) << "the page beside the daemon, no key";
  HttpRequest elsewhere = wrong;
  elsewhere.peer = "10.0.0.3";
  EXPECT_EQ(door.status(elsewhere, Access::kChange, 2), 401);
  EXPECT_EQ(door.status(wrong, Access::kChange, 63), 401) << "forgotten after a minute";
}

TEST(WebGuard, WhereThisMachineIsNotTrustedNobodyReadsWithoutAKey) {
  Door door;
  WebGuard guard({}, door.keys, false);
  const auto status = [&](const HttpRequest& asked, Access access) {
    const auto refusal = guard.refused(asked, access, 0);
    return refusal ? refusal->status : 200;
  };
  EXPECT_EQ(status(request(), Access::kRead), 401)
      << "a proxy that adds no header looks like somebody on this machine";
  EXPECT_EQ(status(request(), Access::kOpen), 200);
  EXPECT_EQ(status(request({{"X-Api-Key", door.key}}), Access::kRead), 200);
}

TEST(WebGuard, AKeyThatLooksChangesNothing) {
  Door door;
  const std::string key = *door.keys.look(door.keys.add_code(0), 0);
  EXPECT_EQ(door.status(request({{"X-Api-Key", key}}), Access::kRead), 200);
  EXPECT_EQ(door.status(request({{"X-Api-Key", key}}), Access::kChange), 401);
}

TEST(WebGuard, ManySendersDoNotFillTheMemory) {
  Door door;
  HttpRequest wrong = request({{"X-Api-Key", "pm_guess"}});
  for (int i = 0; i < 5000; ++i) {
    wrong.peer = "10.0." + std::to_string(i / 256) + "." + std::to_string(i % 256);
    EXPECT_EQ(door.status(wrong, Access::kChange, 1), 401);
  }
}

TEST(WebRoutes, EachIsFoundByItsMethodAndPath) {
  for (const WebRouteText& text : web_routes()) {
    HttpRequest asked = request();
    asked.method = text.method;
    asked.path = text.path;
    for (const auto& [name, value] :
         {std::pair{"{id}", "7"}, std::pair{"{name}", "objet"}, std::pair{"{file}", "job.json"}})
      if (const auto at = asked.path.find(name); at != std::string::npos)
        asked.path.replace(at, std::string(name).size(), value);
    const WebRoute route = route_of(asked);
    EXPECT_NE(route.target, WebTarget::kNone) << asked.path;
    EXPECT_EQ(route.access, text.access);
    const bool reads = text.method == "GET";
    const Access needed = reads ? Access::kRead : Access::kChange;
    EXPECT_EQ(text.access, text.path.ends_with("/look") ? Access::kOpen : needed)
        << "changes need a key";
    asked.method = "PATCH";
    EXPECT_EQ(route_of(asked).target, WebTarget::kNone);
    EXPECT_NE(route_of(asked).allowed.find(text.method), std::string::npos);
  }
  HttpRequest unknown = request();
  unknown.path = "/api/v1/keys";
  EXPECT_EQ(route_of(unknown).target, WebTarget::kNone) << "keys are the shell's alone";
}

TEST(WebRoutes, AreThoseOfTheDocument) {
  const char* source = std::getenv("PACKMERGER_SOURCE");
  if (source == nullptr) GTEST_SKIP() << "PACKMERGER_SOURCE is not set; run it with ctest";
  const nlohmann::json document =
      nlohmann::json::parse(read_file(fs::path(source) / "docs/openapi.json", 1 << 20));
  std::set<std::string> told;
  for (const auto& [path, methods] : document.at("paths").items())
    for (const auto& [method, operation] : methods.items()) told.insert(method + " " + path);
  std::set<std::string> known;
  for (WebRouteText route : web_routes()) {
    for (char& c : route.method) c = static_cast<char>(std::tolower(c));
    known.insert(route.method + " " + route.path);
  }
  EXPECT_EQ(told, known);
}

TEST(WebRoutes, OnlyFilesOfAJobFolderAreShown) {
  for (const char* name :
       {"job.json", "preview.png", "assembly.glb", "page.glb", "tray.3mf", "tray-2.stl",
        "program.gcode", "program-3.x3g", "01.stl", "profile.toml"})
    EXPECT_TRUE(is_job_file(name)) << name;
  for (const char* name : {"", ".", "..", "input", "x.stl", "tray-.stl", "job.json\n", "01.stl.txt",
                           "../job.json", "jobs.sqlite", "preview.pngx"})
    EXPECT_FALSE(is_job_file(name)) << name;
}

// What the loop tells when it looked and found the state with this name.
void look(WebEvents& events, const std::string& change, const std::string& state) {
  events.publish(change, [&] { return state; });
}

TEST(WebEvents, TellTheStateNowAndEveryChange) {
  WebEvents events;
  EXPECT_FALSE(events.watched());
  look(events, "", "1");
  auto stream = events.stream();
  EXPECT_TRUE(events.watched());
  std::thread later([&] { look(events, "+", "2"); });
  EXPECT_EQ(stream(), "event: state\ndata: 2\n\n") << "what was published before it began is old";
  later.join();
  look(events, "+", "3");
  EXPECT_EQ(stream(), "event: state\ndata: 3\n\n");
  events.close();
  EXPECT_EQ(stream(), std::nullopt);
  stream = nullptr;
  EXPECT_FALSE(events.watched());
}

TEST(WebEvents, AStreamThatBeginsIsToldTheStateAlthoughItIsTheSame) {
  WebEvents events;
  EXPECT_FALSE(events.take_begun());
  look(events, "", "1");
  auto stream = events.stream();
  EXPECT_TRUE(events.take_begun());
  EXPECT_FALSE(events.take_begun());
  look(events, "", "1");
  EXPECT_EQ(stream(), "event: state\ndata: 1\n\n");
}

// "event: NAME", its number, and what it tells.
struct Told {
  std::string name;
  std::string id;
  std::string data;
};
std::vector<Told> told(const std::optional<std::string>& text) {
  std::vector<Told> events;
  std::istringstream lines(text.value_or(""));
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("event: ")) events.push_back({line.substr(7), "", ""});
    if (line.starts_with("id: ")) events.back().id = line.substr(4);
    if (line.starts_with("data: ")) events.back().data = line.substr(6);
  }
  return events;
}
int number_in(const std::string& id) { return std::stoi(id.substr(id.find('.') + 1)); }

TEST(WebEvents, ChangesAreNumberedFromTheStateOn) {
  WebEvents events;
  look(events, "a", "1");
  auto stream = events.changes("");
  look(events, "b", "2");
  const auto first = told(stream());
  ASSERT_EQ(first.size(), 1U);
  EXPECT_EQ(first[0].name + first[0].data, "state2");
  look(events, "c", "never asked for");
  look(events, "", "never asked for");
  look(events, "d", "never asked for");
  const auto then = told(stream());
  ASSERT_EQ(then.size(), 2U);
  EXPECT_EQ(then[0].name + then[0].data + then[1].data, "deltacd");
  EXPECT_EQ(number_in(then[0].id), number_in(first[0].id) + 1);
  EXPECT_EQ(number_in(then[1].id), number_in(first[0].id) + 2);
}

TEST(WebEvents, TheStateIsMadeForThoseAloneWhoWantIt) {
  WebEvents events;
  const auto never = []() -> std::string { throw std::logic_error("made for nobody"); };
  events.publish("a", never);
  auto changes = events.changes("");
  look(events, "b", "2");
  events.publish("c", never);
  auto states = events.stream();
  look(events, "d", "3");
  EXPECT_EQ(states(), "event: state\ndata: 3\n\n");
  look(events, "e", "4");
  EXPECT_EQ(states(), "event: state\ndata: 4\n\n");
  events.publish("", never);
  states = nullptr;
  events.publish("f", never);
}

TEST(WebEvents, WhoComesBackGoesOnWhereNothingWasMissed) {
  WebEvents events;
  auto stream = events.changes("");
  look(events, "a", "1");
  const std::string id = told(stream()).at(0).id;
  stream = nullptr;
  look(events, "b", "2");
  stream = events.changes(id);
  EXPECT_TRUE(told(stream()).empty()) << "it hears at once that it goes on";
  EXPECT_EQ(told(stream()).at(0).data, "b");
  for (int i = 0; i < 1000; ++i) look(events, "c", "3");
  EXPECT_TRUE(told(stream()).empty()) << "too far behind";
  EXPECT_TRUE(events.take_begun());
  look(events, "", "4");
  const Told state = told(stream()).at(0);
  EXPECT_EQ(state.name + state.data, "state4");
}

TEST(WebEvents, AnIdOfAnotherDaemonOrOfNobodyBeginsWithTheState) {
  WebEvents other;
  auto before = other.changes("");
  look(other, "a", "1");
  const std::string foreign = told(before()).at(0).id;
  WebEvents events;
  for (const std::string& id : {foreign, std::string("7"), std::string("x.1"), foreign + "9"}) {
    auto stream = events.changes(id);
    look(events, "b", "2");
    EXPECT_EQ(told(stream()).at(0).name, "state") << id;
  }
  auto stream = events.changes("");
  look(events, "c", "3");
  const std::string own = told(stream()).at(0).id;
  for (const std::string& id : {own.substr(0, own.rfind('.') + 1), own + "99999999999999999999"}) {
    auto malformed = events.changes(id);
    look(events, "c", "3");
    EXPECT_EQ(told(malformed()).at(0).name, "state") << id;
  }
  auto later = events.changes(own + "0");
  look(events, "d", "4");
  EXPECT_EQ(told(later()).at(0).name, "state") << "a number that was not reached yet";
}

TEST(WebEvents, AreForSoManyPagesAtATime) {
  WebEvents events;
  std::vector<std::function<std::optional<std::string>()>> streams;
  while (streams.size() < 100) {
    streams.push_back(events.stream());
    if (!streams.back()) break;
  }
  EXPECT_LT(streams.size(), 100u);
  streams.clear();
  EXPECT_TRUE(events.stream());
}

}  // namespace
}  // namespace packmerger
