"""A node of rclpy that hears reports and asks for parameters, for the tests of C++ nodes.

Runs under the interpreter that has rclpy. Reads one command in JSON from each line, and prints its
answer as JSON.
"""

import json
import sys
import time

import rclpy
from rcl_interfaces.msg import Log, Parameter, ParameterValue
from rcl_interfaces.srv import (
    DescribeParameters,
    GetParameters,
    GetParameterTypes,
    ListParameters,
    SetParameters,
    SetParametersAtomically,
)
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

PATIENCE_S = 600


class Peer:
    def __init__(self):
        rclpy.init()
        self.node = rclpy.create_node("peer")
        self.batches, self.logs = [], []
        self.node.create_subscription(
            String,
            "/threshold_information",
            lambda m: self.batches.append(m.data),
            QoSProfile(depth=512),
        )
        self.node.create_subscription(
            Log,
            "/rosout",
            lambda m: self.logs.append([m.stamp.sec, m.stamp.nanosec, m.name, m.msg]),
            QoSProfile(depth=20000, durability=DurabilityPolicy.TRANSIENT_LOCAL),
        )

    def spin(self, is_done):
        until = time.monotonic() + PATIENCE_S
        while not is_done() and time.monotonic() < until:
            rclpy.spin_once(self.node, timeout_sec=0.1)

    def heard(self, reports):
        """The batches and logs so far, when they have so many reports."""
        self.spin(lambda: self.count() >= reports)
        return {"batches": self.batches, "logs": self.logs}

    def count(self):
        lines = [
            line for batch in self.batches for line in batch.split("\n")[1:] if line[0].isdigit()
        ]
        logs = [text for *_, text in self.logs if text.startswith("threshold_information:")]
        return sum(",threshold_" not in line for line in lines) + len(logs)

    def nodes(self, wanted):
        """The full names of the nodes on the graph, when the wanted one is among them."""
        self.spin(lambda: wanted in self.names())
        return self.names()

    def names(self):
        pairs = self.node.get_node_names_and_namespaces()
        return sorted(space.rstrip("/") + "/" + name for name, space in pairs)

    def call(self, kind, service, request):
        client = self.node.create_client(kind, service)
        self.spin(client.service_is_ready)
        future = client.call_async(request)
        self.spin(future.done)
        answer = future.result()
        self.node.destroy_client(client)
        return answer

    def get(self, node, *names):
        answer = self.call(
            GetParameters, node + "/get_parameters", GetParameters.Request(names=list(names))
        )
        return [value_of(value) for value in answer.values]

    def types(self, node, *names):
        request = GetParameterTypes.Request(names=list(names))
        return list(self.call(GetParameterTypes, node + "/get_parameter_types", request).types)

    def list(self, node, *prefixes):
        request = ListParameters.Request(prefixes=list(prefixes))
        return list(self.call(ListParameters, node + "/list_parameters", request).result.names)

    def describe(self, node, *names):
        request = DescribeParameters.Request(names=list(names))
        found = self.call(DescribeParameters, node + "/describe_parameters", request).descriptors
        return [[one.name, one.type, one.read_only] for one in found]

    def set(self, node, **values):
        request = SetParameters.Request(parameters=parameters(values))
        results = self.call(SetParameters, node + "/set_parameters", request).results
        return [[one.successful, one.reason] for one in results]

    def set_all(self, node, **values):
        request = SetParametersAtomically.Request(parameters=parameters(values))
        name = node + "/set_parameters_atomically"
        result = self.call(SetParametersAtomically, name, request).result
        return [result.successful, result.reason]

    def load(self, container, kind, name, space, **values):
        """Load a component of package cell; its number in the container, and what is wrong."""
        from composition_interfaces.srv import LoadNode  # noqa: PLC0415  # the wheels have none

        request = LoadNode.Request(package_name="cell", plugin_name=kind, node_name=name)
        request.node_namespace, request.parameters = space, parameters(values)
        answer = self.call(LoadNode, container + "/_container/load_node", request)
        return [answer.unique_id, answer.error_message]

    def unload(self, container, number):
        from composition_interfaces.srv import UnloadNode  # noqa: PLC0415

        request = UnloadNode.Request(unique_id=number)
        return self.call(UnloadNode, container + "/_container/unload_node", request).success


def value_of(value):
    return [None, value.bool_value, value.integer_value, value.double_value, value.string_value][
        value.type
    ]


def parameters(values):
    fields = {bool: "bool_value", int: "integer_value", float: "double_value", str: "string_value"}
    types = {bool: 1, int: 2, float: 3, str: 4}
    return [
        Parameter(
            name=name,
            value=ParameterValue(type=types[type(value)], **{fields[type(value)]: value}),
        )
        for name, value in values.items()
    ]


def main():
    peer = Peer()
    print(json.dumps("ready"), flush=True)
    for line in sys.stdin:
        name, words, keywords = json.loads(line)
        print(json.dumps(getattr(peer, name)(*words, **keywords)), flush=True)


main()
