#include "daemon/web/web_service.h"

#include <chrono>
#include <future>
#include <thread>

#include "base/error.h"
#include "base/files.h"
#include "base/time/backoff.h"
#include "daemon/keys/look_link.h"
#include "daemon/local/api.h"
#include "daemon/web/doors/door.h"
#include "daemon/web/web_guard.h"

namespace packmerger {
namespace {

constexpr double kPublishEvery_s = 0.25;

bool is_reached_by_others(const std::string& address) {
  return !address.starts_with("127.") && address != "::1";
}

// What tells this machine from others, for as long as it is installed.
std::string machine_id() {
  try {
    return read_file("/etc/machine-id", 64);
  } catch (const Error&) {
    return machine_name();
  }
}

// The same for this machine and printer always, and told by nothing else.
std::string uuid_of(const std::string& machine, const std::string& printer) {
  std::string text = sha256_hex("packmerger " + machine + " " + printer).substr(0, 32);
  for (const std::size_t at : {20, 16, 12, 8}) text.insert(at, "-");
  return text;
}

MdnsService service_of(const PrinterConfig& printer, int port, const std::string& machine) {
  return {printer.name + " (PackMerger on " + machine_name() + ")",
          static_cast<std::uint16_t>(port),
          {"path=/printers/" + printer.name, std::string("version=") + kOctoprintVersion,
           std::string("api=") + kOctoprintApi, "uuid=" + uuid_of(machine, printer.name),
           "model=" + printer.abilities.id, "vendor=PackMerger"}};
}

}  // namespace

WebService::WebService(const DaemonConfig& config, JobManager& job_manager, KeyRing& keys, Log log)
    : config_(config),
      job_manager_(job_manager),
      keys_(keys),
      log_(std::move(log)),
      machine_(machine_id()),
      board_(job_manager) {
  std::error_code ignored;
  fs::remove_all(uploads_folder(config), ignored);
}

// The connections' threads may still wait for an answer: a closed queue breaks their promises.
WebService::~WebService() {
  events_.close();
  questions_.close();
  while (questions_.try_pop()) {
  }
  web_.reset();
}

void WebService::add_to(std::vector<pollfd>& waiting) const {
  waiting.push_back({questions_.fd(), POLLIN, 0});
  waiting.push_back({lines_.fd(), POLLIN, 0});
  waiting.push_back({events_.fd(), POLLIN, 0});
}

void WebService::serve(double now_s) {
  while (const std::optional<std::string> line = lines_.try_pop()) log_(*line);
  answer_questions();
  if (web_ && web_->config() != config_.web) {
    close();
    retry_s_ = 0;
    web_stands_.works();
    if (config_.web.port == 0) log_("web server ended");
  }
  if (config_.web.port != 0) open(now_s);
  announce();
  note_troubles();
  publish(now_s);
}

void WebService::note_troubles() {
  Troubles troubles;
  const bool is_wanted = config_.web.port != 0;
  if (const auto trouble = web_stands_.trouble(); trouble && is_wanted)
    troubles["web server"] = *trouble;
  if (const auto trouble = mdns_ ? mdns_->trouble() : std::nullopt)
    troubles["announcing printers (mDNS)"] = *trouble;
  job_manager_.note_troubles("web service", std::move(troubles));
}

void WebService::open(double now_s) {
  const bool is_elsewhere = web_ && !keys_.empty() && web_->address() != config_.web.address;
  if (now_s < retry_s_ || (web_ && !is_elsewhere)) return;
  try {
    fs::create_directories(uploads_folder(config_));
    // others may enter a state folder of before
    fs::permissions(uploads_folder(config_), fs::perms::owner_all);
    close();
    web_ = std::make_unique<Web>(config_, keys_, questions_, events_);
    log_("web server at http://" + web_->address() + ":" + std::to_string(web_->port()) +
         (keys_.empty() ? " (no key yet: packmerger keys add NAME)" : ""));
    tell_who_may_look();
    told_.clear();
    failures_ = 0;
    web_stands_.works();
  } catch (const std::exception& error) {
    if (told_ != error.what()) log_(error.what());
    told_ = error.what();
    const double pause_s = backoff_s(config_.retry_s, failures_++);
    retry_s_ = now_s + pause_s;
    web_stands_.failed(error.what(), pause_s);
  }
}

void WebService::tell_who_may_look() {
  if (!config_.web.trust_local)
    log_(
        "web.trust_local is not set, so whoever asks from this machine may look without a key, and "
        "everybody behind a proxy here that does not say that it is one: set it to false, and "
        "packmerger keys link lets a browser look");
  else if (!*config_.web.trust_local)
    log_("to look at the page from here, once, within 15 minutes: " +
         look_link(config_.web, keys_) + " (packmerger keys link prints another)");
}

void WebService::announce() {
  std::vector<MdnsService> services;
  if (web_ && is_reached_by_others(web_->address()))
    for (const PrinterConfig& printer : config_.printers)
      services.push_back(service_of(printer, web_->port(), machine_));
  if (mdns_ && mdns_->services() == services) return;
  mdns_.reset();
  if (!services.empty())
    mdns_.emplace(std::move(services), [this](const std::string& line) { lines_.push(line); });
}

// The connections' threads may wait for answers while they are ended.
void WebService::close() {
  if (!web_) return;
  events_.end_streams();
  std::promise<void> ended;
  std::thread ending([&] {
    web_.reset();
    ended.set_value();
  });
  const std::future<void> has_ended = ended.get_future();
  while (has_ended.wait_for(std::chrono::milliseconds(10)) != std::future_status::ready)
    answer_questions();
  ending.join();
}

void WebService::answer_questions() {
  while (const auto question = questions_.try_pop()) {
    if (!(*question)->begin()) continue;  // taken back
    const auto& ask = (*question)->ask;
    if (const auto* request = std::get_if<std::string>(&ask))
      (*question)->answer.set_value(answer(job_manager_, keys_, *request));
    else
      (*question)->answer.set_value(answer_upload(job_manager_, std::get<UploadedJob>(ask)));
  }
}

void WebService::publish(double now_s) {
  const bool at_once = events_.take_begun();
  if ((!at_once && now_s - published_s_ < kPublishEvery_s) || !events_.watched()) return;
  published_s_ = now_s;
  events_.publish(board_.look(), [this] { return board_.state(); });
}

}  // namespace packmerger
