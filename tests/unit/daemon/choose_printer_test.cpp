#include "daemon/jobs/choose_printer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "unit/daemon/workshop.h"

namespace packmerger {
namespace {

PrinterOffer offer(const std::string& name, double time_s, double cost, double waits_s = 0) {
  PrinterOffer offer;
  offer.printer = name;
  offer.time_s = time_s;
  offer.cost = cost;
  offer.waits_s = waits_s;
  return offer;
}

TEST(ChoosePrinter, TheCheapestOrTheSoonest) {
  const std::vector<PrinterOffer> offers = {offer("slow", 100, 1), offer("busy", 10, 2, 500),
                                            offer("dear", 50, 9)};
  EXPECT_EQ(best_offer(offers, Prefer::kCheapest), 0U);
  EXPECT_EQ(best_offer(offers, Prefer::kSoonest), 2U);
}

TEST(ChoosePrinter, WhatCannotStartNowComesLastWhereItHasToBeSoon) {
  std::vector<PrinterOffer> offers = {offer("off", 10, 1), offer("on", 500, 5)};
  offers[0].trouble = "not connected";
  EXPECT_EQ(best_offer(offers, Prefer::kSoonest), 1U);
  EXPECT_EQ(best_offer(offers, Prefer::kCheapest), 0U);
  offers[1].why_not = "too large";
  EXPECT_EQ(best_offer(offers, Prefer::kSoonest), 0U);
  offers[0].why_not = "too large too";
  EXPECT_FALSE(best_offer(offers, Prefer::kSoonest));
  EXPECT_EQ(reasons_of(offers), "off: too large too; on: too large");
  EXPECT_FALSE(best_offer({}, Prefer::kCheapest));
}

TEST(ChoosePrinter, NoOfferBeatsTheChosenOne) {
  EXPECT_TRUE(rc::check([] {
    std::vector<PrinterOffer> offers;
    for (int i = 0, n = *rc::gen::inRange(1, 9); i < n; ++i) {
      offers.push_back(offer("p" + std::to_string(i), *rc::gen::inRange(1, 20),
                             *rc::gen::inRange(1, 20), *rc::gen::inRange(0, 20)));
      if (*rc::gen::arbitrary<bool>()) offers.back().why_not = "no";
    }
    for (const Prefer prefer : {Prefer::kCheapest, Prefer::kSoonest}) {
      const auto best = best_offer(offers, prefer);
      for (const PrinterOffer& other : offers) {
        if (!other.fits()) continue;
        RC_ASSERT(best && offers[*best].fits());
        const PrinterOffer& chosen = offers[*best];
        const bool is_best = prefer == Prefer::kCheapest
                                 ? chosen.cost <= other.cost
                                 : chosen.ready_in_s() <= other.ready_in_s();
        RC_ASSERT(is_best);
      }
    }
  }));
}

TEST(ChoosePrinter, TakesTheWayThatWouldBePrepared) {
  const std::string ways = R"({"solid": {"fits": true, "time_s": 10, "cost": 3, "currency": "EUR"},
    "hollow": {"fits": false, "time_s": null, "cost": null},
    "packed": {"fits": true, "time_s": 20, "cost": 5, "parts": 4}})";
  PrinterOffer packed;
  take_estimates(packed, ways, "packed");
  EXPECT_EQ(packed.cost, 5);
  EXPECT_EQ(packed.parts, 4);
  PrinterOffer cheapest;
  take_estimates(cheapest, ways, "cheapest");
  EXPECT_EQ(cheapest.variant, "solid");
  EXPECT_EQ(cheapest.cost, 3);
  for (const auto& [text, variant] :
       {std::pair{ways, "hollow"}, std::pair{std::string("[]"), "packed"},
        std::pair{std::string("{}"), "cheapest"}, std::pair{std::string("x"), "packed"},
        std::pair{std::string(R"({"packed": {"time_s": "1", "cost": 1}})"), "packed"}}) {
    PrinterOffer none;
    take_estimates(none, text, variant);
    EXPECT_FALSE(none.fits()) << text;
  }
  PrinterOffer refused;
  take_estimates(refused, R"({"packed": {"fits": false, "reason": "No wall\u202e is kept"}})",
                 "packed");
  EXPECT_EQ(refused.why_not, "No wall? is kept");
}

// The workshop's printers and an entry that stands for them.
class AutoWorkshop : public Workshop {
 public:
  explicit AutoWorkshop(Prefer prefer, Approve approve = Approve::kAsk) {
    PrinterConfig any = printer(folder_.path(), "any", Dialect::kHandoff);
    any.profile = "auto";
    any.port.clear();
    any.handoff_folder.clear();
    any.prefer = prefer;
    any.approve = approve;
    config_.printers.insert(config_.printers.begin(), any);
    start();
  }

  // Each of the three is told to take so long and to cost so much.
  void compare(const PrepareOrder& order, const std::map<std::string, std::pair<int, int>>& told) {
    Compared compared{order.job, {}};
    for (const CompareOrder& each : order.compare) {
      const auto& [time_s, cost] = told.at(each.printer);
      compared.printers.push_back(
          {each.printer, each.variant,
           json{{"packed", {{"fits", true}, {"time_s", time_s}, {"cost", cost}}}}.dump(), ""});
    }
    tell(compared);
  }
};

const std::map<std::string, std::pair<int, int>> kFigures = {
    {"hand", {100, 3}}, {"real", {50, 2}}, {"sim", {60, 1}}};

TEST(AutoPrinter, ComparesAllAndProposesTheCheapest) {
  AutoWorkshop shop(Prefer::kCheapest);
  shop.config_.printers[3].options.scale = 2;
  shop.config_.printers[3].options.variant = "solid";
  std::ofstream(shop.config_.printer("any")->folder / "a.stl.toml") << "copies = 3\n";
  const fs::path file = shop.drop("any", "a.stl");
  const PrepareOrder order = shop.prepare_order().value();
  ASSERT_EQ(order.compare.size(), 3U);
  for (const CompareOrder& each : order.compare) {
    EXPECT_EQ(each.argv[1], "compare");
    EXPECT_THAT(each.argv, testing::Contains("--copies"));
    EXPECT_THAT(each.argv, testing::Not(testing::Contains("--variant")));
  }
  EXPECT_EQ(order.compare[2].variant, "solid");
  EXPECT_THAT(order.compare[2].argv, testing::Contains("--scale"));
  shop.tell(Hashed{1, "abc"});
  Compared compared{1, {}};
  compared.printers = {{"hand", "packed", "{}", "it is too large"},
                       {"real", "packed", R"({"packed":{"fits":true,"time_s":50,"cost":2}})", ""},
                       {"sim", "solid", R"({"solid":{"fits":true,"time_s":60,"cost":1}})", ""}};
  shop.tell(compared);
  EXPECT_EQ(shop.job(1).printer, "sim");
  EXPECT_EQ(shop.job(1).chosen_by, "any");
  const json choice = shop.view(1).at("choice");
  EXPECT_EQ(choice.at("chosen"), "sim");
  EXPECT_EQ(choice.at("printers").at(0).at("reason"), "it is too large");
  EXPECT_EQ(choice.at("printers").at(0).at("cost"), nullptr);
  EXPECT_EQ(choice.at("printers").at(1).at("cost"), 2);
  const PrepareOrder prepare = shop.prepare_order().value();
  EXPECT_TRUE(prepare.compare.empty());
  EXPECT_THAT(prepare.argv, testing::Contains("solid"));
  shop.prepare(prepare);
  EXPECT_EQ(shop.view(1).at("waits_for"), "approval") << "sim itself approves everything";
  shop.job_manager_->approve(1);
  shop.job_manager_->advance(shop.now_s_);
  shop.send_order("sim");
  shop.tell(SendEnded{1, SendOutcome::kDone, {}, ""});
  shop.run_the_folder_worker();
  const json note = json::parse(read_file(file.parent_path() / "done/a.stl.result.json", 100000));
  EXPECT_EQ(note.at("choice"), choice);
}

TEST(AutoPrinter, TheSoonestCountsWhatIsPrintingAndQueued) {
  AutoWorkshop shop(Prefer::kSoonest);
  shop.job_manager_->clear("real");
  shop.drop("real", "running.stl");
  shop.prepare(shop.prepare_order().value());
  shop.send_order("real");
  SendProgress progress = progress_of(1, PrintState::kPrinting);
  progress.report.remaining_s = 25;
  shop.tell(progress);
  shop.drop("real", "queued.stl");
  shop.prepare(shop.prepare_order().value());  // predicted: 60 s
  shop.drop("any", "a.stl");
  shop.compare(shop.prepare_order().value(), kFigures);
  const json printers = shop.view(3).at("choice").at("printers");
  EXPECT_EQ(printers.at(1).at("waits_s"), 25 + 60);
  EXPECT_EQ(printers.at(1).at("ready_in_s"), 25 + 60 + 50);
  EXPECT_EQ(shop.job(3).printer, "sim");
}

// Models are prepared one after the other, but programs are checked beside them.
TEST(AutoPrinter, TheSoonestCountsWhatIsStillBeingPrepared) {
  AutoWorkshop shop(Prefer::kSoonest);
  shop.drop("real", "before.gcode");
  ASSERT_TRUE(shop.check_order()) << "and its check takes its time";
  shop.drop("real", "held.gcode");
  shop.job_manager_->hold(2);
  shop.drop("any", "a.stl");
  const PrepareOrder order = shop.prepare_order().value();
  shop.drop("sim", "behind.stl");
  shop.compare(order, kFigures);
  const json printers = shop.view(3).at("choice").at("printers");
  EXPECT_EQ(printers.at(1).at("waits_s"), 50) << "one, as long as the model itself takes there";
  EXPECT_EQ(printers.at(2).at("waits_s"), 0) << "what came later waits behind it";
  EXPECT_EQ(shop.job(3).printer, "sim");
}

TEST(AutoPrinter, IsApprovedByItselfOnlyWhereBothAreConfiguredSo) {
  for (const auto& [wish, of_printer, expected] :
       {std::tuple{Approve::kAuto, Approve::kAuto, true},
        std::tuple{Approve::kAsk, Approve::kAuto, false},
        std::tuple{Approve::kAuto, Approve::kAsk, false}}) {
    AutoWorkshop shop(Prefer::kCheapest, wish);
    shop.config_.printers[3].approve = of_printer;
    shop.drop("any", "a.stl");
    shop.compare(shop.prepare_order().value(), kFigures);
    shop.prepare(shop.prepare_order().value());
    EXPECT_EQ(shop.send_order("sim").has_value(), expected);
  }
}

TEST(AutoPrinter, AKillWhileComparingComparesAgain) {
  AutoWorkshop shop(Prefer::kCheapest);
  shop.drop("any", "a.stl");
  EXPECT_TRUE(shop.prepare_order());
  shop.start();
  shop.compare(shop.prepare_order().value(), kFigures);
  shop.start();
  const PrepareOrder order = shop.prepare_order().value();
  EXPECT_TRUE(order.compare.empty()) << "what was chosen stays chosen";
  EXPECT_EQ(shop.job(1).printer, "sim");
}

TEST(AutoPrinter, CancelledWhileComparingItIsFiled) {
  AutoWorkshop shop(Prefer::kCheapest);
  const fs::path file = shop.drop("any", "a.stl");
  const PrepareOrder order = shop.prepare_order().value();
  shop.job_manager_->cancel(1);
  EXPECT_TRUE(*order.cancel);
  shop.tell(PrepareFailed{1, {Fault::kInterrupted, "Interrupted", ""}});
  shop.run_the_folder_worker();
  EXPECT_TRUE(fs::exists(file.parent_path() / "failed/a.stl"));
}

TEST(AutoPrinter, WhatFitsNoneFailsWithEveryReason) {
  AutoWorkshop shop(Prefer::kCheapest);
  shop.drop("any", "a.stl");
  shop.prepare_order();
  shop.tell(Compared{1, {{"real", "packed", "", "too tall"}, {"sim", "packed", "{}", ""}}});
  EXPECT_EQ(shop.job(1).state, JobState::kFailed);
  EXPECT_THAT(shop.job(1).reason, testing::HasSubstr("real: too tall; sim: it does not fit"));
}

TEST(AutoPrinter, TakesNoPrograms) {
  AutoWorkshop shop(Prefer::kCheapest);
  shop.drop("any", "a.gcode");
  EXPECT_EQ(shop.job(1).state, JobState::kFailed);
  EXPECT_THAT(shop.job(1).reason, testing::HasSubstr("made for one printer"));
}

}  // namespace
}  // namespace packmerger
