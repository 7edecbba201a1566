"""What the names of a running graph tell: actions, nodes of the robot, what ROS has for itself."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from pytpc.static.wiring import GraphTopic, is_tool

OWN_TOPICS = frozenset(
    {"/rosout", "/rosout_agg", "/clock", "/parameter_events", "/threshold_information"}
)
OWN_SERVICES = frozenset(
    {
        *("get_loggers", "set_logger_level", "get_logger_levels", "set_logger_levels"),
        *("describe_parameters", "get_parameter_types", "get_parameters", "list_parameters"),
        *("set_parameters", "set_parameters_atomically", "get_type_description"),
        *("get_available_states", "get_available_transitions", "get_transition_graph"),
    }
)
"""The last parts of the services that ROS's libraries offer for every node."""
ROS1_ACTION = ("goal", "cancel", "feedback", "result", "status")
ROS2_ACTION = "/_action/"


def action_names(topics: Mapping[str, GraphTopic]) -> dict[str, str]:
    """The names of the actions, with the type of their goals; empty if that is not known."""
    found: dict[str, str] = {}
    for name, topic in topics.items():
        action, ros2, _ = name.partition(ROS2_ACTION)
        if ros2:
            found[action] = ""
            continue
        action, _, last = name.rpartition("/")
        if last == "goal" and all(f"{action}/{part}" in topics for part in ROS1_ACTION):
            found[action] = (topic.type or "").removesuffix("ActionGoal")
    return found


def action_of(topic: str, actions: Iterable[str]) -> str | None:
    """The action that a topic is a part of; None for another topic."""
    action, ros2, _ = topic.partition(ROS2_ACTION)
    if ros2:
        return action
    action, _, last = topic.rpartition("/")
    return action if action in actions and last in ROS1_ACTION else None


def robots(nodes: Iterable[str]) -> frozenset[str]:
    """The nodes that are part of the robot."""
    return frozenset(name for name in nodes if not (is_tool(name) or is_hidden(name)))


def is_hidden(name: str) -> bool:
    """Whether ROS 2 does not show it: a part of it begins with an underscore."""
    return "/_" in name
