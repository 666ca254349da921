#include "hal/libcamera/camera_stream.h"

#include <sys/mman.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace wirepose::hal {
namespace {

template <typename ControlType>
bool Has(const libcamera::Camera& camera, const ControlType& control) {
  return camera.controls().find(&control) != camera.controls().end();
}

}  // namespace

std::string CameraStream::Error(const std::string& what) const {
  std::string text("libcamera: ");
  return text.append(camera_ ? camera_->id() : "camera").append(": ").append(what);
}

std::string CameraStream::Open(std::shared_ptr<libcamera::Camera> camera, const StreamSettings& settings) {
  settings_ = settings;
  camera_ = std::move(camera);
  if (camera_->acquire() != 0) {
    const std::string error = Error("is in use; end the other program that holds it");
    camera_.reset();
    return error;
  }
  std::string error = ChooseFormat(settings);
  if (error.empty()) error = MapBuffers();
  if (!error.empty()) {
    Close();
    return error;
  }
  camera_->requestCompleted.connect(this, &CameraStream::RequestCompleted);
  camera_->disconnected.connect(this, &CameraStream::Disconnected);
  return {};
}

std::string CameraStream::ChooseFormat(const StreamSettings& settings) {
  configuration_ = camera_->generateConfiguration({libcamera::StreamRole::Viewfinder});
  if (!configuration_ || configuration_->empty()) return Error("offers no stream; choose another camera");
  libcamera::StreamConfiguration& stream = configuration_->at(0);
  std::vector<std::string> offered;
  for (const libcamera::PixelFormat& one : stream.formats().pixelformats()) offered.push_back(one.toString());
  const Result<PixelFormat, std::string> chosen = ChoosePixelFormat(settings.pixel_format, offered);
  if (!chosen) return Error(chosen.error());
  const std::string& format = chosen->name;
  layout_ = chosen->layout;
  stream.pixelFormat = libcamera::PixelFormat::fromString(format);
  stream.size = {static_cast<unsigned>(settings.width), static_cast<unsigned>(settings.height)};
  stream.bufferCount = kCameraBuffers;
  const auto status = configuration_->validate();
  if (status == libcamera::CameraConfiguration::Invalid || stream.pixelFormat.toString() != format ||
      stream.size.width != static_cast<unsigned>(settings.width) ||
      stream.size.height != static_cast<unsigned>(settings.height)) {
    return Error("cannot give " + std::to_string(settings.width) + "x" + std::to_string(settings.height) + " " +
                 format + ", the nearest is " + stream.toString() + "; calibrate at a size that it has");
  }
  if (camera_->configure(configuration_.get()) != 0)
    return Error("refuses its own configuration; unplug it and try again");
  stream_ = configuration_->at(0).stream();
  return {};
}

std::string CameraStream::MapBuffers() {
  allocator_ = std::make_unique<libcamera::FrameBufferAllocator>(camera_);
  if (allocator_->allocate(stream_) < 0) return Error("has no memory for buffers; close other programs");
  const auto& buffers = allocator_->buffers(stream_);
  if (buffers.size() < kCameraBuffers) return Error("gives fewer than 4 buffers; choose another camera");
  for (std::uint32_t i = 0; i < kCameraBuffers; ++i) {
    Slot& slot = slots_[i];
    slot.buffer = buffers[i].get();
    if (std::string error = Map(slot); !error.empty()) return error;
    slot.request = camera_->createRequest(i);
    if (!slot.request || slot.request->addBuffer(stream_, slot.buffer) != 0)
      return Error("refuses a request; try again");
  }
  return {};
}

// Only the first plane is read: luma comes first in every format that is accepted.
std::string CameraStream::Map(Slot& slot) const {
  const libcamera::FrameBuffer::Plane& plane = slot.buffer->planes()[0];
  const std::size_t bytes = std::size_t{plane.offset} + plane.length;
  void* const mapping = mmap(nullptr, bytes, PROT_READ, MAP_SHARED, plane.fd.get(), 0);
  if (mapping == MAP_FAILED) {
    return Error(std::string("a buffer cannot be mapped: ") + std::strerror(errno) + "; choose another camera");
  }
  slot.mapping = mapping;
  slot.mapped_bytes = bytes;
  return {};
}

void CameraStream::SetControls(libcamera::ControlList& controls) const {
  namespace ids = libcamera::controls;
  const libcamera::Camera& camera = *camera_;
#ifdef WIREPOSE_LIBCAMERA_EXPOSURE_MODES  // libcamera 0.5 and newer: each has its own switch
  if (settings_.exposure_us > 0 && Has(camera, ids::ExposureTimeMode))
    controls.set(ids::ExposureTimeMode, static_cast<std::int32_t>(ids::ExposureTimeModeManual));
  if (settings_.gain > 0 && Has(camera, ids::AnalogueGainMode))
    controls.set(ids::AnalogueGainMode, static_cast<std::int32_t>(ids::AnalogueGainModeManual));
#else
  if (settings_.exposure_us > 0 && Has(camera, ids::AeEnable)) controls.set(ids::AeEnable, false);
#endif
  if (settings_.exposure_us > 0 && Has(camera, ids::ExposureTime))
    controls.set(ids::ExposureTime, settings_.exposure_us);
  if (settings_.gain > 0 && Has(camera, ids::AnalogueGain)) controls.set(ids::AnalogueGain, settings_.gain);
  if (settings_.frame_rate_hz > 0 && Has(camera, ids::FrameDurationLimits)) {
    const auto period_us = static_cast<std::int64_t>(1e6 / settings_.frame_rate_hz);
    const std::int64_t limits[2] = {period_us, period_us};
    controls.set(ids::FrameDurationLimits, libcamera::Span<const std::int64_t, 2>(limits));
  }
}

std::string CameraStream::Start() {
  libcamera::ControlList controls(camera_->controls());
  SetControls(controls);
  if (camera_->start(&controls) != 0) return Error("does not start; unplug it and try again");
  for (std::uint32_t i = 0; i < kCameraBuffers; ++i) {
    if (!Requeue(i)) {
      camera_->stop();
      return Error("takes no request; unplug it and try again");
    }
  }
  return {};
}

void CameraStream::Stop() {
  if (camera_) camera_->stop();
}

void CameraStream::Close() {
  if (!camera_) return;
  camera_->requestCompleted.disconnect(this);
  camera_->disconnected.disconnect(this);
  for (Slot& slot : slots_) {
    slot.request.reset();
    if (slot.mapping != nullptr) munmap(slot.mapping, slot.mapped_bytes);
    slot = {};
  }
  allocator_.reset();
  configuration_.reset();
  stream_ = nullptr;
  camera_->release();
  camera_.reset();
}

bool CameraStream::Requeue(std::uint32_t slot) {
  libcamera::Request& request = *slots_[slot].request;
  if (request.status() != libcamera::Request::RequestPending) request.reuse(libcamera::Request::ReuseBuffers);
  return camera_->queueRequest(&request) == 0;
}

LumaSource CameraStream::Luma(std::uint32_t slot) const {
  const Slot& s = slots_[slot];
  const libcamera::StreamConfiguration& stream = configuration_->at(0);
  const std::size_t offset = s.buffer->planes()[0].offset;
  const auto planes = s.buffer->metadata().planes();
  LumaSource source;
  source.data = static_cast<const std::uint8_t*>(s.mapping) + offset;
  source.bytes = planes.size() == 0 ? 0 : std::min<std::size_t>(planes[0].bytesused, s.mapped_bytes - offset);
  source.width = static_cast<int>(stream.size.width);
  source.height = static_cast<int>(stream.size.height);
  source.stride = static_cast<int>(stream.stride);
  source.layout = layout_;
  return source;
}

void CameraStream::RequestCompleted(libcamera::Request* request) {
  if (request->status() == libcamera::Request::RequestCancelled) return;
  const auto slot = static_cast<std::uint32_t>(request->cookie());
  const libcamera::FrameMetadata& metadata = slots_[slot].buffer->metadata();
  EyeFrame frame;
  frame.slot = slot;
  frame.sequence = metadata.sequence;
  frame.damaged = metadata.status != libcamera::FrameMetadata::FrameSuccess;
  // The sensor's stamp is the start of the exposure; the middle is later by half of it.
  const auto sensor_ns = request->metadata().get(libcamera::controls::SensorTimestamp);
  const auto exposure_us = request->metadata().get(libcamera::controls::ExposureTime);
  frame.time = std::chrono::nanoseconds(sensor_ns ? *sensor_ns : static_cast<std::int64_t>(metadata.timestamp)) +
               std::chrono::nanoseconds(std::int64_t{exposure_us ? *exposure_us : 0} * 500);
  listener_.FrameFinished(eye_, frame);
}

}  // namespace wirepose::hal
