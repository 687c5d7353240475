#include "daemon/notifier.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/json_values.h"
#include "base/names.h"
#include "base/time/wall_clock.h"
#include "daemon/views/job_view.h"
#include "daemon/views/printer_view.h"

namespace packmerger {
namespace {

using nlohmann::json;

constexpr double kLookEvery_s = 0.5;  // at the printers
constexpr std::array<const char*, 2> kOfEachTry = {"tries", "next_s"};

}  // namespace

Notifier::Notifier(const DaemonConfig& config, JobManager& job_manager, JobStore& store, Log log)
    : config_(config),
      job_manager_(job_manager),
      store_(store),
      log_(std::move(log)),
      dead_(config.state / "undelivered.jsonl") {
  follow_settings();
  store_.listen([this](const JobRecord& job, std::string_view note) {
    if (has_readers() && job.state != JobState::kClaiming)
      jobs_.push_back({job, std::string(note), unix_now_s()});
  });
}

Notifier::~Notifier() {
  store_.listen({});
  tell_jobs();
}

void Notifier::add_to(std::vector<pollfd>& waiting) const {
  waiting.push_back({lines_.fd(), POLLIN, 0});
}

void Notifier::serve(double now_s) {
  while (const std::optional<std::string> line = lines_.try_pop()) log_(*line);
  follow_settings();
  note_troubles();
  if (!has_readers()) return;
  tell_jobs();
  if (now_s - told_s_ < kLookEvery_s) return;
  told_s_ = now_s;
  tell_printers();
}

void Notifier::follow_settings() {
  const TellLine tell = [this](const std::string& line) { lines_.push(line); };
  const auto is_wanted = [&](const WebhookSettings& settings) {
    return std::find(config_.webhooks.begin(), config_.webhooks.end(), settings) !=
           config_.webhooks.end();
  };
  webhooks_.remove_if([&](const Webhook& webhook) { return !is_wanted(webhook.settings()); });
  for (const WebhookSettings& settings : config_.webhooks)
    if (std::none_of(webhooks_.begin(), webhooks_.end(),
                     [&](const Webhook& webhook) { return webhook.settings() == settings; }))
      webhooks_.emplace_back(settings, dead_, tell);
  if (mqtt_ && mqtt_->settings() != config_.mqtt) mqtt_.reset();
  if (mqtt_ || config_.mqtt.broker.empty()) return;
  mqtt_.emplace(config_.mqtt, tell);
  printers_.clear();  // a broker is told everything
}

void Notifier::note_troubles() {
  Troubles troubles;
  const auto& settings = config_.webhooks;
  for (const Webhook& webhook : webhooks_) {
    const std::optional<Trouble> trouble = webhook.trouble();
    if (!trouble) continue;
    const auto at = std::find(settings.begin(), settings.end(), webhook.settings());
    const std::string number =
        settings.size() == 1 ? "" : std::to_string(at - settings.begin() + 1) + ", ";
    troubles["webhook " + number + webhook_place(webhook.settings().url)] = *trouble;
  }
  if (const std::optional<Trouble> trouble = mqtt_ ? mqtt_->trouble() : std::nullopt)
    troubles["MQTT broker " + printable(config_.mqtt.broker)] = *trouble;
  job_manager_.note_troubles("notifier", std::move(troubles));
}

void Notifier::tell_jobs() {
  for (const Line& line : std::exchange(jobs_, {}))
    tell({"printers/" + line.job.printer + "/job",
          json_text({{"event", "job"},
                     {"at_s", line.at_s},
                     {"note", line.note},
                     {"job", job_view(job_manager_, line.job)}})});
}

// That a print which could not be begun is tried again tells nobody anything new.
bool Notifier::is_tried_again(const PrinterConfig& printer) const {
  const auto job = store_.open_jobs().find(job_manager_.sending_at(printer.name));
  return job != store_.open_jobs().end() && JobManager::is_tried_again(job->second);
}

// How a print gets on is no change of state: pages watch that by /api/v1/events.
void Notifier::tell_printers() {
  forget_removed_printers();
  for (const PrinterConfig& printer : config_.printers) {
    json view = printer_view(job_manager_, printer);
    json& print = view["print"];
    view["stage"] = print.is_object() ? print["stage"] : json();
    view.erase("print");
    for (json& trouble : view["troubles"])
      for (const char* key : kOfEachTry) trouble.erase(key);
    json& told = printers_[printer.name];
    if (told.is_object() && is_tried_again(printer))
      for (const char* key : {"job", "bed", "stage"}) view[key] = told[key];
    if (told == view) continue;
    told = view;
    tell({"printers/" + printer.name,
          json_text({{"event", "printer"}, {"at_s", unix_now_s()}, {"printer", view}})});
  }
}

// A broker keeps what it was told until it is told nothing.
void Notifier::forget_removed_printers() {
  std::erase_if(printers_, [&](const auto& told) {
    if (config_.printer(told.first) != nullptr) return false;
    if (mqtt_) mqtt_->push({"printers/" + told.first, ""});
    if (mqtt_) mqtt_->push({"printers/" + told.first + "/job", ""});
    return true;
  });
}

void Notifier::tell(const Notice& notice) {
  for (Webhook& webhook : webhooks_) webhook.push(notice);
  if (mqtt_) mqtt_->push(notice);
}

}  // namespace packmerger
