"""Which graph a command is about: that of a recording that runs, or that of ROS_MASTER_URI."""

from __future__ import annotations

import os
import socket
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeVar
from urllib.parse import urlsplit

import click

from pytpc.base.errors import RunError
from pytpc.base.wording import listed, many, plain
from pytpc.cli.arguments import PATH
from pytpc.cli.lines import say
from pytpc.ros import which
from pytpc.ros.ros1.master import Master, uri_of
from pytpc.ros.ros2.address import DOMAIN, VARIABLES, Ros2Address, is_ros2
from pytpc.ros.running import RunningRecording, running_recordings

_Command = TypeVar("_Command", bound=Callable[..., Any])


def _name_ros(_context: click.Context, _parameter: click.Parameter, given: str | None) -> None:
    if given is not None:
        os.environ[which.VARIABLE] = given


ROS = click.option(
    "--ros",
    type=click.Choice(["1", "2"]),
    expose_value=False,
    callback=_name_ros,
    help="Use a graph of this ROS. [default: TPC_ROS, or the one that runs]",
)
_RECORDING = click.option(
    "--recording",
    "running_folder",
    type=PATH,
    metavar="FOLDER",
    help="Use the graph of this running recording. [default: the only one, unless ROS_MASTER_URI is"
    " set and answers, or ROS_DOMAIN_ID is set]",
)


def RUNNING(command: _Command) -> _Command:
    """Options that choose a graph."""
    return _RECORDING(ROS(command))


_VARIABLE = "ROS_MASTER_URI"
_LISTED = 5
_CALLER = "/tpc_look"


class UsedGraph(NamedTuple):
    """The graph that this process uses from now on, and the recording that runs on it, if any."""

    master: str
    recording: RunningRecording | None

    @property
    def static(self) -> Path | None:
        """The static information of the workspace that is recorded."""
        return Path(self.recording.static) if self.recording and self.recording.static else None


def use_graph(folder: Path | None = None) -> UsedGraph:
    """Choose the graph, and set this process's ROS variables to it.

    The user's ROS_MASTER_URI holds if a master answers there: many shells set it where no roscore
    runs. Otherwise, the recording that runs on this machine is used, and named on standard error.

    Args:
        folder: the folder of a running recording, as the user names it.

    Raises:
        RunError: no such recording runs, or several do and none is named.
    """
    running = running_recordings()
    if folder is not None:
        return _used(_named(running, folder))
    asked = which.asked_ros(os.environ)
    running = [one for one in running if asked in (None, 2 if is_ros2(one.master) else 1)]
    given = os.environ.get(_VARIABLE, "")
    is_asked = asked == 1 or running or which.sign_of_ros2(os.environ)
    if asked != 2 and given and is_asked and _answers(given):
        return _given_master(running, given)
    domain = _given_domain(running, asked)
    if domain is not None:
        return domain
    if not running:
        return UsedGraph(uri_of(os.environ), None)
    if len({one.master for one in running}) > 1:
        found = listed([one.words for one in running], _LISTED)
        count = many(len(running), "recording")
        raise RunError(f"{count} run here; choose one with --recording FOLDER: {found}")
    gone = f"nothing answers at {_VARIABLE} ({given}); " if given else ""
    tell(f"{gone}using the recording that runs: {running[-1].words}")
    return _used(running[-1])


def ros2_here() -> UsedGraph | None:
    """The graph of ROS 2 that this shell names; None where the shell speaks for ROS 1.

    A ROS 1 master that answers is taken first, unless the user names ROS 2.

    Raises:
        InputError: TPC_ROS is neither 1 nor 2.
    """
    return _given_domain([], which.asked_ros(os.environ))


def _given_master(running: Sequence[RunningRecording], given: str) -> UsedGraph:
    """The graph of a ROS 1 master that answers."""
    there = [one for one in running if not is_ros2(one.master) and _is_same(one.master, given)]
    others = [one for one in running if one not in there]
    if not there and others:
        tell(
            f"using the master at {_VARIABLE} ({given}); to use a recording that runs:"
            f" --recording {others[-1].folder}"
        )
    elif sign := which.sign_of_ros2(os.environ):
        tell(f"using ROS 1, whose master answers at {given}; {sign} is for ROS 2: --ros 2")
    return UsedGraph(given, there[-1] if there else None)


def _given_domain(running: Sequence[RunningRecording], asked: int | None) -> UsedGraph | None:
    """The graph of ROS 2 that this shell names, if it is to be used."""
    sign = which.sign_of_ros2(os.environ)
    if asked == 1 or (asked is None and not sign):
        return None
    of_ros2 = [one for one in running if is_ros2(one.master)]
    if not os.environ.get(DOMAIN) and running:
        # The recording knows its domain.
        return None
    if asked is None and _answers(uri_of(os.environ)):
        if not running:
            return _given_master(running, uri_of(os.environ))
        return None
    address = Ros2Address.of_env(os.environ)
    there = [one for one in of_ros2 if Ros2Address.parse(one.master).domain == address.domain]
    if there:
        return _used(there[-1])
    if running:
        tell(
            f"using {address.words}; to use a recording that runs: --recording {running[-1].folder}"
        )
    return UsedGraph(str(address), None)


def tell(text: str) -> None:
    """Tell a line on standard error."""
    say(f"pytpc: {plain(text)}")


def _used(recording: RunningRecording) -> UsedGraph:
    if is_ros2(recording.master):
        settings = Ros2Address.parse(recording.master).env(os.environ)
        for name in (*VARIABLES, DOMAIN):
            os.environ.pop(name, None)
        os.environ.update(settings)
        return UsedGraph(recording.master, recording)
    os.environ[_VARIABLE] = recording.master
    os.environ["ROS_IP"] = recording.host
    os.environ.pop("ROS_HOSTNAME", None)
    return UsedGraph(recording.master, recording)


def _named(running: Sequence[RunningRecording], folder: Path) -> RunningRecording:
    wanted = folder.resolve()
    for one in running:
        if Path(one.folder).resolve() == wanted:
            return one
    there = listed([one.words for one in running], _LISTED)
    raise RunError(
        f"no recording runs in this folder; {f'there is {there}' if there else 'none runs here'}",
        folder,
    )


def _answers(uri: str) -> bool:
    try:
        Master(uri, _CALLER).call("getPid")
    except RunError:
        return False
    return True


def _is_same(one: str, other: str) -> bool:
    """Whether two URIs are of the same master."""
    first, second = urlsplit(one), urlsplit(other)
    here = {"localhost", "127.0.0.1", "127.0.1.1", socket.gethostname()}
    hosts = {first.hostname, second.hostname}
    return first.port == second.port and (len(hosts) == 1 or hosts <= here)
