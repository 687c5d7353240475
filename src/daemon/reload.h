// Taking over changed settings while jobs run. Only the loop's thread uses it.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "daemon/jobs/job_manager.h"
#include "daemon/settings/config.h"
#include "daemon/workers/worker_threads.h"

namespace packmerger {

// The printers as they may be now.
struct Exchange {
  std::vector<PrinterConfig> printers;  // by name
  std::vector<std::string> changed;     // added, removed, or with other settings
  bool waits = false;                   // a busy printer keeps its old settings for now
};
Exchange exchanged(const std::vector<PrinterConfig>& now, const std::vector<PrinterConfig>& wanted,
                   const std::function<bool(const std::string&)>& is_busy);

// The keys and tables that differ, and count only for a daemon that is started with them.
std::vector<std::string> needing_restart(const DaemonConfig& now, const DaemonConfig& wanted);

class Reload {
 public:
  using Log = std::function<void(const std::string&)>;

  // read: the settings as they are now; throws Error where they cannot be used. config is changed
  // by the calls below alone; everything must outlive it.
  Reload(DaemonConfig& config, std::function<DaemonConfig()> read, const JobManager& job_manager,
         WorkerThreads& threads, Log log);

  // Reads the settings. A mistake is told, and the old ones stay.
  void read();

  // Exchanges the printers that changed and print nothing; the others follow in a later call.
  // Returns their names.
  std::vector<std::string> exchange_printers();

 private:
  DaemonConfig& config_;
  std::function<DaemonConfig()> read_;
  const JobManager& job_manager_;
  WorkerThreads& threads_;
  Log log_;
  std::optional<std::vector<PrinterConfig>> wanted_;  // while not all are exchanged
};

}  // namespace packmerger
