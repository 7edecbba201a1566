"""The values that a launch file sets, each with the file and line that sets it.

``trace_launch`` runs ``pytpc.values.tracer.launch_tracer`` with roslaunch's own Python, and
``pytpc.values.origin_places`` turns what that says into places.
"""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from pytpc.base.errors import InputError, MissingToolError, RunError

# It runs with roslaunch's Python, so it is not imported.
_TRACER = Path(__file__).with_name("tracer") / "launch_tracer.py"
_PATIENCE_S = 60.0
_SHEBANG_BYTES = 256
_LONGEST = 600
# The word of launch_tracer for the random part of $(anon x).
_ANONYMOUS = "__tpc_anon"


@dataclass(frozen=True, slots=True)
class LaunchNode:
    """A ``<node>`` that would be started: its full name, package, program and tag."""

    name: str
    package: str
    program: str
    path: Path
    lineno: int
    offset: int

    @classmethod
    def of(cls, fields: Mapping[str, Any]) -> LaunchNode:
        """The node with these fields, as in JSON."""
        return cls(**{**fields, "path": Path(fields["path"])})

    def to_json(self) -> dict[str, object]:
        """The fields; ``of`` reads them."""
        return {**asdict(self), "path": str(self.path)}


@dataclass(frozen=True, slots=True)
class Trace:
    """What a launch file sets.

    ``settings`` has for each parameter, by full name, what set it in this order: the last holds.
    Each is the object that ``launch_tracer`` describes. ``files`` has the SHA-256 of every launch
    and YAML file that was read.
    """

    launch: Path
    args: Mapping[str, str]
    settings: Mapping[str, Sequence[Mapping[str, Any]]]
    nodes: Sequence[LaunchNode]
    files: Mapping[str, str]

    @property
    def by_roslaunch(self) -> set[str]:
        """The parameters that roslaunch sets before nodes run; nodes set those in their args."""
        return {
            name
            for name, settings in self.settings.items()
            if any(setting.get("from") != "args" for setting in settings)
        }


def roslaunch_python(env: Mapping[str, str]) -> str:
    """The Python that roslaunch runs with.

    Raises:
        MissingToolError: roslaunch is not on this environment's PATH.
    """
    path = env.get("PATH")
    program = shutil.which("roslaunch", path=path)
    if program is None:
        raise MissingToolError(
            "roslaunch not found; install it with: apt-get install python3-roslaunch"
        )
    with Path(program).open("rb") as stream:
        first = stream.read(_SHEBANG_BYTES).partition(b"\n")[0].decode("utf-8", "replace")
    words = first.removeprefix("#!").split() if first.startswith("#!") else []
    if words and Path(words[0]).name == "env":
        words = [shutil.which(words[-1], path=path) or ""]
    if not words or "python" not in words[0]:
        words = [shutil.which("python3", path=path) or "/usr/bin/python3"]
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
        InputError: roslaunch would not take the file; the message is its own.
        MissingToolError: roslaunch is not installed.
        RunError: it does not end.
    """
    if not launch.is_file():
        raise InputError("no such launch file", launch)
    given = [f"{name}:={value}" for name, value in sorted(args.items())]
    command = [roslaunch_python(env), str(_TRACER), str(launch.absolute()), *given]
    try:
        ran = subprocess.run(
            command,
            env={**env, "PYTHONDONTWRITEBYTECODE": "1"},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=patience_s,
            check=False,
        )
    except subprocess.TimeoutExpired as error:
        raise RunError(f"was not read within {patience_s:.0f} s", launch) from error
    if ran.returncode != 0:
        said = ran.stderr.decode("utf-8", "replace").strip().splitlines()
        if said and said[-1].startswith("ModuleNotFoundError"):
            raise MissingToolError(
                f"{command[0]} has no roslaunch; install it with: apt-get install python3-roslaunch"
            )
        why = said[-1] if said else "no reason"
        # roslaunch names each include of an endless chain.
        why = why if len(why) <= _LONGEST else f"{why[: _LONGEST // 2]} ... {why[-_LONGEST // 2 :]}"
        raise InputError(f"roslaunch cannot read it: {why}", launch)
    answer = json.loads(ran.stdout)
    nodes = [LaunchNode.of(node) for node in answer["nodes"]]
    return Trace(launch.absolute(), dict(args), answer["parameters"], nodes, answer["files"])


def name_on_server(name: str, on_server: Collection[str]) -> str:
    """The name with which a parameter of the launch file stands on the server.

    They differ where ``$(anon x)`` is in it, for which roslaunch puts a random name.
    """
    if _ANONYMOUS not in name:
        return name
    pattern = "_[^/]+".join(re.escape(part) for part in name.split(_ANONYMOUS))
    matching = [known for known in on_server if re.fullmatch(pattern, known)]
    return matching[0] if len(matching) == 1 else name
