#include "record/schemas.h"

#include "record/idl_text.h"

namespace wirepose::record {
namespace {

// The fields of the ROS 2 messages as their .msg files list them. tests/ros2 compares them with the official ones.
struct Definition {
  const char* type;
  const char* fields;
};

constexpr Definition kHeaderMessage = {"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"};
constexpr Definition kPoint = {"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"};
constexpr Definition kVector3 = {"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"};
constexpr Definition kQuaternion = {"geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"};
constexpr Definition kPose = {"geometry_msgs/Pose",
                              "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"};

constexpr Definition kDetections[] = {
    {"vision_msgs/Detection3DArray", "std_msgs/Header header\nvision_msgs/Detection3D[] detections\n"},
    {"vision_msgs/Detection3D",
     "std_msgs/Header header\nvision_msgs/ObjectHypothesisWithPose[] results\nvision_msgs/BoundingBox3D bbox\n"
     "string id\n"},
    {"vision_msgs/ObjectHypothesisWithPose",
     "vision_msgs/ObjectHypothesis hypothesis\ngeometry_msgs/PoseWithCovariance pose\n"},
    {"vision_msgs/ObjectHypothesis", "string class_id\nfloat64 score\n"},
    {"vision_msgs/BoundingBox3D", "geometry_msgs/Pose center\ngeometry_msgs/Vector3 size\n"},
    {"geometry_msgs/PoseWithCovariance", "geometry_msgs/Pose pose\nfloat64[36] covariance\n"},
    kHeaderMessage,
    kPose,
    kPoint,
    kQuaternion,
    kVector3};

constexpr Definition kMarkers[] = {
    {"visualization_msgs/MarkerArray", "visualization_msgs/Marker[] markers\n"},
    {"visualization_msgs/Marker",
     "std_msgs/Header header\nstring ns\nint32 id\nint32 type\nint32 action\ngeometry_msgs/Pose pose\n"
     "geometry_msgs/Vector3 scale\nstd_msgs/ColorRGBA color\nbuiltin_interfaces/Duration lifetime\n"
     "bool frame_locked\ngeometry_msgs/Point[] points\nstd_msgs/ColorRGBA[] colors\nstring texture_resource\n"
     "sensor_msgs/CompressedImage texture\nvisualization_msgs/UVCoordinate[] uv_coordinates\nstring text\n"
     "string mesh_resource\nvisualization_msgs/MeshFile mesh_file\nbool mesh_use_embedded_materials\n"},
    {"visualization_msgs/UVCoordinate", "float32 u\nfloat32 v\n"},
    {"visualization_msgs/MeshFile", "string filename\nuint8[] data\n"},
    {"sensor_msgs/CompressedImage", "std_msgs/Header header\nstring format\nuint8[] data\n"},
    {"std_msgs/ColorRGBA", "float32 r\nfloat32 g\nfloat32 b\nfloat32 a\n"},
    kHeaderMessage,
    kPose,
    kPoint,
    kQuaternion,
    kVector3};

constexpr Definition kDiagnostics[] = {
    {"diagnostic_msgs/DiagnosticArray", "std_msgs/Header header\ndiagnostic_msgs/DiagnosticStatus[] status\n"},
    {"diagnostic_msgs/DiagnosticStatus",
     "byte level\nstring name\nstring message\nstring hardware_id\ndiagnostic_msgs/KeyValue[] values\n"},
    {"diagnostic_msgs/KeyValue", "string key\nstring value\n"},
    kHeaderMessage};

constexpr Definition kImage[] = {
    {"sensor_msgs/Image",
     "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\n"
     "uint8[] data\n"},
    kHeaderMessage};

// The first definition is the message's own; those it holds follow, as MCAP's ros2msg encoding wants it.
std::string SchemaOf(std::span<const Definition> definitions) {
  std::string text = definitions[0].fields;
  for (const Definition& definition : definitions.subspan(1)) {
    text.append(std::string(80, '=')).append("\nMSG: ").append(definition.type).append("\n").append(definition.fields);
  }
  return text;
}

// "vision_msgs/Detection3DArray" to "vision_msgs/msg/Detection3DArray".
std::string RosName(const std::string& type) {
  std::string name = type;
  return name.replace(name.find('/'), 1, "/msg/");
}

McapChannel RosChannel(const std::string& name, std::span<const Definition> definitions) {
  const std::string topic = name.rfind("rt/", 0) == 0 ? name.substr(2) : "/" + name;
  return {topic, RosName(definitions[0].type), "ros2msg", SchemaOf(definitions)};
}

}  // namespace

McapChannel ChannelOf(TopicId topic, const std::string& name) {
  switch (topic) {
    case TopicId::kDetections:
      return RosChannel(name, kDetections);
    case TopicId::kMarkers:
      return RosChannel(name, kMarkers);
    case TopicId::kDiagnostics:
      return RosChannel(name, kDiagnostics);
    case TopicId::kImage:
      return RosChannel(name, kImage);
    default:
      return {name, Spec(topic).type->m_typename, "omgidl", kWireposeIdl};
  }
}

}  // namespace wirepose::record
