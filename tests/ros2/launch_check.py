"""Runs a launch file without ROS: prints what it would start, one line of JSON a node.

Usage: launch_check.py LAUNCH_FILE. Stands in for the parts of ROS's launch that the file uses; launch configurations have
their declared defaults.
"""
import json
import runpy
import sys
import types

DEFAULTS = {}


class DeclareLaunchArgument:
    def __init__(self, name, *, default_value):
        DEFAULTS[name] = default_value


class LaunchConfiguration:
    def __init__(self, name):
        self.name = name


class Node:
    def __init__(self, *, package, executable, arguments=()):
        self.package, self.executable, self.arguments = package, executable, arguments


class LaunchDescription:
    def __init__(self, entities):
        self.entities = entities


def offer(module, **names):
    sys.modules[module] = types.ModuleType(module)
    vars(sys.modules[module]).update(names)


def text(value):
    return DEFAULTS[value.name] if isinstance(value, LaunchConfiguration) else value


offer("launch", LaunchDescription=LaunchDescription)
offer("launch.actions", DeclareLaunchArgument=DeclareLaunchArgument)
offer("launch.substitutions", LaunchConfiguration=LaunchConfiguration)
offer("launch_ros")
offer("launch_ros.actions", Node=Node)
sys.dont_write_bytecode = True
description = runpy.run_path(sys.argv[1])["generate_launch_description"]()
for node in description.entities:
    if isinstance(node, Node):
        print(json.dumps({"package": node.package, "executable": node.executable,
                          "arguments": [text(a) for a in node.arguments]}))
