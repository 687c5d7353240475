#include "daemon/front_desk.h"

#include "base/error.h"
#include "base/files.h"
#include "daemon/api.h"

namespace packmerger {
namespace {

constexpr double kPublishEvery_s = 0.25;

fs::path uploads_folder(const DaemonConfig& config) { return config.state / "uploads"; }

}  // namespace

FrontDesk::FrontDesk(const DaemonConfig& config, Foreman& foreman, KeyRing& keys, Log log)
    : config_(config), foreman_(foreman), keys_(keys), log_(std::move(log)) {
  std::error_code ignored;
  fs::remove_all(uploads_folder(config), ignored);
}

// The connections' threads may still wait for an answer: a closed queue breaks their promises.
FrontDesk::~FrontDesk() {
  events_.close();
  questions_.close();
  while (questions_.try_pop()) {
  }
  web_.reset();
}

void FrontDesk::add_to(std::vector<pollfd>& waiting) const {
  waiting.push_back({questions_.fd(), POLLIN, 0});
}

void FrontDesk::serve(double now_s) {
  if (config_.web.port == 0) return;
  answer_questions();
  open(now_s);
  publish(now_s);
}

void FrontDesk::open(double now_s) {
  const bool is_elsewhere = web_ && !keys_.empty() && web_->address() != config_.web.address;
  if (now_s < retry_s_ || (web_ && !is_elsewhere)) return;
  try {
    fs::create_directories(uploads_folder(config_));
    web_.reset();
    web_ = std::make_unique<Web>(config_, keys_, questions_, events_);
    log_("web server at http://" + web_->address() + ":" + std::to_string(web_->port()) +
         (keys_.empty() ? " (no key yet: packmerger keys add NAME)" : ""));
    told_.clear();
  } catch (const std::exception& error) {
    if (told_ != error.what()) log_(error.what());
    told_ = error.what();
    retry_s_ = now_s + config_.retry_s;
  }
}

void FrontDesk::answer_questions() {
  while (const auto question = questions_.try_pop()) {
    const auto& ask = (*question)->ask;
    if (const auto* request = std::get_if<std::string>(&ask))
      (*question)->answer.set_value(answer(foreman_, keys_, *request));
    else
      (*question)->answer.set_value(answer_upload(foreman_, std::get<UploadedJob>(ask)));
  }
}

void FrontDesk::publish(double now_s) {
  if (now_s - published_s_ < kPublishEvery_s || !events_.watched()) return;
  published_s_ = now_s;
  events_.publish(answer(foreman_, keys_, R"({"verb": "state"})"));
}

}  // namespace packmerger
