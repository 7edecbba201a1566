"""Values of parameters: where they came from, and how they are changed and changed back."""

from __future__ import annotations

import os
import shlex
from collections.abc import Mapping
from contextlib import closing
from dataclasses import dataclass, field, replace
from pathlib import Path

from pytpc.api.static_of_mission import static_near
from pytpc.base.closest import did_you_mean
from pytpc.base.errors import InputError
from pytpc.base.paths import OWN_FOLDER
from pytpc.base.wording import listed
from pytpc.build.nodes_env import nodes_env
from pytpc.ros.caller_env import with_callers
from pytpc.ros.graphs import robot_at, set_live, take_back_live
from pytpc.ros.live_change import LiveChange, LiveRobot
from pytpc.ros.ros1.master import uri_of
from pytpc.static.static_info import StaticInfo
from pytpc.values.apply import FileChange, apply_change, entry_of, take_back_file
from pytpc.values.declared import declared_in, read_declared
from pytpc.values.journal import Journal, JournalEntry, folder_of
from pytpc.values.known import Known, package_folder
from pytpc.values.launch_kinds import is_of_ros2, is_yaml
from pytpc.values.new_value import Refused
from pytpc.values.origins import Origin
from pytpc.values.recorded_files import OutsideError, RecordedFiles, workspaces_of
from pytpc.values.ros2_arguments import origins_in_params
from pytpc.values.target import (
    Target,
    chosen,
    plan_addition,
    plan_origin,
    plan_yaml,
    read_target,
    set_together,
)
from pytpc.values.trace import PackageNotFoundError

__all__ = ["FileChange", "Journal", "JournalEntry", "LiveChange", "LiveSetting", "Origin"]
__all__ += ["OutsideError", "Place"]
__all__ += ["apply", "apply_live", "is_of_ros2", "is_yaml", "journal", "origins", "plan", "undo"]


@dataclass(frozen=True, slots=True)
class Place:
    """Where values are looked up: a mission's folder, a launch file or a YAML file.

    ``args`` are a launch file's arguments; ``workspace`` is the built workspace that ``$(find
    ...)`` searches, None: the sourced one. ``confirmed`` is a file that the user agrees to change
    although it is in no workspace and only a recording names it.
    """

    path: Path
    args: Mapping[str, str] = field(default_factory=dict)
    workspace: Path | None = None
    confirmed: Path | None = None


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
    if is_yaml(place.path) and is_of_ros2(place.path):
        found = Target(origins_in_params(place.path, parameter), (), None)
    else:
        found = _target(place)
    if not parameter:
        return list(found.origins.values())
    return [chosen(found, parameter, Known.of(_static_near(place), ()))]


def plan(
    place: Place, parameter: str, value: str, *, add: bool = False, force: bool = False
) -> FileChange:
    """The change of a file that gives a parameter a value; nothing is written.

    Args:
        place: where the value is to be changed.
        parameter: its name, or the end of it.
        value: as typed.
        add: add it to the launch file if no file sets it.
        force: allow another type, a value outside of the declared range, a name that nothing sets
            or reads, changes that affect other parameters, too, and changes of a file that is not
            as it was recorded.

    Raises:
        OutsideError: a recording names a file that is in no workspace.
        InputError: there is no such parameter, or it cannot be changed there.
    """
    if is_yaml(place.path):
        change = plan_yaml(place.path, parameter, value, add=add, force=force)
        return change if force else _checked(change, _known(place))
    target, known = _target(place), _known(place)
    # Only static information tells an unset parameter from a typing mistake for certain.
    added_anyway = add and (force or not known.reads)
    origin = chosen(target, parameter, known, unheard_of=added_anyway)
    recorded = None
    if target.recorded:
        recorded = RecordedFiles(
            launch=target.launch,
            digests=target.files,
            workspaces=workspaces_of(os.environ, place.workspace),
            changes=journal().entries(),
            confirmed=place.confirmed,
            force=force,
        )
    if add and origin.kind in ("default", "runtime"):
        change = plan_addition(origin, target, value, recorded=recorded)
    else:
        change = plan_origin(origin, value, force=force, files=target.files, recorded=recorded)
        change = replace(change, also=set_together(target, origin)[1:])
    return change if force else _checked(change, known)


def apply(change: FileChange, notes: Journal) -> JournalEntry | None:
    """Write a change; None if the file has that value already.

    Raises:
        TpcError: it cannot be written, or cannot be noted for ``undo``.
    """
    return None if change.before == change.after else apply_change(change, notes)


def apply_live(
    change: tuple[str, str],
    notes: Journal,
    *,
    graph: str = "",
    dry_run: bool = False,
    force: bool = False,
) -> LiveSetting:
    """Set a parameter on a running robot.

    Args:
        change: the parameter, by its full name or the end of it, and its value as typed.
        notes: where the change is noted.
        graph: the address of the robot's graph; empty: that of ROS_MASTER_URI.
        dry_run: set nothing.
        force: change the type, or set what nobody has set.

    Raises:
        InputError: there is no such parameter, or several.
        RunError: the robot does not answer, or refuses the value.
    """
    parameter, value = change
    with closing(robot_at(graph or uri_of(os.environ))) as robot:
        name = _full_name(robot, parameter)
        planned = robot.plan(name, value, force=force)
        if dry_run:
            return LiveSetting(name, planned, planned.new, False, None)
        entry, holds, taken = set_live(robot, planned, notes)
        return LiveSetting(name, planned, holds, taken, entry)


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


def _checked(change: FileChange, known: Known) -> FileChange:
    """The change, if the value has the declared type and range of each parameter.

    Raises:
        InputError: it is not.
    """
    try:
        known.check_type(change.parameters, change.new)
        known.check_range(change.parameters, change.new)
    except Refused as error:
        raise InputError(str(error), change.path, change.lineno) from error
    return change


def _known(place: Place) -> Known:
    """What nodes read, and what is declared, as far as the place leads to it."""
    static = _static_near(place)
    package = package_folder(place.path)
    folders = [place.path, *([] if package is None else [package])]
    if static is None:
        return Known.of(None, read_declared(folders))
    return Known.of(static, declared_in(static, folders))


def _static_near(place: Place) -> StaticInfo | None:
    """The static information of the mission, or of the workspace in which the file is."""
    return static_near(place.path if place.workspace is None else place.workspace)


def _target(place: Place) -> Target:
    env: Mapping[str, str] = os.environ
    if place.workspace is not None:
        # As `record` has it.
        env = with_callers(nodes_env(place.workspace), os.environ)
    if is_yaml(place.path):
        raise InputError("a YAML file does not say where other values come from", place.path)
    try:
        return read_target(place.path, place.args, env)
    except PackageNotFoundError as error:
        if place.workspace is not None:
            raise
        built = _workspace_above(place.path)
        named = "WORKSPACE" if built is None else shlex.quote(str(built))
        raise InputError(
            f"{error.message}; give the built workspace that has it: --workspace {named}",
            error.path,
        ) from error


def _workspace_above(path: Path) -> Path | None:
    """The workspace that `pytpc build` built and that a file is in."""
    folders = path.absolute().parents
    return next((folder for folder in folders if (folder / OWN_FOLDER).is_dir()), None)


def _full_name(robot: LiveRobot, parameter: str) -> str:
    if parameter.startswith("/"):
        return parameter
    wanted = parameter.lstrip("~/")
    names = robot.parameters()
    meant = [name for name in names if name.endswith((f"/{wanted}", f".{wanted}"))]
    if len(meant) != 1:
        hint = "" if meant else did_you_mean(parameter, names)
        found = listed(meant, 8) or "none"
        raise InputError(
            f"give the full name: the robot has {found} that ends with {parameter}{hint}"
        )
    return meant[0]
