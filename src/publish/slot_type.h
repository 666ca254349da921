// A topic type whose samples are serialized into slots of fixed memory: dds_write then allocates nothing.
#ifndef WIREPOSE_PUBLISH_SLOT_TYPE_H_
#define WIREPOSE_PUBLISH_SLOT_TYPE_H_

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <span>

namespace wirepose {

// One serialized sample: what Cyclone keeps of it and where its bytes are.
struct SampleSlot {
  ddsi_serdata base;  // first: Cyclone's pointers to it are pointers to the slot
  std::atomic<bool> used{false};
  std::uint32_t size = 0;  // of the bytes, encapsulation header included
  unsigned char* bytes = nullptr;
};

// Implements Cyclone's sertype interface, which is internal to Cyclone 0.10 and pinned by dds_idl/CMakeLists.txt. Samples
// are the C structs of idlc, keyless types only, and are put on the wire as plain CDR (XCDR1, little-endian): what
// Cyclone's own writer sends, byte for byte. The type can only write; readers use Cyclone's own.
//
// The object must outlive the topic, whose deletion gives back its slots. Threads: as a DDS writer's.
class SlotType {
 public:
  // `slots` and `storage` (slot_bytes for each) are StaticSlotType's. slot_bytes must hold the largest sample that the
  // type's bounds allow, 4 bytes of header included; tests/publish/messages_test.cpp checks it with full messages.
  SlotType(const dds_topic_descriptor_t& type, std::span<SampleSlot> slots, unsigned char* storage,
           std::uint32_t slot_bytes);
  SlotType(const SlotType&) = delete;
  SlotType& operator=(const SlotType&) = delete;

  // A topic of this type: an entity that the participant owns, or a negative DDS return code.
  [[nodiscard]] dds_entity_t CreateTopic(dds_entity_t participant, const char* name);

  // Most slots ever in use at once, how many there are, and samples refused for want of one.
  [[nodiscard]] std::size_t high_water() const { return high_water_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::size_t capacity() const { return slots_.size(); }
  [[nodiscard]] std::uint64_t refused() const { return refused_.load(std::memory_order_relaxed); }

 private:
  friend struct SlotOperations;
  SampleSlot* Acquire();
  void Release(SampleSlot* slot);

  ddsi_sertype base_{};  // first: Cyclone's pointers to it are pointers to this object
  const dds_topic_descriptor_t* type_;
  std::span<SampleSlot> slots_;
  std::uint32_t slot_bytes_;
  std::atomic<std::size_t> in_use_{0}, high_water_{0};
  std::atomic<std::uint64_t> refused_{0};
};

// With the memory inside: make it static.
template <std::uint32_t kSlotBytes, std::size_t kSlots>
class StaticSlotType {
 public:
  explicit StaticSlotType(const dds_topic_descriptor_t& type) : type_(type, slots_, storage_.data(), kSlotBytes) {}
  SlotType& operator*() { return type_; }
  SlotType* operator->() { return &type_; }

 private:
  static_assert(kSlotBytes % 8 == 0, "the serializer writes aligned words");
  alignas(8) std::array<unsigned char, kSlotBytes * kSlots> storage_;
  std::array<SampleSlot, kSlots> slots_;
  SlotType type_;
};

}  // namespace wirepose

#endif  // WIREPOSE_PUBLISH_SLOT_TYPE_H_
