"""Values of parameters: where they came from, and how they are changed and changed back."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from pytpc.base.errors import InputError
from pytpc.build.build import installed, workspace_env
from pytpc.ros.ros1.live_values import LiveChange, Robot, set_live, take_back_live
from pytpc.ros.ros1.master import uri_of
from pytpc.values.apply import FileChange, apply_change, entry_of, take_back_file
from pytpc.values.journal import Journal, JournalEntry, folder_of
from pytpc.values.origins import Origin
from pytpc.values.target import (
    Target,
    chosen,
    is_yaml,
    plan_addition,
    plan_origin,
    plan_yaml,
    read_target,
)

__all__ = ["FileChange", "Journal", "JournalEntry", "LiveChange", "LiveSetting", "Origin", "Place"]
__all__ += ["apply", "apply_live", "is_yaml", "journal", "origins", "plan", "undo"]


@dataclass(frozen=True, slots=True)
class Place:
    """Where values are looked up: a mission's folder, a launch file or a YAML file.

    ``args`` are a launch file's arguments; ``workspace`` is the built workspace that ``$(find
    ...)`` searches, None: the sourced one.
    """

    path: Path
    args: Mapping[str, str] = field(default_factory=dict)
    workspace: Path | None = None


@dataclass(frozen=True, slots=True)
class LiveSetting:
    """A value on the running robot: the change that was asked for, and what the robot holds now.

    ``taken`` says whether the node uses it at once; ``entry`` is None after a dry run.
    """

    name: str
    change: LiveChange
    holds: object
    taken: bool
    entry: JournalEntry | None


def journal() -> Journal:
    """The changes that can be taken back."""
    return Journal(folder_of(os.environ))


def origins(place: Place, parameter: str | None = None) -> list[Origin]:
    """Where the values of all parameters, or of one, came from.

    Raises:
        InputError: the parameter is unknown, or the place does not say where values came from.
    """
    found = _target(place)
    return [chosen(found, parameter)] if parameter else list(found.origins.values())


def plan(
    place: Place, parameter: str, value: str, *, add: bool = False, force: bool = False
) -> FileChange:
    """The change of a file that gives a parameter a value; nothing is written.

    Args:
        place: where the value is to be changed.
        parameter: its name, or the end of it.
        value: as typed.
        add: add it to the launch file if no file sets it.
        force: allow another type, and changes that affect other parameters, too.

    Raises:
        InputError: there is no such parameter, or it cannot be changed there.
    """
    if is_yaml(place.path):
        return plan_yaml(place.path, parameter, value, force=force)
    target = _target(place)
    origin = chosen(target, parameter)
    if add and origin.kind in ("default", "runtime"):
        return plan_addition(origin, target, value)
    return plan_origin(origin, value, force=force, files=target.files)


def apply(change: FileChange, notes: Journal) -> JournalEntry | None:
    """Write a change; None if the file has that value already.

    Raises:
        TpcError: it cannot be written, or cannot be noted for ``undo``.
    """
    return None if change.before == change.after else apply_change(change, notes)


def apply_live(
    parameter: str, value: str, notes: Journal, *, dry_run: bool = False, force: bool = False
) -> LiveSetting:
    """Set a parameter on the robot at ROS_MASTER_URI.

    Raises:
        InputError: there is no such parameter, or several.
        RunError: the robot does not answer, or refuses the value.
    """
    robot = Robot(uri_of(os.environ))
    name = _full_name(robot, parameter)
    change = robot.plan(name, value, force=force)
    if dry_run:
        return LiveSetting(name, change, change.new, False, None)
    entry, holds, taken = set_live(robot, change, notes)
    return LiveSetting(name, change, holds, taken, entry)


def undo(
    notes: Journal, what: str = "", *, dry_run: bool = False, force: bool = False
) -> tuple[JournalEntry, FileChange | None]:
    """Take back a change; for one of a file, the change that did so comes with it.

    Args:
        notes: where the changes are noted.
        what: a file or a number; empty: the last one.
        dry_run: write nothing.
        force: even if the robot's value was changed since.

    Raises:
        InputError: there is no such change.
    """
    entry = entry_of(notes, what)
    if entry.path is not None:
        return entry, take_back_file(entry, notes, dry_run=dry_run)
    take_back_live(entry, notes, dry_run=dry_run, force=force)
    return entry, None


def _target(place: Place) -> Target:
    env: Mapping[str, str] = os.environ
    if place.workspace is not None:
        env = workspace_env(installed(place.workspace))
    if is_yaml(place.path):
        raise InputError("a YAML file does not say where other values come from", place.path)
    return read_target(place.path, place.args, env)


def _full_name(robot: Robot, parameter: str) -> str:
    if parameter.startswith("/"):
        return parameter
    wanted = parameter.lstrip("~/")
    meant = [name for name in robot.parameters() if name.endswith(f"/{wanted}")]
    if len(meant) != 1:
        names = ", ".join(meant[:8]) or "none"
        raise InputError(f"give the full name: the robot has {names} that ends with {parameter}")
    return meant[0]
