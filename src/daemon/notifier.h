// Tells others what changed: webhooks and an MQTT broker get a message for every line that is
// written into a job's history, and for every change of a printer. Only the loop's thread uses it.
#pragma once

#include <poll.h>

#include <functional>
#include <list>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/queue.h"
#include "daemon/jobs/job_manager.h"
#include "daemon/settings/config.h"
#include "job/store/job_store.h"
#include "notify/mqtt.h"
#include "notify/webhook.h"

namespace packmerger {

class Notifier {
 public:
  using Log = std::function<void(const std::string&)>;

  // Listens to the store. Everything must outlive it. Does nothing where the settings name nobody.
  Notifier(const DaemonConfig& config, JobManager& job_manager, JobStore& store, Log log);
  Notifier(const Notifier&) = delete;
  Notifier& operator=(const Notifier&) = delete;
  ~Notifier();  // tells what is left, for some seconds at most

  // What to poll for before the next serve().
  void add_to(std::vector<pollfd>& waiting) const;

  // Hands over what changed, and takes over changed settings. Never waits for anybody but a
  // receiver that the settings name no more.
  void serve(double now_s);

 private:
  struct Line {
    JobRecord job;
    std::string note;
    double at_s = 0;
  };

  bool has_readers() const { return !webhooks_.empty() || mqtt_; }
  void follow_settings();
  void tell_jobs();
  void tell_printers();
  void forget_removed_printers();
  void tell(const Notice& notice);
  void note_troubles();
  bool is_tried_again(const PrinterConfig& printer) const;

  const DaemonConfig& config_;
  JobManager& job_manager_;
  JobStore& store_;
  Log log_;
  Queue<std::string> lines_;  // for the log, from other threads
  DeadLetters dead_;
  std::list<Webhook> webhooks_;
  std::optional<Mqtt> mqtt_;
  std::vector<Line> jobs_;                          // not told yet
  std::map<std::string, nlohmann::json> printers_;  // as they were told last
  double told_s_ = 0;
};

}  // namespace packmerger
