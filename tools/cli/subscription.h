// A reader of one topic and a message to take into.
#ifndef WIREPOSE_TOOLS_CLI_SUBSCRIPTION_H_
#define WIREPOSE_TOOLS_CLI_SUBSCRIPTION_H_

#include <memory>

#include "bus_options.h"
#include "publish/messages.h"

namespace wirepose::cli {

// What happened to a subscription since it was last asked.
struct SubscriptionEvents {
  std::uint32_t publishers = 0;       // matched now
  bool liveliness_changed = false;    // a publisher came or was lost
  std::uint32_t deadlines_missed = 0;  // new ones
  bool incompatible = false;           // a publisher offers less than we ask for
};

class Subscription {
 public:
  Subscription(const Bus& bus, TopicId topic) : reader_(OpenReader(bus, topic)) {}

  // Takes the next sample into `message`, a struct of the topic's type; false when there is none.
  bool Take(void* message, dds_sample_info_t& info) const {
    void* samples[] = {message};
    while (dds_take(reader_, samples, &info, 1, 1) > 0) {
      if (info.valid_data) return true;  // otherwise it only says that a writer has gone
    }
    return false;
  }

  [[nodiscard]] SubscriptionEvents Events() const {
    SubscriptionEvents events;
    dds_liveliness_changed_status_t liveliness{};
    if (dds_get_liveliness_changed_status(reader_, &liveliness) >= 0) {
      events.publishers = liveliness.alive_count;
      events.liveliness_changed = liveliness.alive_count_change != 0 || liveliness.not_alive_count_change != 0;
    }
    dds_requested_deadline_missed_status_t deadline{};
    if (dds_get_requested_deadline_missed_status(reader_, &deadline) >= 0) {
      events.deadlines_missed = static_cast<std::uint32_t>(deadline.total_count_change);
    }
    dds_requested_incompatible_qos_status_t incompatible{};
    if (dds_get_requested_incompatible_qos_status(reader_, &incompatible) >= 0) {
      events.incompatible = incompatible.total_count > 0;
    }
    return events;
  }

 private:
  dds_entity_t reader_;
};

template <typename Message>
class TypedSubscription : public Subscription {
 public:
  using Subscription::Subscription;
  bool Take() { return Subscription::Take(&message_->value, info); }
  [[nodiscard]] const auto& message() const { return message_->value; }

  dds_sample_info_t info{};  // of the last sample

 private:
  std::unique_ptr<Message> message_ = std::make_unique<Message>();
};

}  // namespace wirepose::cli

#endif  // WIREPOSE_TOOLS_CLI_SUBSCRIPTION_H_
