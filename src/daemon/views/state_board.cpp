#include "daemon/views/state_board.h"

#include "base/json_values.h"
#include "daemon/views/daemon_view.h"
#include "daemon/views/job_view.h"
#include "daemon/views/printer_view.h"
#include "daemon/views/reply.h"

namespace packmerger {
namespace {

using nlohmann::json;

// The keys of `after` that are not, or are otherwise, in `before`. No view ever loses a key.
json changed_keys(const json& before, const json& after) {
  json changed = json::object();
  for (const auto& [key, value] : after.items()) {
    const auto found = before.find(key);
    if (found == before.end() || *found != value) changed[key] = value;
  }
  return changed;
}

// Takes what is now the view, and returns what is new about it.
json exchanged(json& view, json now) {
  json changed = changed_keys(view, now);
  if (!changed.empty()) view = std::move(now);
  return changed;
}

template <typename Key>
json list_of(const std::map<Key, json>& changed, const char* named) {
  json list = json::array();
  for (const auto& [key, change] : changed) {
    list.push_back(change);
    list.back()[named] = key;
  }
  return list;
}

}  // namespace

template <typename Key>
void StateBoard::Changes<Key>::add(const Key& key, const json& change) {
  if (change.empty()) return;
  json& known = changed.try_emplace(key, json::object()).first->second;
  known.update(change);
  gone.erase(key);
}

template <typename Key>
void StateBoard::Changes<Key>::take_away(const Key& key) {
  changed.erase(key);
  gone.insert(key);
}

std::string StateBoard::look() {
  look_at_jobs();
  look_at_printers();
  changed_storage_.update(exchanged(storage_, storage_view(job_manager_)));
  if (json now = troubles_view(job_manager_); now != troubles_) {
    troubles_ = std::move(now);
    changed_troubles_ = true;
  }
  json change = json::object();
  if (!changed_jobs_.changed.empty()) change["jobs"] = list_of(changed_jobs_.changed, "id");
  if (!changed_printers_.changed.empty())
    change["printers"] = list_of(changed_printers_.changed, "name");
  if (!changed_storage_.empty()) change["storage"] = changed_storage_;
  if (changed_troubles_) change["troubles"] = troubles_;
  if (!changed_jobs_.gone.empty()) change["gone"]["jobs"] = changed_jobs_.gone;
  if (!changed_printers_.gone.empty()) change["gone"]["printers"] = changed_printers_.gone;
  changed_jobs_ = {};
  changed_printers_ = {};
  changed_storage_ = json::object();
  changed_troubles_ = false;
  return change.empty() ? "" : json_text(change);
}

void StateBoard::look_at_jobs() {
  listed_.clear();
  const auto& open = job_manager_.store().open_jobs();
  for (auto job = open.rbegin(); job != open.rend(); ++job)
    if (!has_ended(job->second.state)) look_at(job->second);
  for (const auto& [key, job] : job_manager_.store().ended_jobs()) look_at(job);
  const std::set<std::int64_t> there(listed_.begin(), listed_.end());
  std::erase_if(jobs_, [&](const auto& item) {
    if (there.contains(item.first)) return false;
    changed_jobs_.take_away(item.first);
    return true;
  });
}

void StateBoard::look_at(const JobRecord& job) {
  json passing = passing_view(job_manager_, job);
  Shown& shown = jobs_[job.id];
  json changed = exchanged(shown.passing, std::move(passing));
  if (shown.edition != job.edition) changed.update(exchanged(shown.recorded, recorded_view(job)));
  shown.edition = job.edition;
  if (!changed.empty()) shown.text.clear();
  changed_jobs_.add(job.id, changed);
  listed_.push_back(job.id);
}

void StateBoard::look_at_printers() {
  std::set<std::string> there;
  for (const PrinterConfig& printer : job_manager_.config().printers) {
    there.insert(printer.name);
    changed_printers_.add(printer.name,
                          exchanged(printers_[printer.name], printer_view(job_manager_, printer)));
  }
  std::erase_if(printers_, [&](const auto& item) {
    if (there.contains(item.first)) return false;
    changed_printers_.take_away(item.first);
    return true;
  });
}

const std::string& StateBoard::text_of(const Shown& job) {
  if (job.text.empty()) {
    json view = job.recorded;
    view.update(job.passing);
    job.text = json_text(view);
  }
  return job.text;
}

std::string StateBoard::state() const {
  std::string jobs;
  for (const std::int64_t id : listed_) jobs += (jobs.empty() ? "" : ",") + text_of(jobs_.at(id));
  json printers = json::array();
  for (const auto& [name, view] : printers_) printers.push_back(view);
  return reply_with(R"({"jobs":[)" + jobs + R"(],"printers":)" + json_text(printers) +
                    R"(,"storage":)" + json_text(storage_) + R"(,"troubles":)" +
                    json_text(troubles_) + "}");
}

}  // namespace packmerger
