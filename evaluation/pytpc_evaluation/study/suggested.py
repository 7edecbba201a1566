"""Suggestions, tried for real: a treated mission again, with one parameter set to a value.

Everything else is as it was: the treatment, its decoys, the seed, the people.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import pyarrow as pa

from pytpc.base.atomic import write_atomic
from pytpc.base.checked_json import parse_json
from pytpc.base.columns import write_table
from pytpc.base.errors import InputError
from pytpc_evaluation.study.dataset import CAUSES_FILE, Cause, load_causes, load_done
from pytpc_evaluation.study.listed import read_list
from pytpc_evaluation.study.plan import Flight, Setting

WANTED_FILE = Path("results") / "suggestions-wanted.json"
TRIED_FILE = Path("results") / "suggestions-flown.parquet"
FAILED_FILE = Path("results") / "suggestions-failed.json"
SUGGESTION_FILE = "suggestion.json"
MOST_FAILURES = 2
"""So often ``pytpc study suggested`` flies a value whose flight fails (each time twice)."""
_TRIED = pa.schema(
    [
        ("system", pa.string()),
        ("treatment", pa.string()),
        ("type", pa.string()),
        ("half", pa.string()),
        ("seed", pa.int64()),
        ("parameter", pa.string()),
        ("node", pa.string()),
        ("value", pa.float64()),
        ("gone", pa.bool_()),
        ("new", pa.bool_()),
        ("reached", pa.bool_()),
        ("failure", pa.string()),
    ]
)


@dataclass(frozen=True)
class WantedFlight:
    """A suggestion that is to be tried in one mission; the last of ``settings`` is new."""

    system: str
    treatment: str
    seed: int
    settings: tuple[Setting, ...]

    @property
    def mission(self) -> tuple[str, str, int]:
        """Which mission it is."""
        return (self.system, self.treatment, self.seed)


@dataclass(frozen=True)
class Tried:
    """What came of a suggestion.

    ``gone``: no error of the kind and for the reason of the first one of the treated mission was
    seen; None where in that mission none was. ``new``: an error was seen that was not there before.
    ``errors`` are the reasons of all that was seen.
    """

    gone: bool | None
    new: bool
    errors: tuple[str, ...]


@dataclass(frozen=True)
class Failed:
    """A value whose flight failed, how often, and why at last; ``digest`` is the mission's."""

    mission: str
    digest: str
    parameter: str
    node: str
    value: float
    times: int
    failure: str


def load_wanted(path: Path) -> list[WantedFlight]:
    """The list of what is to be tried; ``node`` may be null where one node has the parameter.

    Raises:
        InputError: the file is not such a list, or has a flight twice.
    """
    document = parse_json(path)
    try:
        if not isinstance(document, list):
            raise ValueError("a list is expected")
        wanted = [_wanted(one) for one in document]
    except (KeyError, TypeError, ValueError) as error:
        what = f"{error} is missing" if isinstance(error, KeyError) else str(error)
        raise InputError(f"not a list of suggestions: {what}", path) from error
    for place, one in enumerate(wanted):
        if one in wanted[:place]:
            raise InputError(f"{'/'.join(map(str, one.mission))} is listed twice", path)
    return wanted


def _wanted(one: object) -> WantedFlight:
    if not isinstance(one, dict):
        raise ValueError(f"{one!r} is no object")
    system, treatment, seed = (one[name] for name in ("system", "treatment", "seed"))
    if not isinstance(seed, int):
        raise ValueError(f"seed {seed!r} is not a number")
    settings = tuple(_setting(each) for each in (*one.get("kept", ()), one))
    if not isinstance(system, str) or not isinstance(treatment, str):
        raise ValueError(f"{(system, treatment)} are not texts")
    return WantedFlight(system, treatment, seed, settings)


def _setting(one: Mapping[str, Any]) -> Setting:
    parameter, node, value = (one[name] for name in ("parameter", "node", "value"))
    if not isinstance(parameter, str) or not isinstance(node or "", str):
        raise ValueError(f"{(parameter, node)} are not texts")
    if not isinstance(value, int | float) or isinstance(value, bool):
        raise ValueError(f"value {value!r} is not a number")
    return Setting(parameter, node or "", float(value))


def suggested_flight(wanted: WantedFlight, missions: Sequence[Flight], out: Path) -> Flight:
    """The flight that tries a suggestion.

    Args:
        wanted: what is to be tried.
        missions: of its system.
        out: the study's folder.

    Raises:
        InputError: there is no such mission, or it has not been flown.
    """
    system, treatment, seed = wanted.mission
    for mission in missions:
        if mission.kind != "mission" or (mission.treatment.name, mission.seed) != (treatment, seed):
            continue
        if load_done(mission.folder(out)) is None:
            raise InputError("has not been flown: pytpc study run", mission.folder(out))
        return replace(mission, kind="suggested", suggested=wanted.settings)
    raise InputError(f"there is no mission {system}/{treatment}/seed-{seed}")


def not_to_be_set(flights: Iterable[Flight]) -> dict[str, str]:
    """The flights, by their labels, whose parameter is not in the robot's own file, and why.

    A program may read one that nobody set: the ranking names it, and the study cannot set it.
    """
    found = {}
    for flight in flights:
        try:
            flight.settings()
        except InputError as error:
            found[flight.label] = str(error)
    return found


def judged(before: Sequence[Cause], after: Sequence[Cause]) -> Tried:
    """What the causes of a treated mission, and of the same with a suggestion, say of it."""

    def sort(cause: Cause) -> tuple[str, str]:
        return (cause.kind, cause.reason)

    known = {sort(cause) for cause in before}
    found = [sort(cause) for cause in after]
    first = min(before, key=lambda cause: cause.start, default=None)
    return Tried(
        gone=None if first is None else sort(first) not in found,
        new=any(one not in known for one in found),
        errors=tuple(f"{kind}: {reason}" for kind, reason in found),
    )


def try_of(flight: Flight, out: Path) -> Tried:
    """Judge a flight that tried a suggestion, and write it into its folder.

    Raises:
        InputError: the causes of one of the two missions cannot be read.
        TpcError: the file cannot be written.
    """
    treated = replace(flight, kind="mission", suggested=())
    done = load_done(treated.folder(out))
    before = load_causes(treated.folder(out) / CAUSES_FILE)
    tried = judged(before, load_causes(flight.folder(out) / CAUSES_FILE))
    setting = asdict(flight.suggested[-1])
    mission = "" if done is None else done.digest
    text = json.dumps({"schema": 1, "mission": mission, **setting, **asdict(tried)}, indent=1)
    write_atomic(flight.folder(out) / SUGGESTION_FILE, text.encode() + b"\n")
    return tried


def save_tried(
    flights: Iterable[Flight], failures: Mapping[str, str], out: Path
) -> list[dict[str, object]]:
    """Write ``TRIED_FILE``: a row for each of these flights, and of no earlier ones.

    What failed is counted in ``FAILED_FILE``, over all calls.

    Args:
        flights: what was flown.
        failures: why a flight failed, by its label.
        out: the study's folder.

    Returns:
        The rows.

    Raises:
        TpcError: a file cannot be read or written.
    """
    rows = [_row(flight, failures.get(flight.label, ""), out) for flight in flights]
    write_table(pa.Table.from_pylist(rows, schema=_TRIED), out / TRIED_FILE)
    _save_failed(rows, out)
    return rows


def load_failed(out: Path) -> list[Failed]:
    """The values whose flights failed; none where there is no such file.

    Raises:
        InputError: it cannot be read.
    """
    return read_list(out / FAILED_FILE, lambda one: Failed(**one), "not a list of failed flights")


def _save_failed(rows: Sequence[Mapping[str, Any]], out: Path) -> None:
    """Count the failures of these rows, and forget those of what was flown after all."""
    found = {_place(asdict(one)): one for one in load_failed(out)}
    for row in rows:
        mission = f"{row['system']}/{row['treatment']}/seed-{row['seed']}"
        done = load_done(out / "missions" / mission)
        one = {**row, "mission": mission, "digest": "" if done is None else done.digest}
        earlier = found.pop(_place(one), None)
        if row["failure"]:
            times = 1 if earlier is None else earlier.times + 1
            fields = ("mission", "digest", "parameter", "node", "value", "failure")
            found[_place(one)] = Failed(**{name: one[name] for name in fields}, times=times)
    text = json.dumps([asdict(found[place]) for place in sorted(found)], indent=1)
    write_atomic(out / FAILED_FILE, text.encode() + b"\n")


def _place(one: Mapping[str, Any]) -> tuple[Any, ...]:
    return tuple(one[name] for name in ("mission", "digest", "parameter", "node", "value"))


def _row(flight: Flight, failure: str, out: Path) -> dict[str, object]:
    done = None if failure else load_done(flight.folder(out))
    tried = None if done is None else try_of(flight, out)
    return {
        "system": flight.example.name,
        "treatment": flight.treatment.name,
        "type": flight.treatment.type,
        "half": flight.half,
        "seed": flight.seed,
        **asdict(flight.suggested[-1]),
        "gone": None if tried is None else tried.gone,
        "new": None if tried is None else tried.new,
        "reached": None if done is None else done.reached,
        "failure": failure,
    }
