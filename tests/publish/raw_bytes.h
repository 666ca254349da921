// The bytes of a sample as they came over the wire.
#ifndef WIREPOSE_TESTS_PUBLISH_RAW_BYTES_H_
#define WIREPOSE_TESTS_PUBLISH_RAW_BYTES_H_

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>

#include <vector>

namespace wirepose::test {

// Encapsulation header first; empty when there is no sample.
inline std::vector<unsigned char> TakeRawBytes(dds_entity_t reader) {
  ddsi_serdata* data = nullptr;
  dds_sample_info_t info{};
  if (dds_takecdr(reader, &data, 1, &info, DDS_ANY_STATE) != 1) return {};
  ddsrt_iovec_t io{};
  ddsi_serdata* const reference = ddsi_serdata_to_ser_ref(data, 0, ddsi_serdata_size(data), &io);
  const auto* const first = static_cast<const unsigned char*>(io.iov_base);
  std::vector<unsigned char> bytes(first, first + io.iov_len);
  ddsi_serdata_to_ser_unref(reference, &io);
  ddsi_serdata_unref(data);
  return bytes;
}

}  // namespace wirepose::test

#endif  // WIREPOSE_TESTS_PUBLISH_RAW_BYTES_H_
