"""The settings of a running node of ROS 2, as parameters of its hidden node."""

from __future__ import annotations

import re
import sys
from typing import TYPE_CHECKING, Any

from pytpc.python_runtime.config import PARAMETERS, Config, parsed, text_of
from pytpc.python_runtime.errors import warn
from pytpc.python_runtime.ros2_link import NAME

if TYPE_CHECKING:
    from pytpc.python_runtime.runtime import Runtime

_STATUS = "status"
_DESCRIPTIONS = {
    "sink": "where reports go: auto, topic, rosout, file or off",
    "policy": "what is reported: every, edges or light",
    "period": "seconds of one summary",
    "site_cap": "reports per second of one comparison; 0: no limit",
    "process_cap": "reports per second of the process; 0: no limit",
}


class Settings:
    """Gives the parameters their values, and applies those that are set."""

    def __init__(self, runtime: Runtime) -> None:
        self._runtime = runtime

    def begin(self, name: str) -> None:
        """Apply what the command line and its files have for the hidden node of ``name``, once."""
        config = self._runtime.config
        for place, key, value in overrides(sys.argv, f"{name}/{NAME}"):
            new, why = changed(config, key, value)
            if new is None:
                warn(f"{place}: the parameter {key} of {name}/{NAME} is ignored: {why}")
            else:
                config = new
        if not self._runtime.apply(config):
            warn("the settings cannot be applied; the previous ones stay")

    def declare(self, node: Any) -> None:  # noqa: ANN401
        """Declare the parameters on the hidden node."""
        from rcl_interfaces.msg import ParameterDescriptor  # noqa: PLC0415

        for name in PARAMETERS:
            # Any type, because `ros2 param set` takes `off` for false, and 1 for an integer.
            descriptor = ParameterDescriptor(description=_DESCRIPTIONS[name], dynamic_typing=True)
            node.declare_parameter(name, self.value(name), descriptor)
        descriptor = ParameterDescriptor(description="the state of the reports", read_only=True)
        node.declare_parameter(_STATUS, self._runtime.status(), descriptor)
        node.add_on_set_parameters_callback(self._set)

    def value(self, name: str) -> object:
        """The value in effect; None for a parameter that is none of the settings."""
        if name == _STATUS:
            return self._runtime.status()
        if name not in PARAMETERS:
            return None
        config = self._runtime.config.filled_in()
        return config.period_ns / 1e9 if name == "period" else getattr(config, name)

    def _set(self, parameters: list[Any]) -> object:
        """All of them or none."""
        from rcl_interfaces.msg import SetParametersResult  # noqa: PLC0415

        config = self._runtime.config
        for parameter in parameters:
            if parameter.name not in PARAMETERS:
                continue
            new, why = changed(config, parameter.name, parameter.value)
            if new is None:
                reason = f"{parameter.name}: {why}"
                return SetParametersResult(successful=False, reason=reason)
            config = new
        if not self._runtime.apply(config):
            reason = "the settings cannot be applied; the previous ones stay"
            return SetParametersResult(successful=False, reason=reason)
        return SetParametersResult(successful=True)


def changed(config: Config, name: str, value: object) -> tuple[Config | None, str]:
    """``config`` with one more setting; None, and the reason, where it is invalid."""
    if name not in PARAMETERS:
        return None, f"there is no such setting; there are {', '.join(PARAMETERS)}"
    text = text_of(name, value)
    change, why = (None, "it is of the wrong type") if text is None else parsed(name, text)
    return (None, why) if change is None else (config._replace(**change), "")


def overrides(words: list[str], full_name: str) -> list[tuple[str, str, object]]:
    """What a command line has for the hidden node of this name: place, name and value; last wins.

    A rule of ROS names a node without its namespace: ``-p _tpc:sink:=file`` is for all hidden ones.
    """
    found: list[tuple[str, str, object]] = []
    is_ros = False
    for word, following in zip(words, [*words[1:], ""]):
        if word == "--ros-args":
            is_ros = True
        elif word == "--":
            is_ros = False
        elif is_ros and word == "--params-file" and following:
            content = _read(following, is_file=True)
            found += [(following, key, value) for key, value in entries(content, full_name)]
        elif is_ros and word in ("-p", "--param") and following.startswith(NAME + ":"):
            key, assigned, text = following[len(NAME) + 1 :].partition(":=")
            if assigned:
                found.append((word + " " + following, key, _read(text, is_file=False)))
    return found


def _read(source: str, *, is_file: bool) -> object:
    """A file or a text in YAML; None where that cannot be read."""
    try:
        import yaml  # noqa: PLC0415

        if not is_file:
            return yaml.safe_load(source)
        with open(source, encoding="utf-8") as stream:
            return yaml.safe_load(stream)
    except Exception:
        # rcl has refused it already, or there is none of these entries.
        return None


def entries(content: object, full_name: str, above: str = "") -> list[tuple[str, object]]:
    """The parameters in the content of a file for the hidden node of this name.

    Only patterns that end with the name of hidden nodes count: ``/**: {ros__parameters: ...}`` is
    for the program's own parameters, which may have the same names.
    """
    found: list[tuple[str, object]] = []
    if not isinstance(content, dict):
        return found
    for key, inner in content.items():
        if key == "ros__parameters":
            if _is_for(above, full_name) and isinstance(inner, dict):
                found += sorted((str(name), value) for name, value in inner.items())
        else:
            found += entries(inner, full_name, f"{above}/{str(key).strip('/')}")
    return found


def _is_for(pattern: str, full_name: str) -> bool:
    """Whether a pattern of nodes' names is for a hidden node: ``*`` one part, ``**`` any number.

    Without a namespace it is for all hidden nodes, as in a rule of the command line.
    """
    if pattern == f"/{NAME}":
        return True
    if pattern.rpartition("/")[2] != NAME:
        return False
    parts = {"**": r"(/[^/]+)*", "*": r"/[^/]+"}
    expression = "".join(parts.get(part, "/" + re.escape(part)) for part in pattern.split("/")[1:])
    return re.fullmatch(expression, full_name) is not None
