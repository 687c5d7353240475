#include "notify/mdns.h"

#include <avahi-client/client.h>
#include <avahi-client/publish.h>
#include <avahi-common/alternative.h>
#include <avahi-common/domain.h>
#include <avahi-common/error.h>
#include <avahi-common/malloc.h>
#include <avahi-common/simple-watch.h>
#include <sys/eventfd.h>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <utility>

#include "base/time/backoff.h"

namespace packmerger {
namespace {

constexpr const char* kType = "_octoprint._tcp";
constexpr int kMostNames = 20;  // tried for a service

// The conversation with avahi-daemon. Every callback runs on the thread of run().
class Announcement {
 public:
  Announcement(std::vector<MdnsService> services, const TellLine& tell, Standing& standing,
               double retry_s)
      : services_(std::move(services)), tell_(tell), standing_(standing), retry_s_(retry_s) {
    for (MdnsService& service : services_) service.name = fitting(service.name);
  }
  Announcement(const Announcement&) = delete;
  Announcement& operator=(const Announcement&) = delete;
  ~Announcement() { disconnect(); }

  void run(int ending) {
    if (poll_ == nullptr) return;
    const AvahiPoll* api = avahi_simple_poll_get(poll_.get());
    AvahiWatch* watch = api->watch_new(
        api, ending, AVAHI_WATCH_IN,
        [](AvahiWatch*, int, AvahiWatchEvent, void* self) {
          static_cast<Announcement*>(self)->ends_ = true;
        },
        this);
    while (!ends_) {
      if (is_lost_) disconnect();
      if (client_ == nullptr) connect();
      avahi_simple_poll_iterate(poll_.get(), static_cast<int>(1000 * pause_s()));
    }
    disconnect();
    api->watch_free(watch);
  }

 private:
  double pause_s() const { return backoff_s(retry_s_, failures_ - 1); }

  static std::string fitting(std::string name) {
    name.resize(std::min<std::size_t>(name.size(), AVAHI_LABEL_MAX - 1));
    return name;
  }

  void connect() {
    int error = 0;
    is_lost_ = false;
    client_ = avahi_client_new(avahi_simple_poll_get(poll_.get()), AVAHI_CLIENT_NO_FAIL, on_client,
                               this, &error);
    if (client_ != nullptr) return;
    group_ = nullptr;
    ++failures_;
    tell_absent(avahi_strerror(error), pause_s());
  }

  void disconnect() {
    group_ = nullptr;  // freed with its client
    if (client_ != nullptr) avahi_client_free(std::exchange(client_, nullptr));
  }

  // pause_s: until the next try; 0: avahi-daemon tells when it is there again.
  void tell_absent(const std::string& why, double pause_s = 0) {
    if (was_there_) standing_.failed(why, pause_s);
    if (!std::exchange(is_told_, true))
      tell_("printers are not announced on the network (mDNS): " + why);
  }

  static void on_client(AvahiClient* client, AvahiClientState state, void* closure) {
    auto* self = static_cast<Announcement*>(closure);
    self->client_ = client;  // the first call comes before avahi_client_new() returns
    if (state != AVAHI_CLIENT_CONNECTING && state != AVAHI_CLIENT_FAILURE) self->was_there_ = true;
    switch (state) {
      case AVAHI_CLIENT_S_RUNNING:
        self->announce();
        break;
      case AVAHI_CLIENT_S_REGISTERING:
      case AVAHI_CLIENT_S_COLLISION:
        if (self->group_ != nullptr) avahi_entry_group_reset(self->group_);
        break;
      case AVAHI_CLIENT_CONNECTING:
        self->tell_absent("avahi-daemon does not run");
        break;
      case AVAHI_CLIENT_FAILURE:
        self->tell_absent(avahi_strerror(avahi_client_errno(client)));
        self->is_lost_ = true;
        break;
    }
  }

  static void on_group(AvahiEntryGroup*, AvahiEntryGroupState state, void* closure) {
    auto* self = static_cast<Announcement*>(closure);
    if (state == AVAHI_ENTRY_GROUP_ESTABLISHED) {
      self->tell_("printers are announced on the network (mDNS)");
      self->is_told_ = false;
      self->failures_ = 0;
      self->standing_.works();
    } else if (state == AVAHI_ENTRY_GROUP_COLLISION) {
      for (MdnsService& service : self->services_) rename(service);
      self->announce();
    } else if (state == AVAHI_ENTRY_GROUP_FAILURE) {
      self->tell_absent(avahi_strerror(avahi_client_errno(self->client_)));
    }
  }

  static void rename(MdnsService& service) {
    char* other = avahi_alternative_service_name(service.name.c_str());
    service.name = other;
    avahi_free(other);
  }

  int add(const MdnsService& service) {
    AvahiStringList* txt = nullptr;
    for (const std::string& line : service.txt) txt = avahi_string_list_add(txt, line.c_str());
    const std::unique_ptr<AvahiStringList, void (*)(AvahiStringList*)> held(txt,
                                                                            avahi_string_list_free);
    return avahi_entry_group_add_service_strlst(group_, AVAHI_IF_UNSPEC, AVAHI_PROTO_UNSPEC,
                                                AvahiPublishFlags{}, service.name.c_str(), kType,
                                                nullptr, nullptr, service.port, txt);
  }

  void announce() {
    if (group_ == nullptr) group_ = avahi_entry_group_new(client_, on_group, this);
    if (group_ == nullptr) return tell_absent(avahi_strerror(avahi_client_errno(client_)));
    avahi_entry_group_reset(group_);
    for (MdnsService& service : services_) {
      int error = add(service);
      for (int tries = 0; error == AVAHI_ERR_COLLISION && tries < kMostNames; ++tries) {
        rename(service);
        error = add(service);
      }
      if (error < 0) return tell_absent(avahi_strerror(error));
    }
    avahi_entry_group_commit(group_);
  }

  std::vector<MdnsService> services_;
  const TellLine& tell_;
  Standing& standing_;
  const double retry_s_;
  std::unique_ptr<AvahiSimplePoll, void (*)(AvahiSimplePoll*)> poll_{avahi_simple_poll_new(),
                                                                     avahi_simple_poll_free};
  AvahiClient* client_ = nullptr;
  AvahiEntryGroup* group_ = nullptr;
  int failures_ = 0;        // to reach D-Bus, one after the other
  bool was_there_ = false;  // avahi-daemon
  bool ends_ = false;
  bool is_lost_ = false;
  bool is_told_ = false;  // that nothing is announced
};

}  // namespace

Mdns::Mdns(std::vector<MdnsService> services, TellLine tell, double retry_s)
    : services_(std::move(services)),
      tell_(std::move(tell)),
      retry_s_(retry_s),
      ending_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  thread_ = std::thread(
      [this] { Announcement(services_, tell_, standing_, retry_s_).run(ending_.get()); });
}

Mdns::~Mdns() {
  const std::uint64_t one = 1;
  while (::write(ending_.get(), &one, sizeof one) < 0 && errno == EINTR) {
  }
  thread_.join();
}

}  // namespace packmerger
