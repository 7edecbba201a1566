"""The values that a launch file sets, each with the file and line that sets it.

``trace_launch`` runs ``pytpc.values.tracer.launch_tracer`` with roslaunch's own Python, and
``pytpc.values.origin_places`` turns what that says into places.
"""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from pytpc.base.errors import InputError, MissingToolError, RunError
from pytpc.values.origins import Origin

# It runs with roslaunch's Python, so it is not imported.
_TRACER = Path(__file__).with_name("tracer") / "launch_tracer.py"
_PATIENCE_S = 60.0
_SHEBANG_BYTES = 256
_LONGEST = 600
# What roslaunch says of a package that it does not find.
_NO_PACKAGE = re.compile(r"(?P<package>[^\s:]+) ROS path \[0\]=")
# The word of launch_tracer for the random part of $(anon x).
_ANONYMOUS = "__tpc_anon"


class PackageNotFoundError(InputError):
    """A launch file needs a package that is not in the environment in which it is read."""


def pairs(found: Iterable[Sequence[str]]) -> tuple[tuple[str, str], ...]:
    """Pairs of names that were lists in JSON."""
    return tuple((str(before), str(after)) for before, after in found)


@dataclass(frozen=True, slots=True)
class LaunchNode:
    """A ``<node>`` that would be started: its full name, package, program and tag.

    ``args`` are its arguments under ROS 1. Of a component, ``program`` is its class, and
    ``container`` the full name of the node that loads it. ``remaps`` are pairs of names as they are
    written: what the code calls a topic or service, and its new name.
    """

    name: str
    package: str
    program: str
    path: Path
    lineno: int
    offset: int
    args: str = ""
    container: str = ""
    remaps: tuple[tuple[str, str], ...] = ()

    @classmethod
    def of(cls, fields: Mapping[str, Any]) -> LaunchNode:
        """The node with these fields, as in JSON."""
        remaps = pairs(fields.get("remaps", ()))
        return cls(**{**fields, "path": Path(fields["path"]), "remaps": remaps})

    def to_json(self) -> dict[str, object]:
        """The fields; ``of`` reads them."""
        return {**asdict(self), "path": str(self.path)}


@dataclass(frozen=True, slots=True)
class Trace:
    """What a launch file sets.

    ``settings`` has for each parameter, by full name, what set it in this order: the last holds.
    Each is the object that ``launch_tracer`` describes. ``files`` has the SHA-256 of every launch
    and YAML file that was read. ``absent`` has package and program of the nodes that roslaunch
    would not find. ``placed`` has the origins themselves where launch of ROS 2 has read the file;
    ``unknown`` says what could not be followed there. ``launch`` is None where the nodes of ROS 2
    were started without a launch file. ``declaring`` has the nodes of ROS 2 whose command lines
    are known: a value that these do not set is the default in the code.
    """

    launch: Path | None
    args: Mapping[str, str]
    settings: Mapping[str, Sequence[Mapping[str, Any]]]
    nodes: Sequence[LaunchNode]
    files: Mapping[str, str]
    absent: Sequence[tuple[str, str]] = ()
    placed: Mapping[str, Origin] | None = None
    unknown: Sequence[str] = ()
    declaring: frozenset[str] = frozenset()

    @property
    def by_roslaunch(self) -> set[str]:
        """The parameters that roslaunch sets before nodes run; nodes set those in their args."""
        return {
            name
            for name, settings in self.settings.items()
            if any(setting.get("from") != "args" for setting in settings)
        }

    @property
    def sim_time(self) -> bool | None:
        """Whether it has the graph run on /clock; None where it does not say."""
        said = [one.get("value") for one in self.settings.get("/use_sim_time", ())]
        return None if not said else said[-1] is True


def roslaunch_python(env: Mapping[str, str]) -> str:
    """The Python that roslaunch runs with.

    Raises:
        MissingToolError: roslaunch is not on this environment's PATH.
    """
    path = env.get("PATH")
    if shutil.which("roslaunch", path=path) is None:
        raise MissingToolError(
            "roslaunch not found; install it with: apt-get install python3-roslaunch"
        )
    return interpreter_of("roslaunch", path)


def interpreter_of(name: str, path: str | None) -> str:
    """The Python that a program on a PATH runs with; without the program, that of the PATH."""
    program = shutil.which(name, path=path)
    first = ""
    if program is not None:
        with Path(program).open("rb") as stream:
            first = stream.read(_SHEBANG_BYTES).partition(b"\n")[0].decode("utf-8", "replace")
    words = first.removeprefix("#!").split() if first.startswith("#!") else []
    if words and Path(words[0]).name == "env":
        words = [shutil.which(words[-1], path=path) or ""]
    if not words or "python" not in words[0]:
        return shutil.which("python3", path=path) or "/usr/bin/python3"
    return words[0]


def trace_launch(
    env: Mapping[str, str],
    launch: Path,
    args: Mapping[str, str],
    *,
    patience_s: float = _PATIENCE_S,
) -> Trace:
    """Read a launch file as roslaunch would, and start nothing.

    Args:
        env: the environment of the workspace, in which ``$(find ...)`` finds packages.
        launch: the launch file.
        args: its arguments, as on roslaunch's command line.
        patience_s: how long it may take.

    Raises:
        PackageNotFoundError: it needs a package that is not there.
        InputError: roslaunch would not take the file; the message is its own.
        MissingToolError: roslaunch is not installed.
        RunError: it does not end.
    """
    if not launch.is_file():
        raise InputError("no such launch file", launch)
    python = roslaunch_python(env)
    try:
        answer = run_tracer([python, str(_TRACER)], env, launch, args, patience_s=patience_s)
    except TracerError as error:
        why = error.why
        if why.startswith("ModuleNotFoundError"):
            raise MissingToolError(
                f"{python} has no roslaunch; install it with: apt-get install python3-roslaunch"
            ) from None
        if unknown := _NO_PACKAGE.search(why):
            raise PackageNotFoundError(
                f"it needs the package {unknown['package']}, which no sourced workspace has", launch
            ) from None
        raise InputError(f"roslaunch cannot read it: {error.short}", launch) from None
    nodes = [LaunchNode.of(node) for node in answer["nodes"]]
    absent = [(str(package), str(program)) for package, program in answer["absent"]]
    parameters, files = answer["parameters"], answer["files"]
    return Trace(launch.absolute(), dict(args), parameters, nodes, files, absent)


class TracerError(Exception):
    """A tracer could not read a launch file.

    Attributes:
        why: the last line of what it said.
    """

    def __init__(self, why: str) -> None:
        super().__init__(why)
        self.why = why

    @property
    def short(self) -> str:
        """The line without its middle if it is long, as of an endless chain of includes."""
        if len(self.why) <= _LONGEST:
            return self.why
        return f"{self.why[: _LONGEST // 2]} ... {self.why[-_LONGEST // 2 :]}"


def run_tracer(
    command: Sequence[str],
    env: Mapping[str, str],
    launch: Path,
    args: Mapping[str, str],
    *,
    patience_s: float,
) -> dict[str, Any]:
    """What a program of ``pytpc.values.tracer`` says of a launch file.

    Args:
        command: the interpreter under which it runs, and the program.
        env: its environment.
        launch: the launch file.
        args: its arguments, as on the command line.
        patience_s: how long it may take.

    Raises:
        TracerError: it ended with an error.
        RunError: it does not end.
    """
    given = [f"{name}:={value}" for name, value in sorted(args.items())]
    try:
        ran = subprocess.run(
            [*command, str(launch.absolute()), *given],
            env={**env, "PYTHONDONTWRITEBYTECODE": "1"},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=patience_s,
            check=False,
            # A Ctrl-C is for the program that asks, which goes on with what is read.
            start_new_session=True,
        )
    except subprocess.TimeoutExpired as error:
        raise RunError(f"was not read within {patience_s:.0f} s", launch) from error
    if ran.returncode != 0:
        said = ran.stderr.decode("utf-8", "replace").strip().splitlines()
        raise TracerError(said[-1] if said else "no reason")
    answer: dict[str, Any] = json.loads(ran.stdout)
    return answer


def name_on_server(name: str, on_server: Collection[str]) -> str:
    """The name with which a parameter of the launch file stands on the server.

    They differ where ``$(anon x)`` is in it, for which roslaunch puts a random name.
    """
    if _ANONYMOUS not in name:
        return name
    pattern = "_[^/]+".join(re.escape(part) for part in name.split(_ANONYMOUS))
    matching = [known for known in on_server if re.fullmatch(pattern, known)]
    return matching[0] if len(matching) == 1 else name
