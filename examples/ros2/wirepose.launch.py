"""What a robot adds to a running wireposed in ROS 2: where the camera is, and RViz.

ros2 launch examples/ros2/wirepose.launch.py        (wireposed runs by itself, in the same ROS_DOMAIN_ID)

wireposed is no ROS node: its topics /wirepose/detections (vision_msgs/Detection3DArray), /wirepose/markers
(visualization_msgs/MarkerArray), /wirepose/left/image_raw (sensor_msgs/Image) and /diagnostics are simply there. With
rmw_fastrtps the same holds: the wire is the same.
"""
from pathlib import Path

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    robot_frame = LaunchConfiguration("robot_frame")
    display = str(Path(__file__).with_name("wirepose.rviz"))
    return LaunchDescription([
        DeclareLaunchArgument("robot_frame", default_value="base_link"),
        # dds.frame_id of wireposed.yaml, looking along the robot's x axis: optical frames have z forward, y down.
        Node(
            package="tf2_ros",
            executable="static_transform_publisher",
            arguments=["--x", "0.1", "--y", "0", "--z", "0.5", "--roll", "-1.5708", "--pitch", "0", "--yaw", "-1.5708",
                       "--frame-id", robot_frame, "--child-frame-id", "wirepose_left_optical"],
        ),
        Node(package="rviz2", executable="rviz2", arguments=["-d", display, "-f", robot_frame]),
    ])
