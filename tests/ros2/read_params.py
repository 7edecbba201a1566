"""Prints what nodes of rclpy get from params files; a program for the interpreter of ROS 2.

Standard input has a JSON list of [arguments of a command line, nodes as [namespace, name]];
standard output has for each the parameters of each node, or the error of rcl as a text.
"""

import json
import sys

import rclpy
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.parameter import Parameter
from rclpy.qos import qos_profile_rosout_default

ROSOUT = qos_profile_rosout_default.get_c_qos_profile()
context = rclpy.Context()
rclpy.init(context=context, args=[])
answers = []
for arguments, nodes in json.load(sys.stdin):
    found = []
    for namespace, name in nodes:
        try:
            with context.handle:
                node = rclpy_implementation.Node(
                    name,
                    namespace,
                    context.handle,
                    ["--ros-args", *arguments],
                    False,
                    False,
                    ROSOUT,
                )
        except Exception as error:
            found.append(f"{type(error).__name__}: {error}")
            continue
        given = node.get_parameters(Parameter)
        found.append(
            {
                key: [one.type_.name, None if one.value is None else repr(one.value)]
                for key, one in given.items()
            }
        )
        node.destroy_when_not_in_use()
    answers.append(found)
json.dump(answers, sys.stdout)
rclpy.shutdown(context=context)
