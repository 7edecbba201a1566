"""Replaces the methods of launch that start, wait or talk, for ``ros2_launch_tracer``."""

from __future__ import annotations

import contextlib
import os
import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import launch
import launch.actions
import launch.substitutions
import launch_ros.actions
import launch_ros.descriptions
import launch_xml.parser
import launch_yaml.parser
from launch.frontend import Parser
from launch_places import Given, children
from launch_ros.actions.lifecycle_node import LifecycleNode

if TYPE_CHECKING:
    from ros2_launch_tracer import Tracer

_COMMAND = "__tpc_output_of_a_command"
_OWN = tuple(
    str(Path(module.__file__).parent) + os.sep
    for module in (launch, launch_ros, launch_xml, launch_yaml)
)
_HERE = str(Path(__file__).parent) + os.sep


def _calling_frame() -> tuple[str, int] | None:
    """The place outside of launch from which this is called."""
    frame = sys._getframe(2)
    while frame is not None:
        name = frame.f_code.co_filename
        if not name.startswith(_OWN):
            return None if name.startswith((_HERE, "<")) else (name, frame.f_lineno)
        frame = frame.f_back  # type: ignore[assignment]
    return None


def replace_methods(tracer: Tracer) -> None:
    """Put in place of launch's methods those that note and start nothing."""

    def with_frame(kind: Given) -> None:
        before = kind.__init__

        def init(self: Given, *args: Given, **options: Given) -> None:
            frame = _calling_frame()
            if frame is not None and not hasattr(self, "tpc_frame"):
                self.tpc_frame = frame
                tracer.files[frame[0]] = None
            before(self, *args, **options)

        kind.__init__ = init

    with_frame(launch.Action)
    with_frame(launch_ros.descriptions.ComposableNode)
    parse_action = Parser.parse_action

    def parse(self: Given, entity: Given) -> Given:
        action = parse_action(self, entity)
        element = getattr(entity, "_Entity__xml_element", None)
        if element is None:
            element = getattr(entity, "_Entity__element", None)
        action.tpc_element = element
        for name in (
            "_ComposableNodeContainer__composable_node_descriptions",
            "_LoadComposableNodes__composable_node_descriptions",
        ):
            described = getattr(action, name, None) or []
            for one, below in zip(described, children(element, "composable_node")):
                one.tpc_element = below
        return action

    def nothing(_self: Given, _context: Given) -> None:
        return None

    def process(self: Given, _context: Given) -> None:
        tracer.process(self)

    def load(self: Given, _context: Given) -> None:
        container = tracer.container_of(self._LoadComposableNodes__target_container)
        for one in self._LoadComposableNodes__composable_node_descriptions:
            tracer.composed(one, container)

    Parser.parse_action = parse
    actions, ros = launch.actions, launch_ros.actions
    actions.ExecuteProcess.execute = process
    ros.LoadComposableNodes.execute = load
    LifecycleNode.execute = ros.Node.execute
    actions.TimerAction.execute = lambda self, _context: list(self.actions)
    launch.substitutions.Command.perform = lambda _self, _context: _COMMAND
    for kind in (actions.EmitEvent, actions.Shutdown, actions.OpaqueCoroutine, actions.LogInfo):
        kind.execute = nothing
    for module, name in ((ros, "LifecycleTransition"), (ros, "SetROSLogDir")):
        if hasattr(module, name):
            getattr(module, name).execute = nothing
    for name in ("SetParameter", "SetParametersFromFile", "SetUseSimTime"):
        if hasattr(ros, name):
            _note_setting(tracer, getattr(ros, name))
    launch_xml.parser.ET = tracer.elements
    launch_yaml.parser.yaml = tracer.elements


def _note_setting(tracer: Tracer, kind: Given) -> None:
    before = kind.execute

    def execute(self: Given, context: Given) -> Given:
        configurations = context.launch_configurations
        # launch adds to the list of the surrounding scope, which is what the robot gets, too.
        count = len(configurations.get("global_params", []))
        result = before(self, context)
        tracer.set_parameter(self, count)
        return result

    kind.execute = execute


@contextlib.contextmanager
def log_folder() -> Iterator[None]:
    """launch makes a folder for its log, which nobody would look for."""
    folder = tempfile.mkdtemp(prefix="tpc_launch_")
    os.environ["ROS_LOG_DIR"] = folder
    try:
        yield
    finally:
        shutil.rmtree(folder, ignore_errors=True)
