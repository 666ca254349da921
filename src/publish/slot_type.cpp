#include "publish/slot_type.h"

#include <dds/ddsi/ddsi_cdrstream.h>
#include <dds/ddsi/q_protocol.h>

#include <cstdio>
#include <cstring>
#include <type_traits>

namespace wirepose {
namespace {

constexpr std::uint32_t kHeaderBytes = 4;
constexpr unsigned char kPlainCdrLittleEndian[2] = {0x00, 0x01};

SampleSlot* SlotOf(ddsi_serdata* data) { return reinterpret_cast<SampleSlot*>(data); }
const SampleSlot* SlotOf(const ddsi_serdata* data) { return reinterpret_cast<const SampleSlot*>(data); }

// The only key that keyless types have. Cyclone shares it between all topics of the process and may keep it for longer
// than any of them: it is never freed.
SampleSlot& KeySlot() {
  static SampleSlot key;
  return key;
}

void InitKey(const ddsi_sertype& type) {
  [[maybe_unused]] static const bool once = [&type] {
    ddsi_serdata& key = KeySlot().base;
    ddsi_serdata_init(&key, &type, SDK_KEY);
    key.type = nullptr;  // of no topic in particular
    key.hash = type.serdata_basehash;
    return true;
  }();
}

}  // namespace

// What Cyclone calls. Names follow its tables of functions.
struct SlotOperations {
  static SlotType* Of(const ddsi_sertype* type) {
    return reinterpret_cast<SlotType*>(const_cast<ddsi_sertype*>(type));
  }

  static ddsi_serdata* FromSample(const ddsi_sertype* base, ddsi_serdata_kind kind, const void* sample) {
    SlotType* const type = Of(base);
    if (kind != SDK_DATA) return nullptr;
    SampleSlot* const slot = type->Acquire();
    if (slot == nullptr) return nullptr;
    ddsi_serdata_init(&slot->base, base, kind);
    slot->base.hash = base->serdata_basehash;
    dds_ostreamLE_t out{{slot->bytes + kHeaderBytes, type->slot_bytes_ - kHeaderBytes, 0, CDR_ENC_VERSION_1}};
    dds_stream_writeLE(&out, static_cast<const char*>(sample), type->type_->m_ops);
    const std::uint32_t padding = (4 - out.x.m_index % 4) % 4;
    std::memset(slot->bytes + kHeaderBytes + out.x.m_index, 0, padding);
    std::memcpy(slot->bytes, kPlainCdrLittleEndian, sizeof kPlainCdrLittleEndian);
    slot->bytes[2] = 0;
    slot->bytes[3] = static_cast<unsigned char>(padding);  // as Cyclone's own writer says how much is padding
    slot->size = kHeaderBytes + out.x.m_index + padding;
    return &slot->base;
  }

  static void Free(ddsi_serdata* data) {
    SampleSlot* const slot = SlotOf(data);
    if (data->kind != SDK_DATA) return;  // the key, which is not in the pool
    Of(data->type)->Release(slot);
  }

  static bool EqualKeys(const ddsi_serdata*, const ddsi_serdata*) { return true; }
  static std::uint32_t Size(const ddsi_serdata* data) { return SlotOf(data)->size; }
  static void ToBytes(const ddsi_serdata* data, std::size_t offset, std::size_t size, void* out) {
    std::memcpy(out, SlotOf(data)->bytes + offset, size);
  }
  static ddsi_serdata* ToBytesReference(const ddsi_serdata* data, std::size_t offset, std::size_t size,
                                        ddsrt_iovec_t* out) {
    out->iov_base = SlotOf(data)->bytes + offset;
    out->iov_len = static_cast<ddsrt_iov_len_t>(size);
    return ddsi_serdata_ref(data);
  }
  static void EndBytesReference(ddsi_serdata* data, const ddsrt_iovec_t*) { ddsi_serdata_unref(data); }
  static ddsi_serdata* ToKey(const ddsi_serdata*) { return ddsi_serdata_ref(&KeySlot().base); }
  static std::size_t Print(const ddsi_sertype* type, const ddsi_serdata*, char* text, std::size_t size) {
    return static_cast<std::size_t>(std::snprintf(text, size, "%s", type->type_name));
  }
  static void KeyHash(const ddsi_serdata*, ddsi_keyhash* hash, bool) { std::memset(hash, 0, sizeof *hash); }

  // This type does not read.
  static ddsi_serdata* FromNetwork(const ddsi_sertype*, ddsi_serdata_kind, const nn_rdata*, std::size_t) {
    return nullptr;
  }
  static ddsi_serdata* FromBytes(const ddsi_sertype*, ddsi_serdata_kind, ddsrt_msg_iovlen_t, const ddsrt_iovec_t*,
                                 std::size_t) {
    return nullptr;
  }
  static ddsi_serdata* FromKeyHash(const ddsi_sertype*, const ddsi_keyhash*) { return nullptr; }
  static bool ToSample(const ddsi_serdata*, void*, void**, void*) { return false; }
  static bool KeyToSample(const ddsi_sertype*, const ddsi_serdata*, void*, void**, void*) { return false; }
#ifdef DDS_HAS_SHM
  static std::uint32_t SharedMemorySize(const ddsi_serdata* data) { return SlotOf(data)->size; }
  static ddsi_serdata* FromSharedMemory(const ddsi_sertype*, ddsi_serdata_kind, void*, void*) { return nullptr; }
#endif

  static void FreeType(ddsi_sertype* type) { ddsi_sertype_fini(type); }
  static void ZeroSamples(const ddsi_sertype*, void*, std::size_t) {}
  static void ReallocSamples(void**, const ddsi_sertype*, void*, std::size_t, std::size_t) {}
  static void FreeSamples(const ddsi_sertype*, void**, std::size_t, dds_free_op_t) {}
  static bool EqualTypes(const ddsi_sertype* a, const ddsi_sertype* b) { return a == b; }
  static std::uint32_t HashOfType(const ddsi_sertype*) { return 0; }
};

namespace {

using Op = SlotOperations;

constexpr ddsi_serdata_ops MakeSampleOperations() {
  ddsi_serdata_ops ops{};
  ops.eqkey = Op::EqualKeys;
  ops.get_size = Op::Size;
  ops.from_ser = Op::FromNetwork;
  ops.from_ser_iov = Op::FromBytes;
  ops.from_keyhash = Op::FromKeyHash;
  ops.from_sample = Op::FromSample;
  ops.to_ser = Op::ToBytes;
  ops.to_ser_ref = Op::ToBytesReference;
  ops.to_ser_unref = Op::EndBytesReference;
  ops.to_sample = Op::ToSample;
  ops.to_untyped = Op::ToKey;
  ops.untyped_to_sample = Op::KeyToSample;
  ops.free = Op::Free;
  ops.print = Op::Print;
  ops.get_keyhash = Op::KeyHash;
#ifdef DDS_HAS_SHM
  ops.get_sample_size = Op::SharedMemorySize;
  ops.from_iox_buffer = Op::FromSharedMemory;
#endif
  return ops;
}
constexpr ddsi_serdata_ops kSampleOperations = MakeSampleOperations();

ddsi_sertype_ops MakeTypeOperations() {
  ddsi_sertype_ops ops{};
  ops.version = ddsi_sertype_v0;
  ops.free = Op::FreeType;
  ops.zero_samples = Op::ZeroSamples;
  ops.realloc_samples = Op::ReallocSamples;
  ops.free_samples = Op::FreeSamples;
  ops.equal = Op::EqualTypes;
  ops.hash = Op::HashOfType;
  return ops;
}
const ddsi_sertype_ops kTypeOperations = MakeTypeOperations();

}  // namespace

SlotType::SlotType(const dds_topic_descriptor_t& type, std::span<SampleSlot> slots, unsigned char* storage,
                   std::uint32_t slot_bytes)
    : type_(&type), slots_(slots), slot_bytes_(slot_bytes) {
  static_assert(std::is_standard_layout_v<SampleSlot> && std::is_standard_layout_v<SlotType>,
                "each begins with its first member");
  for (SampleSlot& slot : slots_) {
    slot.bytes = storage;
    storage += slot_bytes;
  }
}

dds_entity_t SlotType::CreateTopic(dds_entity_t participant, const char* name) {
  ddsi_sertype_init(&base_, type_->m_typename, &kTypeOperations, &kSampleOperations, true);
  base_.allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  InitKey(base_);
  ddsi_sertype* type = &base_;
  const dds_entity_t topic = dds_create_topic_sertype(participant, name, &type, nullptr, nullptr, nullptr);
  if (topic < 0) ddsi_sertype_unref(&base_);
  return topic;
}

SampleSlot* SlotType::Acquire() {
  for (SampleSlot& slot : slots_) {
    bool free = false;
    if (!slot.used.compare_exchange_strong(free, true, std::memory_order_acquire)) continue;
    const std::size_t count = in_use_.fetch_add(1, std::memory_order_relaxed) + 1;
    std::size_t highest = high_water();
    while (count > highest && !high_water_.compare_exchange_weak(highest, count, std::memory_order_relaxed)) {
    }
    return &slot;
  }
  refused_.fetch_add(1, std::memory_order_relaxed);
  return nullptr;
}

void SlotType::Release(SampleSlot* slot) {
  in_use_.fetch_sub(1, std::memory_order_relaxed);
  slot->used.store(false, std::memory_order_release);
}

}  // namespace wirepose
