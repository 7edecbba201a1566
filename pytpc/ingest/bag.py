"""ROS 1 bags: the reports, the marks, and what is wrong with the recording."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from pytpc.base.errors import InputError
from pytpc.ingest.bag_chunks import BrokenBagError, find_damage, messages, read_index
from pytpc.ingest.decoders import ROS1
from pytpc.ingest.gathering import Gathering, Progress
from pytpc.ingest.messages import REPORTS, ROSOUT, ROSOUT_AGG, Messages, wanted
from pytpc.ingest.unpacking import LARGEST_MESSAGE

_LOG = {"rosgraph_msgs/msg/Log"}
_TYPES = {ROSOUT: _LOG, ROSOUT_AGG: _LOG, REPORTS: {"std_msgs/msg/String"}}
_TIMES = {"std_msgs/msg/Time"}


def read_bag_into(path: Path, gathering: Gathering, on_progress: Progress | None = None) -> None:
    """Read a ROS 1 bag.

    Reports come from /rosout, /rosout_agg and /threshold_information, marks from the topics of
    docs/reference/formats.md#marks. A message without a stamp gets the time at which it was
    recorded. ``on_progress`` is called with (bytes read, bytes in all).

    Raises:
        InputError: the file is no bag, is truncated, has no index or is damaged; one line with the
            byte, where the file itself tells it.
    """
    try:
        with path.open("rb") as stream:
            index = read_index(stream)
            found, notes = wanted(index.connections.values(), _TYPES, _TIMES)
            kept = {connection.number: connection for connection in found}
            gathering.notes += notes
            if index.span is not None:
                gathering.spans.append(index.span)
            logs = [n for n, connection in kept.items() if connection.topic == ROSOUT]
            latched = {kept[n].caller.encode() for n in logs if kept[n].latched}
            taken = Messages(gathering, str(path), ROS1, latched=latched)
            total = index.index_pos
            senders = {n: kept[n].caller.encode() for n in logs}
            for chunk in messages(stream, index, kept.keys()) if kept else ():
                is_log = np.isin(chunk.connection, logs)
                others = np.flatnonzero(~is_log)
                if not taken.take_logs(chunk, is_log, senders):
                    others = np.arange(chunk.connection.size)
                for row in others.tolist():
                    connection = kept[int(chunk.connection[row])]
                    end = min(chunk.end[row], chunk.begin[row] + LARGEST_MESSAGE + 1)
                    raw = chunk.data[chunk.begin[row] : end]
                    time_ns = int(chunk.time_ns[row])
                    taken.take(connection.topic, connection.caller, time_ns, raw)
                if on_progress is not None:
                    on_progress(min(chunk.behind, total), total)
            taken.close()
            if on_progress is not None:
                on_progress(total, total)
    except BrokenBagError as error:
        raise _broken(path, error) from error
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}", path) from error


def _broken(path: Path, error: BrokenBagError) -> InputError:
    """The error for a bag that could not be read, with the byte at which it is broken."""
    try:
        with path.open("rb") as stream:
            damage = find_damage(stream, path.stat().st_size)
    except OSError as failure:
        return InputError(f"cannot be read: {failure.strerror or failure}", path)
    if damage is None:
        return InputError(f"damaged: {error}", path)
    hint = "" if damage.startswith("not a") else f'; "rosbag reindex {path.name}" recovers the rest'
    return InputError(damage + hint, path)
