#include "daemon/reload.h"

#include <algorithm>
#include <map>
#include <set>

#include "base/error.h"

namespace packmerger {
namespace {

bool is_same(const PrinterConfig& a, const PrinterConfig& b) {
  return a.profile == b.profile && a.folder == b.folder && a.port == b.port &&
         a.handoff_folder == b.handoff_folder && a.approve == b.approve &&
         a.simulated == b.simulated && a.prefer == b.prefer && a.options == b.options &&
         profile_toml(a.abilities) == profile_toml(b.abilities);
}

std::map<std::string, const PrinterConfig*> by_name(const std::vector<PrinterConfig>& printers) {
  std::map<std::string, const PrinterConfig*> names;
  for (const PrinterConfig& printer : printers) names[printer.name] = &printer;
  return names;
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

Exchange exchanged(const std::vector<PrinterConfig>& now, const std::vector<PrinterConfig>& wanted,
                   const std::function<bool(const std::string&)>& is_busy) {
  auto olds = by_name(now);
  auto news = by_name(wanted);
  std::set<std::string> names;
  for (const auto& [name, printer] : olds) names.insert(name);
  for (const auto& [name, printer] : news) names.insert(name);
  Exchange result;
  for (const std::string& name : names) {
    const PrinterConfig* before = olds[name];
    const PrinterConfig* after = news[name];
    const bool same = before != nullptr && after != nullptr && is_same(*before, *after);
    const bool busy = before != nullptr && is_busy(name);
    if (!same && !busy) result.changed.push_back(name);
    if (!same && busy) result.waits = true;
    if (const PrinterConfig* printer = same || busy ? before : after)
      result.printers.push_back(*printer);
  }
  return result;
}

std::vector<std::string> needing_restart(const DaemonConfig& now, const DaemonConfig& wanted) {
  std::vector<std::string> keys;
  if (now.state != wanted.state) keys.emplace_back("state");
  if (now.socket != wanted.socket) keys.emplace_back("socket");
  if (now.socket_mode != wanted.socket_mode) keys.emplace_back("socket_mode");
  return keys;
}

Reload::Reload(DaemonConfig& config, std::function<DaemonConfig()> read,
               const JobManager& job_manager, WorkerThreads& threads, Log log)
    : config_(config),
      read_(std::move(read)),
      job_manager_(job_manager),
      threads_(threads),
      log_(std::move(log)) {}

// What other threads read is left as it is: the web server has a copy of its settings.
void Reload::read() {
  try {
    DaemonConfig wanted = read_();
    if (const auto keys = needing_restart(config_, wanted); !keys.empty())
      log_("warning: a change of " + joined(keys) + " counts when the daemon is started again");
    config_.keep_days = wanted.keep_days;
    config_.keep_jobs = wanted.keep_jobs;
    config_.prepare = wanted.prepare;
    config_.watch = wanted.watch;
    config_.web = wanted.web;
    config_.webhooks = wanted.webhooks;
    config_.mqtt = wanted.mqtt;
    config_.retry_s = wanted.retry_s;
    wanted_ = std::move(wanted.printers);
    log_("settings read again");
  } catch (const Error& error) {
    log_(std::string("the settings stay as they were: ") + error.what() + ". " + error.hint());
  }
}

std::vector<std::string> Reload::exchange_printers() {
  if (!wanted_) return {};
  Exchange exchange = exchanged(config_.printers, *wanted_, [&](const std::string& name) {
    return job_manager_.sending_at(name) != 0;
  });
  for (const std::string& name : exchange.changed)
    if (config_.printer(name) != nullptr) threads_.end_sender(name);
  config_.printers = std::move(exchange.printers);
  for (const std::string& name : exchange.changed) {
    const PrinterConfig* printer = config_.printer(name);
    if (printer != nullptr) threads_.start_sender(*printer);
    log_("printer " + name + (printer != nullptr ? ": settings taken over" : ": removed"));
  }
  if (!exchange.waits) wanted_.reset();
  return exchange.changed;
}

}  // namespace packmerger
