// The loop's side of the web server: opens it, answers what comes in through it, and tells the
// pages that watch what changed. Only the loop's thread uses it.
#pragma once

#include <poll.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/jobs/job_manager.h"
#include "daemon/keys/key_ring.h"
#include "daemon/views/state_board.h"
#include "daemon/web/web.h"
#include "notify/mdns.h"

namespace packmerger {

class WebService {
 public:
  using Log = std::function<void(const std::string&)>;

  // Everything must outlive it. Does nothing where the settings name no web.port. Uploads that a
  // daemon that died left behind are removed.
  WebService(const DaemonConfig& config, JobManager& job_manager, KeyRing& keys, Log log);
  WebService(const WebService&) = delete;
  WebService& operator=(const WebService&) = delete;
  ~WebService();  // ends every connection

  // What to poll for before the next serve().
  void add_to(std::vector<pollfd>& waiting) const;

  // A server that cannot listen is tried again, and told once. With the first key it goes from this
  // machine alone to the address of the settings; with other settings it is another server. While
  // other machines reach it, its printers are announced to them.
  void serve(double now_s);

 private:
  void open(double now_s);
  void tell_who_may_look();
  void close();
  void announce();
  void note_troubles();
  void answer_questions();
  void publish(double now_s);

  const DaemonConfig& config_;
  JobManager& job_manager_;
  KeyRing& keys_;
  Log log_;
  const std::string machine_;  // for the uuids that are announced
  WebQuestions questions_;
  StateBoard board_;
  WebEvents events_;
  Queue<std::string> lines_;  // for the log, from other threads
  std::unique_ptr<Web> web_;
  std::optional<Mdns> mdns_;
  Standing web_stands_;
  int failures_ = 0;  // to listen, one after the other
  double retry_s_ = 0;
  double published_s_ = 0;
  std::string told_;
};

}  // namespace packmerger
