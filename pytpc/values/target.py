"""Finds what ``pytpc apply`` and ``pytpc origin`` should change, in a mission or a file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from pytpc.base.closest import did_you_mean, path_hint
from pytpc.base.errors import InputError
from pytpc.base.regular_files import real_path
from pytpc.base.source_bytes import read_bytes
from pytpc.base.wording import listed
from pytpc.static.parameters import same_parameter
from pytpc.values.apply import FileChange, decoded
from pytpc.values.installed import notes_on_file, of_the_system, source_of
from pytpc.values.journal import digest
from pytpc.values.known import NOTHING, Known
from pytpc.values.launch_edit import NewText, add_param, edit_argument, edit_inline, edit_param
from pytpc.values.launch_kinds import is_ros2_launch
from pytpc.values.launch_xml import read_tags
from pytpc.values.new_value import Refused, guessed, read_value
from pytpc.values.origins import (
    IN_ARGS,
    ORIGINS_FILE,
    Origin,
    origins_file,
    read_document,
    read_origins,
)
from pytpc.values.params_target import plan_params
from pytpc.values.rcl_edit import edit_params
from pytpc.values.rcl_params import PARAMS_KEY, is_params_text
from pytpc.values.recorded_files import RecordedFiles, check_keys
from pytpc.values.recording import leaves, origins_of
from pytpc.values.ros2_launch_edit import edit_ros2_launch
from pytpc.values.ros2_trace import OF_ROS2, trace_any_launch
from pytpc.values.scalars import type_of
from pytpc.values.trace import LaunchNode
from pytpc.values.yaml_edit import Edit, all_settings, edit_yaml

_LISTED = 8
_SEE_ALL = "; `pytpc origin` lists those that are set"


@dataclass(frozen=True, slots=True)
class Target:
    """The known origins of values, and the nodes of the launch file.

    ``launch`` is the launch file, None where that is not known. ``files`` has the SHA-256 that the
    files had when they were read. ``recorded`` is true where a recording says all this, and false
    where the launch file was read just now.
    """

    origins: Mapping[str, Origin]
    nodes: Sequence[LaunchNode]
    launch: Path | None
    files: Mapping[str, str] = field(default_factory=dict)
    recorded: bool = False


def read_target(path: Path, args: Mapping[str, str], env: Mapping[str, str]) -> Target:
    """Read the origins and nodes of a mission, given by its folder or bag, or of a launch file.

    Args:
        path: of one of them.
        args: for a launch file.
        env: in which ``$(find ...)`` finds the launch file's packages.

    Raises:
        InputError: no such file, a mission without origins, a launch file that cannot be read.
        MissingToolError: roslaunch is not installed.
    """
    if not path.exists():
        raise InputError(f"no such file or folder{path_hint(path)}", path)
    if path.is_dir() or path.suffix in (".bag", ".parquet"):
        if not origins_file(path).is_file():
            raise InputError(
                f"no {ORIGINS_FILE}: the origins of its values were not recorded; give the launch"
                " file, or record with `pytpc record`",
                path,
            )
        return _of_mission(path)
    trace = trace_any_launch(env, path, args)
    values = dict(
        leaf
        for name, settings in trace.settings.items()
        for leaf in leaves(name, settings[-1].get("value"))
    )
    return Target(origins_of(trace, values), trace.nodes, trace.launch, trace.files)


def _of_mission(path: Path) -> Target:
    file = origins_file(path)
    document = read_document(file)
    try:
        nodes = [LaunchNode.of(node) for node in document.get("nodes", [])]
        files = {str(name): str(value) for name, value in document.get("files", {}).items()}
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise InputError(f"not a file of origins: {error!r}", file) from error
    launch = document.get("launch")
    return Target(
        read_origins(path),
        nodes,
        None if launch is None else Path(str(launch)),
        files,
        recorded=True,
    )


def chosen(
    target: Target, parameter: str, known: Known = NOTHING, *, unheard_of: bool = False
) -> Origin:
    """The origin of the parameter that a user names.

    Args:
        target: where it is looked for.
        parameter: its full name, or the end of it.
        known: what the nodes read.
        unheard_of: take a full name that is most likely a typing mistake, too.

    Returns:
        For a full name that is not set: an origin of the kind ``default``.

    Raises:
        InputError: several parameters are meant, or none.
    """
    if parameter in target.origins:
        return target.origins[parameter]
    meant = [name for name in target.origins if same_parameter(name, parameter)]
    if len(meant) > 1:
        raise InputError(
            f"several parameters end with {parameter}: {listed(sorted(meant), _LISTED)}"
        )
    if meant:
        return target.origins[meant[0]]
    hint = did_you_mean(parameter, [*target.origins, *known.names()])
    if parameter.startswith("/"):
        if unheard_of or known.is_read(parameter) or not (hint or known.is_complete):
            return Origin(parameter, "default", None, None, None, "")
        also = ", and no node reads it" if known.is_complete else ""
        raise InputError(f"{parameter} is not set anywhere{also}{hint or _SEE_ALL}")
    if hint:
        raise InputError(f"{parameter} is not set anywhere{hint}")
    names = listed(sorted(node.name for node in target.nodes), _LISTED) or "no node is known"
    raise InputError(
        f"{parameter} is not set anywhere; to change a default, give the full name, as in"
        f" /NODE/{parameter.lstrip('~/')} ({names})"
    )


def set_together(target: Target, origin: Origin) -> tuple[str, ...]:
    """The parameters that the place of an origin sets: a YAML file may be loaded for two nodes.

    That of the origin is the first, the others are sorted.
    """
    if origin.path is None or origin.lineno is None or origin.kind not in ("yaml", "launch"):
        return (origin.name,)
    others = sorted(
        one.name
        for one in target.origins.values()
        if one.name != origin.name and _same_place(one, origin)
    )
    return (origin.name, *others)


def _same_place(one: Origin, other: Origin) -> bool:
    """Whether two values stand at one place; a line may have several tags or keys."""
    if (one.path, one.lineno, one.keys, one.argument) != (
        other.path,
        other.lineno,
        other.keys,
        other.argument,
    ):
        return False
    if one.keys or one.argument:
        return True
    return one.name.rpartition("/")[2] == other.name.rpartition("/")[2]


def options_to_apply(origin: Origin) -> tuple[str, ...] | None:
    """The options with which ``pytpc apply MISSION`` changes a value; None if it cannot."""
    if origin.kind in ("default", "runtime"):
        return ("--add",)
    in_file = origin.path is not None and origin.kind in ("yaml", "launch")
    return () if in_file and not origin.note.startswith(IN_ARGS) else None


def plan_yaml(
    path: Path, parameter: str, given: str, *, add: bool = False, force: bool = False
) -> FileChange:
    """Work out a change of a YAML file; nothing is written.

    Args:
        path: of the file; symbolic links are followed.
        parameter: its keys from the top, joined by slashes, or the end of them; in a params file
            of ROS 2 as ``plan_params`` reads it.
        given: the new value as typed.
        add: add it to a params file that does not set it.
        force: see ``edit_yaml``.

    Raises:
        InputError: the file cannot be read, or the change is refused; with the line.
    """
    if not path.exists() and not path.is_symlink():
        raise InputError(f"no such file{path_hint(path)}", path)
    real = real_path(path)
    data = read_bytes(real)
    text = decoded(data, path)
    try:
        if is_params_text(text):
            name, edit = plan_params(text, parameter, given, add=add, force=force)
            notes = (*edit.notes, *notes_on_file(path, real))
            return FileChange(name, real, data, edit.data, edit.old, edit.new, edit.lineno, notes)
        wanted = parameter.strip("~/")
        known = {keys for document in all_settings(text) for keys in document}
        whole = [keys for keys in known if "/".join(keys) == wanted]
        ending = [keys for keys in known if "/".join(keys).endswith(f"/{wanted}")]
        meant = sorted(whole or ending)
        if len(meant) != 1:
            names = listed(sorted("/".join(keys) for keys in meant), _LISTED)
            what = f"several values end with {parameter}: {names}" if meant else ""
            hint = did_you_mean(wanted, ["/".join(keys) for keys in known])
            raise Refused(what or f"{parameter} is not in the file{hint}")
        edit = edit_yaml(text, meant[0], given, force=force)
    except Refused as error:
        raise InputError(str(error), path, error.lineno) from error
    notes = (*edit.notes, *notes_on_file(path, real))
    name = "/" + "/".join(meant[0])
    return FileChange(name, real, data, edit.data, edit.old, edit.new, edit.lineno, notes)


def plan_origin(
    origin: Origin,
    given: str,
    *,
    force: bool = False,
    files: Mapping[str, str] | None = None,
    recorded: RecordedFiles | None = None,
) -> FileChange:
    """Work out a change of the file that set a value; nothing is written.

    Args:
        origin: where it stood.
        given: the new value as typed.
        force: see ``edit_yaml``.
        files: path -> SHA-256 of the files as they were then. In one that was changed since, the
            lines may be others, and a tag is changed only where no other one may be meant.
        recorded: what to check where a recording names the file; None where the user does.

    Raises:
        InputError: no file set it, the file is no longer there, or the change is refused.
    """
    path = origin.path
    if origin.note.startswith(IN_ARGS):
        raise InputError(
            f"{origin.name} stands {origin.note}; change it there", path, origin.lineno
        )
    if path is None or origin.kind not in ("yaml", "launch"):
        raise InputError(_why_not(origin))
    file = origin.source or path
    if of_the_system(file) and not force:
        raise InputError(
            "it belongs to an installed package; set the value in a launch file of your own"
            " (--add), or --force",
            file,
        )
    real = real_path(file)
    data = read_bytes(real)
    if recorded is not None:
        check_keys(origin)
        recorded.check(real, data, path, origin.lineno)
    try:
        if origin.kind == "yaml" and PARAMS_KEY in origin.keys:
            edit = edit_params(
                decoded(data, file), origin.keys, given, lineno=origin.lineno, force=force
            )
        elif origin.kind == "yaml":
            edit = edit_yaml(decoded(data, file), origin.keys, given, force=force)
        else:
            as_then = (files or {}).get(str(path), digest(data)) == digest(data)
            edit = _edit_launch(data, origin, given, force, as_then=as_then)
    except Refused as error:
        raise InputError(str(error), file, error.lineno) from error
    notes = (*edit.notes, *notes_on_file(path, real))
    if PARAMS_KEY in origin.keys and "*" in "".join(origin.keys):
        notes = (origin.note, *notes)
    if origin.value is not None and repr(origin.value) != repr(edit.old):
        notes += (f"the robot had {origin.value!r}; the file was changed since",)
    return FileChange(origin.name, real, data, edit.data, edit.old, edit.new, edit.lineno, notes)


def _edit_launch(data: bytes, origin: Origin, given: str, force: bool, *, as_then: bool) -> Edit:
    lineno = (origin.lineno or 0) if as_then else 0
    if origin.param_type == OF_ROS2:
        return edit_ros2_launch(data, origin, lineno, given, force=force)
    if origin.argument:
        via = [
            int(line)
            for file, _, line in (place.rpartition(":") for place in origin.via)
            if Path(file) == origin.path
        ]
        return edit_argument(
            data,
            origin.argument,
            lineno,
            NewText(given, origin.param_type or "auto", force),
            via,
        )
    if origin.param_type:
        return edit_param(data, origin.name, lineno, given, force=force)
    return edit_inline(data, origin.keys, lineno, given, force=force)


def plan_addition(
    origin: Origin,
    target: Target,
    given: str,
    default: object = None,
    recorded: RecordedFiles | None = None,
) -> FileChange:
    """Work out a ``<param>`` for a value that no file sets; nothing is written.

    It goes into the tag of the node in whose namespace it is, else to the end of the launch file.

    Args:
        origin: of the kind ``default`` or ``runtime``.
        target: where the nodes stand.
        given: the new value as typed.
        default: in the code, where it is known: its type is kept.
        recorded: as in ``plan_origin``.

    Raises:
        InputError: the launch file is not known or not here, or a value does not fit.
    """
    below = [node for node in target.nodes if origin.name.startswith(f"{node.name}/")]
    node = max(below, key=lambda one: len(one.name), default=None)
    path = target.launch if node is None else node.path
    if path is None:
        raise InputError(
            "the launch file is not known; give that instead of the mission, or for ROS 2 a params"
            f" file that the node gets: pytpc apply PARAMS.yaml {origin.name} {given} --add"
        )
    file = source_of(path) or path
    if is_ros2_launch(file):
        raise InputError(
            "nothing is added to launch files of ROS 2; add it to a params file that it loads, as"
            f" in: pytpc apply PARAMS.yaml {origin.name} {given} --add",
            file,
        )
    real = real_path(file)
    data = read_bytes(real)
    if recorded is not None:
        recorded.check(real, data, path)
    known = origin.value if origin.value is not None else default
    try:
        value = guessed(given) if known is None else read_value(given, type_of(known))
        offset = None if node is None else _offset_of(data, node)
        name = origin.name if node is None else origin.name[len(node.name) + 1 :]
        edit = add_param(data, offset, name, value, given)
    except Refused as error:
        raise InputError(str(error), file, error.lineno) from error
    notes = notes_on_file(path, real)
    return FileChange(origin.name, real, data, edit.data, None, value, edit.lineno, notes)


def _offset_of(data: bytes, node: LaunchNode) -> int:
    """The place of a node's tag: where it was, or the only one of this name."""
    try:
        tags = [tag for tag in read_tags(data) if tag.name == "node"]
    except ValueError as error:
        raise Refused(str(error)) from error
    own = node.name.rpartition("/")[2]
    named = [t for t in tags if "name" in t.attributes and t.attributes["name"].value == own]
    here = [t for t in tags if t.offset == node.offset and t.lineno == node.lineno]
    if len(named) == 1:
        return named[0].offset
    if not here:
        raise Refused(f"the tag of {node.name} is no longer there", node.lineno)
    return here[0].offset


def _why_not(origin: Origin) -> str:
    name = origin.name
    if origin.kind == "argument":
        return f"{name} is {origin.note}; give {origin.argument}:=VALUE there instead"
    if origin.kind == "default":
        return (
            f"{name} is not set anywhere and has its default in the code; --add puts it into the"
            " launch file"
        )
    if origin.kind == "runtime":
        return (
            f"{name} was set at runtime ({origin.note}); --live sets it on the running robot, --add"
            " puts it into the launch file"
        )
    return f"it is not known where {name} was set; give the launch file or the YAML file"
