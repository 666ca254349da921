// The fields of vision_msgs 4 (Humble to Kilted), as its .msg files list them.
import rosmsg from "@foxglove/rosmsg";

const fields = {
  "vision_msgs/Detection3DArray": "std_msgs/Header header\nDetection3D[] detections",
  "vision_msgs/Detection3D":
    "std_msgs/Header header\nObjectHypothesisWithPose[] results\nBoundingBox3D bbox\nstring id",
  "vision_msgs/ObjectHypothesisWithPose": "ObjectHypothesis hypothesis\ngeometry_msgs/PoseWithCovariance pose",
  "vision_msgs/ObjectHypothesis": "string class_id\nfloat64 score",
  "vision_msgs/BoundingBox3D": "geometry_msgs/Pose center\ngeometry_msgs/Vector3 size",
};

export function visionMsgs() {
  return Object.entries(fields).map(([name, text]) => {
    const [definition] = rosmsg.parse(text, { ros2: true, skipTypeFixup: true });
    const definitions = definition.definitions.map((field) =>
      field.isComplex && !field.type.includes("/") ? { ...field, type: `vision_msgs/${field.type}` } : field,
    );
    return { name, definitions };
  });
}
