// What was prepared is what is sent: the hashes of a job's trays, from the worker to the sender.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "daemon/workers/worker.h"
#include "delivery/job_folder.h"
#include "delivery/send.h"
#include "fixtures/fault_of.h"
#include "model/files/job_folder_names.h"
#include "unit/daemon/workshop.h"

namespace packmerger {
namespace {

using fixtures::fault_of;
using testing::HasSubstr;

void write(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }

// A job folder of two trays.
void make_job(const fs::path& folder, const Profile& profile) {
  fs::create_directories(folder);
  write(folder / "job.json", R"({"version": 1, "variant": "packed",
    "inputs": [{"file": "bunny.stl", "sha256": "ab"}],
    "parts": [{"id": 1, "tray": 1}, {"id": 2, "tray": 2}], "estimates": {}})");
  write(folder / "profile.toml", profile_toml(profile));
  write(folder / "preview.png", "picture");
  for (const char* name : {"tray.stl", "tray-2.stl", "tray.3mf", "tray-2.3mf", "program.gcode",
                           "program-2.gcode", "program.x3g", "program-2.x3g"})
    write(folder / name, std::string("G28 ; ") + name + "\n");
}

Profile usb_profile() {
  Profile profile = read_profile("objet30");
  profile.dialect = Dialect::kUsb;
  profile.document = HandoffDocument::kTray3mf;
  return profile;
}

TEST(TrayFiles, AreWhatThePrinterIsGiven) {
  const auto files_of = [](const Profile& profile) {
    const TemporaryFolder folder;
    make_job(folder.path(), profile);
    const json files = json::parse(hash_trays(folder.path(), 2));
    for (const json& file : files)
      EXPECT_EQ(file.at("sha256"),
                sha256_hex("G28 ; " + file.at("file").get<std::string>() + "\n"));
    return files.at(0).at("file").get<std::string>() + " " +
           files.at(1).at("file").get<std::string>();
  };
  EXPECT_EQ(files_of(read_profile("marlin")), "program.gcode program-2.gcode");
  EXPECT_EQ(files_of(read_profile("replicator")), "program.x3g program-2.x3g");
  EXPECT_EQ(files_of(read_profile("objet30")), "tray.stl tray-2.stl");
  EXPECT_EQ(files_of(usb_profile()), "tray.3mf tray-2.3mf");
}

TEST(TrayFiles, AMissingOneIsTold) {
  const TemporaryFolder folder;
  make_job(folder.path(), read_profile("marlin"));
  EXPECT_EQ(fault_of([&] { hash_trays(folder.path(), 3); }), Fault::kNoInput);
}

TEST(TrayFiles, ARecordThatDoesNotTellOfATrayPermitsNothing) {
  EXPECT_EQ(hash_of_tray("", 1), "");
  EXPECT_EQ(hash_of_tray(R"([{"sha256": "a"}, {"sha256": "b"}])", 2), "b");
  for (const char* text : {R"([{"sha256": "a"}])", "[]", "{}", "null", "x", R"([1, 2])",
                           R"([{"sha256": "a"}, {"sha256": 7}])", R"([{}, {}])"})
    EXPECT_EQ(fault_of([&] { hash_of_tray(text, 2); }), Fault::kBadInput) << text;
}

// Without a port: kUnavailable means that the bytes were let through.
TEST(SendTray, SendsWhatWasPreparedOrNothing) {
  const TemporaryFolder folder;
  PrintControl control;
  for (const Profile& profile : {read_profile("marlin"), usb_profile()}) {
    const fs::path job = folder.path() / profile.id;
    make_job(job, profile);
    const std::string files = hash_trays(job, 2);
    const auto send = [&](int tray, const std::string& recorded) {
      return fault_of([&] {
        send_tray(job, tray, "usb:ffff:ffff", folder.path() / "told", {}, control, recorded);
      });
    };
    const fs::path second = job / tray_file(profile, 2);
    EXPECT_EQ(send(2, files), Fault::kUnavailable);
    const std::string bytes = read_file(second, 1000);
    write(second, bytes + "\n");
    EXPECT_EQ(send(2, files), Fault::kBadInput) << "one byte more";
    EXPECT_EQ(send(1, files), Fault::kUnavailable) << "the other tray is what it was";
    EXPECT_EQ(send(2, ""), Fault::kUnavailable) << "not known, nothing to compare";
    write(second, bytes);
    EXPECT_EQ(send(2, files), Fault::kUnavailable) << "its bytes count, not its time";
    fs::rename(job / tray_file(profile, 1), second);
    EXPECT_EQ(send(2, files), Fault::kBadInput) << "another tray's file";
    EXPECT_EQ(send(1, files), Fault::kNoInput);
    EXPECT_EQ(send(1, ""), Fault::kNoInput);
  }
}

TEST(HandOver, HandsOverWhatWasPreparedOrNothing) {
  const TemporaryFolder folder;
  const fs::path job = folder.path() / "job";
  const fs::path share = folder.path() / "share";
  fs::create_directory(share);
  make_job(job, read_profile("objet30"));
  const std::string files = hash_trays(job, 2);
  write(job / "tray-2.stl", "changed");
  EXPECT_EQ(fault_of([&] { hand_over(job, share, "bunny", files); }), Fault::kBadInput);
  EXPECT_TRUE(fs::is_empty(share)) << "the first tray neither";
  write(job / "tray-2.stl", "G28 ; tray-2.stl\n");
  const fs::path target = hand_over(job, share, "bunny", files);
  EXPECT_EQ(hand_over(job, share, "bunny", files), target) << "again, after a kill";
  fs::remove(target / "tray-2.stl");
  EXPECT_EQ(hand_over(job, share, "bunny", files), target) << "taken out meanwhile";
  write(target / "tray.stl", "changed");
  EXPECT_EQ(fault_of([&] { hand_over(job, share, "bunny", files); }), Fault::kBadInput)
      << "not said to be handed over";
}

// A workshop whose job 1 is prepared for a printer with a bed, in two trays.
class HashedJob : public testing::Test {
 protected:
  HashedJob() {
    shop_.drop("real", "a.stl");
    out_ = shop_.prepare_order()->out;
    make_job(out_, read_profile("marlin"));
    shop_.tell(Prepared{1, 2, "{}", "marlin", 1, "packed", 60, "slicer", "", hash_trays(out_, 2)});
  }

  void clear() {
    shop_.job_manager_->clear("real");
    shop_.job_manager_->advance(shop_.now_s_);
  }

  // Runs the printer's sender on its order; how that ended. Its port is no serial port: what is let
  // through is not started.
  SendOutcome send() {
    Queue<SendOrder> orders;
    Queue<Event> events;
    orders.push(shop_.send_order("real").value());
    orders.close();
    Pulse pulse;
    run_sender(orders, events, *shop_.config_.printer("real"), pulse);
    SendOutcome outcome = SendOutcome::kDone;
    while (const std::optional<Event> event = events.try_pop()) {
      if (const auto* ended = std::get_if<SendEnded>(&*event)) outcome = ended->outcome;
      shop_.tell(*event);
    }
    return outcome;
  }

  Workshop shop_;
  fs::path out_;
};

TEST_F(HashedJob, IsShownWithTheHashesOfItsTrays) {
  const json files = shop_.view(1).at("tray_files");
  ASSERT_EQ(files.size(), 2U);
  EXPECT_EQ(files[1].at("file"), "program-2.gcode");
  EXPECT_EQ(files[1].at("sha256"), sha256_hex("G28 ; program-2.gcode\n"));
  shop_.drop("sim", "b.stl");
  EXPECT_EQ(shop_.view(2).at("tray_files"), nullptr);
}

TEST_F(HashedJob, FailsWhereItsProgramWasChangedAndTheBedStaysClear) {
  shop_.start();  // the hashes are those of the first daemon
  write(out_ / "program.gcode", "G28\nM104 S999\n");
  clear();
  EXPECT_EQ(send(), SendOutcome::kFailed);
  const JobRecord job = shop_.job(1);
  EXPECT_EQ(job.state, JobState::kFailed);
  EXPECT_EQ(job.reason,
            "The file of tray 1, program.gcode, is not what was prepared (its bytes were changed)");
  EXPECT_THAT(job.hint, HasSubstr("drop its file again"));
  EXPECT_EQ(job.told_total, 0);
  EXPECT_TRUE(shop_.store_->printer("real").bed_clear) << "nothing was printed";
  shop_.run_the_folder_worker();
  EXPECT_TRUE(fs::exists(shop_.config_.printer("real")->folder / "failed/a.stl"));

  shop_.job_manager_->again(1);
  EXPECT_EQ(shop_.job(2).tray_files, shop_.job(1).tray_files);
  shop_.job_manager_->advance(shop_.now_s_);
  EXPECT_EQ(send(), SendOutcome::kFailed) << "the stored program is the changed one";
  EXPECT_EQ(shop_.job(2).state, JobState::kFailed);

  write(out_ / "program.gcode", "G28 ; program.gcode\n");
  shop_.job_manager_->again(2);
  shop_.job_manager_->advance(shop_.now_s_);
  EXPECT_EQ(send(), SendOutcome::kNotStarted) << "put back from a backup";
}

TEST_F(HashedJob, FailsAtALaterTrayToo) {
  clear();
  shop_.send_order("real");
  shop_.tell(SendEnded{1, SendOutcome::kDone, {}, ""});
  shop_.start();
  write(out_ / "program-2.gcode", "G28\n");
  EXPECT_FALSE(shop_.store_->printer("real").bed_clear);
  clear();
  EXPECT_EQ(send(), SendOutcome::kFailed);
  EXPECT_THAT(shop_.job(1).reason, HasSubstr("The file of tray 2, program-2.gcode, is not"));
  EXPECT_TRUE(shop_.store_->printer("real").bed_clear);
}

TEST_F(HashedJob, FailsWhereItsProgramIsGone) {
  fs::remove(out_ / "program.gcode");
  clear();
  EXPECT_EQ(send(), SendOutcome::kFailed);
  EXPECT_EQ(shop_.job(1).reason, "The file of tray 1, program.gcode, is not there any more");
  EXPECT_TRUE(shop_.store_->printer("real").bed_clear);
}

TEST_F(HashedJob, OfAnEarlierVersionIsNotKnownAndSent) {
  JobRecord job = shop_.job(1);
  job.tray_files.clear();
  shop_.store_->save(job);
  shop_.start();
  EXPECT_EQ(shop_.view(1).at("tray_files"), nullptr);
  write(out_ / "program.gcode", "G28\n");
  clear();
  EXPECT_EQ(send(), SendOutcome::kNotStarted);
}

TEST_F(HashedJob, HasTheKeysThatTheDocumentTells) {
  const char* source = std::getenv("PACKMERGER_SOURCE");
  if (source == nullptr) GTEST_SKIP() << "PACKMERGER_SOURCE is not set; run it with ctest";
  const json document = json::parse(read_file(fs::path(source) / "docs/openapi.json", 1 << 20));
  const json told = document.at("components").at("schemas").at("Job").at("properties");
  const json job = shop_.view(1);
  for (const auto& [key, meaning] : told.items())
    EXPECT_TRUE(job.contains(key) || key == "starts") << key;  // that one only what acts on a job
  for (const auto& [key, meaning] : told.at("tray_files").at("items").at("properties").items())
    EXPECT_TRUE(job.at("tray_files").at(0).contains(key)) << key;
  EXPECT_EQ(job.at("tray_files").at(0).size(), 2U);
}

}  // namespace
}  // namespace packmerger
