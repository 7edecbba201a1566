"""Checks the files that a recording names before one of them is changed.

A recording may come from somebody else, and its origins.json says which file, key and line is to be
edited. Such a file must belong to a robot of this user, be as it was when it was recorded, and the
key in it must be that of the parameter.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from pytpc.base.errors import InputError
from pytpc.base.paths import OWN_FOLDER, home
from pytpc.base.regular_files import real_path
from pytpc.base.source_bytes import read_bytes
from pytpc.values.installed import SYSTEM_FOLDERS
from pytpc.values.journal import JournalEntry, digest
from pytpc.values.origins import Origin, split_name
from pytpc.values.rcl_params import PARAMS_KEY, NodeEntry
from pytpc.workspace.packages import MANIFEST

_PACKAGE_PATH = "ROS_PACKAGE_PATH"
_PREFIX_PATHS = (_PACKAGE_PATH, "CMAKE_PREFIX_PATH", "AMENT_PREFIX_PATH")


class OutsideError(InputError):
    """A recording names a file outside of every workspace; ``file`` is changed if confirmed."""

    def __init__(self, file: Path, line: int | None) -> None:
        super().__init__(
            "the recording names this file, which is in no workspace or package and not beside the"
            f" recorded launch file; if it is the right one, add --file {file}",
            file,
            line,
        )
        self.file = file


class DiffersError(InputError):
    """A file is not as it was recorded."""


@dataclass(frozen=True)
class RecordedFiles:
    """What is known about the files of a recording.

    Args:
        launch: the launch file that it names.
        digests: path -> SHA-256 of each file when it was recorded.
        workspaces: folders of this user's workspaces.
        changes: earlier changes by ``pytpc apply``, oldest first.
        confirmed: a file that the user has named.
        force: change a file that is not as it was recorded.
    """

    launch: Path | None
    digests: Mapping[str, str]
    workspaces: Sequence[Path] = ()
    changes: Sequence[JournalEntry] = field(default=())
    confirmed: Path | None = None
    force: bool = False

    def check(self, real: Path, data: bytes, named: Path, line: int | None = None) -> None:
        """Check a file that is about to be changed.

        Args:
            real: the file without symbolic links.
            data: its content.
            named: its path in the recording, which may be that of an installed copy.
            line: of the value, for the message.

        Raises:
            OutsideError: it is in no workspace.
            DiffersError: it is not as it was recorded.
            InputError: it is not the one that was confirmed.
        """
        if self.confirmed is not None:
            if real_path(self.confirmed) != real:
                raise InputError(f"this file would be changed, not {self.confirmed}", real, line)
        elif not self._is_of_a_robot(real):
            raise OutsideError(real, line)
        if not self.force and not self._is_as_recorded(real, data, named):
            what = "differs from the file that was recorded"
            if str(named) not in self.digests:
                what = "the recording has no digest of this file"
            raise DiffersError(
                f"{what}, so another value may be in this place; edit it by hand, give the launch"
                " file instead of the recording, or --force",
                real,
                line,
            )

    def _is_as_recorded(self, real: Path, data: bytes, named: Path) -> bool:
        """Whether the content is the recorded one, or what ``apply`` has made of it since."""
        known = {self.digests.get(str(named))}
        for change in self.changes:
            if change.path == real and change.before is not None and digest(change.before) in known:
                known.add(change.after)
        return digest(data) in known

    def _is_of_a_robot(self, real: Path) -> bool:
        own = home().resolve()
        for folder in real.parents:
            if folder in (own, Path("/")) or not _is_shown_in(real, [folder]):
                break
            if (folder / MANIFEST).is_file() or (folder / OWN_FOLDER).is_dir():
                return True
        return _is_shown_in(real, self.workspaces) or self._is_beside_launch(real, own)

    def _is_beside_launch(self, real: Path, own: Path) -> bool:
        """Whether it is in the folder of the launch file, which only its digest proves."""
        if self.launch is None:
            return False
        try:
            launch = real_path(self.launch)
            recorded = self._is_as_recorded(launch, read_bytes(launch), self.launch)
        except (InputError, OSError):
            return False
        folder = launch.parent
        is_near = real.parent == folder or folder not in (own, Path("/"))
        return recorded and is_near and _is_shown_in(real, [folder])


def check_keys(origin: Origin) -> None:
    """Check that the keys of an origin are those of its parameter.

    Raises:
        InputError: the recording names a key of something else.
    """
    if PARAMS_KEY in origin.keys:
        _check_params_keys(origin)
        return
    path = "/".join(key.strip("/") for key in origin.keys if key.strip("/"))
    if path and not f"/{origin.name.strip('/')}".endswith(f"/{path}"):
        raise _other_key(path, origin)


def _check_params_keys(origin: Origin) -> None:
    """``check_keys`` for a params file of ROS 2."""
    at = origin.keys.index(PARAMS_KEY)
    node, name = split_name(origin.name)
    entry = NodeEntry("/".join(key.rstrip("/") for key in origin.keys[:at]))
    if not entry.fits(node) or name != ".".join(origin.keys[at + 1 :]):
        raise _other_key("/".join(origin.keys), origin)


def _other_key(path: str, origin: Origin) -> InputError:
    return InputError(
        f"the recording names the key {path}, which is not that of {origin.name}; edit it by"
        " hand, or give the launch file instead of the recording",
        origin.path,
        origin.lineno,
    )


def workspaces_of(environment: Mapping[str, str], chosen: Path | None = None) -> tuple[Path, ...]:
    """The workspaces that are sourced, and one that the user has named; not those of the system."""
    folders = [chosen] if chosen is not None else []
    for variable in _PREFIX_PATHS:
        for text in environment.get(variable, "").split(":"):
            if text.startswith("/"):
                folders.append(_workspace_of(Path(text)))
    return tuple(dict.fromkeys(_usable(folders)))


def _workspace_of(prefix: Path) -> Path:
    """The workspace of an install space, or of the space of one package in it."""
    above = (prefix, prefix.parent, prefix.parent.parent)
    return next((one for one in above if (one / "src").is_dir()), prefix)


def _usable(folders: Iterable[Path]) -> Iterable[Path]:
    barred = (Path("/"), home().resolve(), *SYSTEM_FOLDERS)
    for folder in folders:
        try:
            real = real_path(folder)
        except (InputError, OSError):
            continue
        if real not in barred and not any(system in real.parents for system in SYSTEM_FOLDERS):
            yield real


def _is_shown_in(real: Path, folders: Collection[Path]) -> bool:
    """Whether a file is below one of the folders, and in no hidden folder there."""
    return any(
        folder in real.parents
        and not any(part.startswith(".") for part in real.relative_to(folder).parts)
        for folder in folders
    )
