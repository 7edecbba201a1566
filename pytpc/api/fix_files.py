"""What ``pytpc fix`` does to files: it applies a try as ``pytpc apply`` does, and takes it back."""

from __future__ import annotations

import shlex
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path

from pytpc.api import values
from pytpc.api.fix_state import FixTry
from pytpc.api.values import FileChange, Journal, JournalEntry, OutsideError, Place
from pytpc.base.errors import InputError
from pytpc.base.paths import OWN_FOLDER
from pytpc.base.wording import Number, exact
from pytpc.recording.mission import read_run
from pytpc.ros.mission_run import MCAP_FILE
from pytpc.static.parameters import resolved
from pytpc.values.apply import take_back_file
from pytpc.values.origins import Origin, origin_for, origins_file, read_origins, split_name
from pytpc.values.recorded_files import DiffersError
from pytpc.values.target import options_to_apply


@dataclass(frozen=True, slots=True)
class Setting:
    """How a value gets to the robot: by the ``change`` of a file, or else a person sets it.

    ``by_hand`` then says how, and why.
    """

    name: str
    change: FileChange | None
    by_hand: str = ""


def name_on_robot(mission: Path, parameter: str, node: str) -> tuple[str, Origin | None]:
    """The full name of a suspect, and where its value came from; None if that is not known.

    Args:
        mission: the recording.
        parameter: its name in the source, or its full name.
        node: the node that compared it.

    Raises:
        InputError: origins.json is there and cannot be read.
    """
    found = origin_for(read_origins(mission), parameter, node, None)
    if found is not None:
        return found.name, found
    own = node.partition(" ")[0]
    return (resolved(parameter, own) if own.startswith("/") else parameter), None


def setting(place: Place, name: str, origin: Origin | None, value: Number) -> Setting:
    """Work out how a parameter gets a value; nothing is written.

    Args:
        place: the mission, with the workspace and the file that the user confirmed.
        name: the full name of the parameter.
        origin: where its value came from.
        value: the new one.

    Raises:
        OutsideError: the recording names a file that is in no workspace.
        DiffersError: the file that set it is not as it was recorded.
    """
    text = exact(value)
    options = None if origin is None else options_to_apply(origin)
    if origin is None or options is None:
        why = "the file that set it is not known"
        if origin is not None and origin.kind != "unknown":
            why = f"its value came from {origin.words()}"
        return Setting(name, None, _by_hand(place.path, name, text, why))
    try:
        change = values.plan(place, name, text, add="--add" in options)
    except (OutsideError, DiffersError):
        raise
    except InputError as error:
        return Setting(name, None, _by_hand(place.path, name, text, str(error)))
    return Setting(name, change)


def _by_hand(mission: Path, name: str, value: str, why: str) -> str:
    if (origins_file(mission).with_name(MCAP_FILE)).exists():
        words = ["ros2", "param", "set", *split_name(name), value]
    else:
        words = ["rosparam", "set", name, value]
    return f"set {name} to {value} yourself ({why}), for example: {shlex.join(words)}"


def apply_try(change: FileChange, journal: Journal, found: FixTry) -> FixTry:
    """Write the change of a try.

    Raises:
        TpcError: it cannot be written; the file is as it was.
    """
    entry = values.apply(change, journal)
    return replace(found, undo=None if entry is None else entry.number)


def with_change(found: FixTry, change: FileChange | None) -> FixTry:
    """The try as it is written down before its file is changed."""
    when = datetime.now().astimezone().isoformat(timespec="seconds")
    return replace(found, path=None if change is None else change.path, when=when)


def take_back(found: FixTry, journal: Journal) -> FixTry:
    """Take back the change of a try; one that was taken back before is left alone.

    Raises:
        TpcError: the file was changed since, by somebody else or by a later change.
    """
    entry = entry_of_try(found, journal)
    if entry is not None:
        take_back_file(entry, journal)
    return replace(found, undone=True)


def entry_of_try(found: FixTry, journal: Journal) -> JournalEntry | None:
    """The entry of a try in the journal; None if there is none, or none any more.

    Numbers are given again after an undo, so the number alone does not say which change it is; and
    whoever was interrupted while the file was written has no number.
    """
    if found.path is None:
        return None
    begun = datetime.fromisoformat(found.when)
    for entry in journal.entries():
        same = (entry.path, entry.parameter) == (found.path, found.name)
        numbered = found.undo in {None, entry.number}
        if same and numbered and datetime.fromisoformat(entry.time) >= begun:
            return entry
    return None


def run_again(mission: Path) -> str:
    """The command that flies a mission again, as far as the recording says it."""
    run = read_run(mission if mission.is_dir() else mission.parent)
    launch, args, static = run.get("launch"), run.get("args"), run.get("static")
    if not isinstance(launch, str):
        return ""
    workspace = "WORKSPACE"
    built = static.get("path") if isinstance(static, dict) else None
    if isinstance(built, str) and Path(built).parent.name == OWN_FOLDER:
        workspace = shlex.quote(str(Path(built).parent.parent))
    given = [f"{name}:={value}" for name, value in args.items()] if isinstance(args, dict) else []
    return f"pytpc run {workspace} {shlex.join([launch, *given])}"
