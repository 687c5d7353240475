// A settings file beside a model on its way through the daemon, and what lands beside it at the
// end.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/settings/model_options.h"
#include "unit/daemon/workshop.h"

namespace packmerger {
namespace {

using testing::Contains;
using testing::HasSubstr;

// Puts a settings file into a printer's folder; the model is to follow.
void settings(Workshop& shop, const std::string& name, const std::string& text) {
  std::ofstream(shop.config_.printer("sim")->folder / name) << text;
}

TEST(Settings, BesideAModelAreObeyedAndFiledWithIt) {
  Workshop shop;
  shop.config_.printers[2].options.size_mm = 10;
  settings(shop, "a.stl.toml", "scale = 2.5\ncopies = 4\n");
  const fs::path file = shop.drop("sim", "a.stl");
  EXPECT_FALSE(fs::exists(settings_beside(file))) << "it was taken with the model";
  const PrepareOrder order = shop.prepare_order().value();
  EXPECT_THAT(order.argv, Contains("2.5"));
  EXPECT_THAT(order.argv, Contains("--copies"));
  EXPECT_THAT(order.argv, testing::Not(Contains("--size"))) << "the model's scale counts";
  EXPECT_EQ(shop.view(1).at("settings"), "a.stl.toml");
  shop.prepare(order);
  std::ofstream(order.out / "preview.png") << "picture";
  shop.send_order("sim");
  shop.tell(SendEnded{1, SendOutcome::kDone, {}, ""});
  shop.run_the_folder_worker();
  const fs::path done = file.parent_path() / "done";
  EXPECT_EQ(read_file(done / "a.stl.toml", 100), "scale = 2.5\ncopies = 4\n");
  EXPECT_EQ(read_file(done / "a.stl.preview.png", 100), "picture");
  EXPECT_TRUE(fs::exists(done / "a.stl.result.json"));
}

TEST(Settings, WithAMistakeFailTheJobWithTheReasonBesideBoth) {
  Workshop shop;
  settings(shop, "a.stl.toml", "\nscael = 2\n");
  const fs::path file = shop.drop("sim", "a.stl");
  EXPECT_FALSE(shop.prepare_order());
  EXPECT_EQ(shop.job(1).state, JobState::kFailed);
  shop.job_manager_->advance(shop.now_s_);
  shop.run_the_folder_worker();
  const fs::path failed = file.parent_path() / "failed";
  EXPECT_TRUE(fs::exists(failed / "a.stl"));
  EXPECT_TRUE(fs::exists(failed / "a.stl.toml"));
  EXPECT_THAT(read_file(failed / "a.stl.reason.txt", 1000),
              HasSubstr("a.stl.toml:2: unknown key scael"));
  EXPECT_FALSE(fs::exists(failed / "a.stl.preview.png"));

  std::ofstream(failed / "a.stl.toml") << "scale = 2\n";  // mended, and tried again
  shop.job_manager_->again(1);
  shop.run_the_folder_worker();
  EXPECT_THAT(shop.prepare_order()->argv, Contains("--scale"));
  EXPECT_TRUE(fs::exists(failed / "a.stl.toml")) << "the filed one stays";
}

TEST(Settings, OfASecondModelOfTheSameNameGetItsNumber) {
  Workshop shop;
  for (int i = 0; i < 2; ++i) {
    settings(shop, "a.stl.toml", "nonsense" + std::to_string(i));
    shop.drop("sim", "a.stl");
    shop.job_manager_->advance(shop.now_s_);
    shop.run_the_folder_worker();
  }
  const fs::path failed = shop.config_.printer("sim")->folder / "failed";
  EXPECT_EQ(read_file(failed / "a.stl.toml", 100), "nonsense0");
  EXPECT_EQ(read_file(failed / "a (2).stl.toml", 100), "nonsense1");
}

TEST(Settings, BesideAProgramAreRefused) {
  Workshop shop;
  settings(shop, "a.gcode.toml", "scale = 2");
  shop.drop("sim", "a.gcode");
  EXPECT_EQ(shop.job(1).state, JobState::kFailed);
  EXPECT_THAT(shop.job(1).reason, HasSubstr("printed as it is"));
}

// Killed after the model was taken and before its settings were.
TEST(Settings, AreNotLeftBehindByAKill) {
  Workshop shop;
  settings(shop, "a.stl.toml", "copies = 2");
  JobRecord job;
  job.printer = "sim";
  job.name = "a.stl";
  job.origin = (shop.config_.printer("sim")->folder / "a.stl").string();
  job.with_settings = true;
  job = shop.store_->add(job);
  job.input = (shop.config_.state / "jobs/1/input/a.stl").string();
  shop.store_->save(job);
  fs::create_directories(fs::path(job.input).parent_path());
  std::ofstream(job.input) << "model";
  shop.start();
  EXPECT_THAT(shop.prepare_order()->argv, Contains("--copies"));
  EXPECT_FALSE(fs::exists(settings_beside(job.origin)));
}

TEST(Settings, OfAFolderDoNotCountForAnUpload) {
  Workshop shop;
  settings(shop, "a.stl.toml", "copies = 2");
  const fs::path file = shop.config_.state / "uploads" / "1";
  fs::create_directories(file.parent_path());
  std::ofstream(file) << "model";
  shop.job_manager_->uploaded({"sim", "a.stl", file});
  shop.job_manager_->advance(shop.now_s_);
  EXPECT_THAT(shop.prepare_order()->argv, testing::Not(Contains("--copies")));
  EXPECT_TRUE(fs::exists(shop.config_.printer("sim")->folder / "a.stl.toml"));
}

}  // namespace
}  // namespace packmerger
