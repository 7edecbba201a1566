"""Which suggestions are to be flown, and what came of them: by rounds, one flight a mission.

``next_round`` takes in what ``pytpc study suggested`` has flown, works out what each chain of tries
asks for next, and writes

- ``results/suggestions-wanted.json``: the next flights, at most one for each mission;
- ``results/suggestion-tries.parquet``: every try of every variant;
- ``results/suggestions.parquet``: the first tries of ``HEADLINE``, one for each mission, flown or
  to be flown;
- ``results/suggestion-chains.json``: how far each chain is.

A chain is one mission and one variant. ``smallest`` is SPEC 8's value; ``lasting`` has what the log
alone says, again from the log of each flight that did not help; ``with-default`` may take the
source's default, too (in these robots it is the value before the treatment, so that this flatters),
and ``with-reference`` a clean run's. They are told the changed parameter. ``suspects`` is not: it
tries the first of a ranking in turn, each with what the log alone says. Every value is from the
marks as they are typed rightly, of all users. Two chains that want one value share the flight.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import pyarrow as pa

from pytpc.advice.remedy import Remedy, remedy
from pytpc.atomic import write_atomic
from pytpc.columns import write_table
from pytpc.errors import InputError
from pytpc.ingest.recording import Recording, load_recording
from pytpc.parameters import DYNAMIC, same_parameter
from pytpc.static_info import StaticInfo
from pytpc.static_json import parse_json
from pytpc.study.case import Method
from pytpc.study.data import load_mission
from pytpc.study.dataset import DONE_FILE, STUDY_FILE, load_done
from pytpc.study.plan import Half
from pytpc.study.suggested import SUGGESTION_FILE, WANTED_FILE
from pytpc.study.suggestion_chains import (
    CHAINS_FILE,
    HEADLINE,
    MOST_TRIES,
    SUSPECTS,
    VARIANTS,
    Chain,
    Try,
    load_chains,
)

TRIES_FILE = Path("results") / "suggestion-tries.parquet"
HEADLINE_FILE = Path("results") / "suggestions.parquet"

_TRIES = pa.schema(
    [
        ("system", pa.string()),
        ("treatment", pa.string()),
        ("type", pa.string()),
        ("half", pa.string()),
        ("seed", pa.int64()),
        ("variant", pa.string()),
        ("tries", pa.int64()),
        ("parameter", pa.string()),
        ("node", pa.string()),
        ("value", pa.float64()),
        ("old", pa.float64()),
        ("basis", pa.string()),
        ("gone", pa.bool_()),
        ("new_error", pa.bool_()),
        ("reason", pa.string()),
    ]
)


def next_round(
    out: Path,
    halves: Sequence[Half] = ("tuning",),
    method: Method | None = None,
    variants: Sequence[str] = tuple(VARIANTS),
    on_progress: Callable[[int, int], None] | None = None,
) -> list[Chain]:
    """Take in what was flown, and write what is to be flown next.

    Args:
        out: the study's folder.
        halves: the halves whose missions are asked about; chains of others stay as they are.
        method: for the chains ``suspects``, of which there are none without it.
        variants: for which there are new chains.
        on_progress: called with (chains done, chains in all).

    Returns:
        All chains, in the order of the missions and variants.

    Raises:
        InputError: a file of the study is missing or broken.
        TpcError: a file cannot be written.
    """
    chains = _chains(out, halves, method, variants)
    for number, chain in enumerate(chains, start=1):
        _take_in(chain, out)
        while not chain.is_over and not (chain.tries and chain.tries[-1].is_open):
            chain.tries.append(_next(chain, out))
        if on_progress is not None:
            on_progress(number, len(chains))
    _save(chains, out)
    return chains


def _chains(
    out: Path, halves: Sequence[Half], method: Method | None, variants: Sequence[str]
) -> list[Chain]:
    """Those of before, and new ones of ``variants`` for what was flown or marked since."""
    known = {(one.mission, one.variant): one for one in load_chains(out / CHAINS_FILE)}
    for row in _missions(out):
        if row["half"] not in halves:
            continue
        done = load_done(out / "missions" / _name(row))
        digest = "" if done is None else done.digest
        known = {
            place: one
            for place, one in known.items()
            if one.digest == digest or one.mission != _name(row)
        }
        for variant in variants:
            chain = Chain(
                row["system"], row["treatment"], row["type"], row["half"],
                int(row["seed"]), variant, float(row["old"]), float(row["new"]), digest=digest,
            )  # fmt: skip
            place = (chain.mission, variant)
            if place in known or (variant == SUSPECTS and method is None):
                continue
            if method is not None and variant == SUSPECTS:
                mission = load_mission(out, out / "missions" / chain.mission, row["half"])
                chain.order = method(mission.case("typed")).order[: MOST_TRIES[SUSPECTS]]
            known[place] = chain
    order = list(VARIANTS)
    return sorted(known.values(), key=lambda one: (one.mission, order.index(one.variant)))


def _missions(out: Path) -> Iterator[Mapping[str, Any]]:
    """The treated missions in study.json that were flown."""
    document = parse_json(out / STUDY_FILE)
    try:
        rows = document["missions"] if isinstance(document, dict) else None
        if not isinstance(rows, list):
            raise TypeError("it does not say which missions there are")
        for row in rows:
            flown = out / "missions" / _name(row) / DONE_FILE
            if row["type"] in {"type1", "type2"} and flown.is_file():
                yield row
    except (KeyError, TypeError) as error:
        raise InputError(f"not about a study: {error}", out / STUDY_FILE) from error


def _name(row: Mapping[str, Any]) -> str:
    """As `Chain.mission`."""
    return f"{row['system']}/{row['treatment']}/seed-{row['seed']}"


def _take_in(chain: Chain, out: Path) -> None:
    """What came of the last try, where its flight stands in the folder."""
    if not chain.tries or not chain.tries[-1].is_open:
        return
    last = chain.tries[-1]
    folder = out / "suggested" / chain.mission
    if not (folder / DONE_FILE).is_file() or not (folder / SUGGESTION_FILE).is_file():
        return
    path = folder / SUGGESTION_FILE
    flown = parse_json(path)
    try:
        if not isinstance(flown, dict):
            raise TypeError("an object is expected")
        if (flown["parameter"], flown["value"]) != (last.parameter, last.value):
            return
        if flown.get("mission", chain.digest) != chain.digest:
            return
        chain.tries[-1] = Try(
            last.parameter, last.node, last.value, last.basis,
            flown["gone"], bool(flown["new"]), "; ".join(flown["errors"]),
        )  # fmt: skip
    except (KeyError, TypeError) as error:
        raise InputError(f"not what came of a suggestion: {error}", path) from error


def _next(chain: Chain, out: Path) -> Try:
    """The next value of a chain that is not over and has none that is to be flown."""
    mission = out / "missions" / chain.mission
    treatment = parse_json(mission / "treatment.json")
    if not isinstance(treatment, dict) or not isinstance(treatment.get("parameter"), str):
        raise InputError("not a treatment with a parameter", mission / "treatment.json")
    parameter, node = treatment["parameter"], treatment.get("node")
    folder, flown = mission, []
    if chain.variant == SUSPECTS:
        if len(chain.tries) >= len(chain.order):
            return Try("", None, None, None, reason="no more suspects")
        parameter, node = chain.order[len(chain.tries)], None
    elif chain.tries:
        # Its flight is that of this chain: the one that _take_in has just read.
        folder = out / "suggested" / chain.mission
        flown = [chain.new, *(one.value for one in chain.tries[:-1] if one.value is not None)]
    if DYNAMIC in parameter:
        return Try(parameter, node, None, None, reason="only the running node knows its name")
    recording = load_recording(folder)
    if not recording.marks:
        return Try(parameter, node, None, None, reason="nobody set a mark")
    found = _asked(chain, out, recording, parameter, flown)
    if node is None or not same_parameter(parameter, treatment["parameter"]):
        node = _node(recording, found.key)
    value, basis = found.value, found.basis
    if VARIANTS[chain.variant] is None:
        value, basis = None if found.smallest is None else found.smallest.value, "smallest"
    if value is None:
        return Try(parameter, node, None, None, reason=found.reason or "nothing is suggested")
    return Try(parameter, node, float(value), basis)


def _asked(
    chain: Chain, out: Path, recording: Recording, parameter: str, flown: Sequence[float]
) -> Remedy:
    static = StaticInfo.load(out / "systems" / chain.system / "static.json")
    sources = VARIANTS[chain.variant] or frozenset()
    reference = load_recording(out / "reference" / chain.system) if "reference" in sources else None
    return remedy(
        recording,
        static,
        parameter,
        recording.marks,
        sources=sources,
        reference=reference,
        flown=flown,
    )


def _node(recording: Recording, key: str | None) -> str | None:
    """The node that evaluated a comparison; None where several did, or none."""
    events = recording.events
    if key is None or key not in events.keys:
        return None
    codes = set(events.node[events.by_key.rows(events.keys.index(key))].tolist())
    return events.nodes[codes.pop()] if len(codes) == 1 else None


def _save(chains: Sequence[Chain], out: Path) -> None:
    rows = [
        row for chain in chains for row in _rows(chain, [t for t in chain.tries if not t.is_open])
    ]
    write_table(pa.Table.from_pylist(rows, schema=_TRIES), out / TRIES_FILE)
    first = [
        {**row, "new": row["new_error"], "failure": ""}
        for chain in chains
        for row in _rows(chain, chain.tries[:1])
        if chain.variant == HEADLINE and row["value"] is not None
    ]
    schema = _TRIES.append(pa.field("new", pa.bool_())).append(pa.field("failure", pa.string()))
    write_table(pa.Table.from_pylist(first, schema=schema), out / HEADLINE_FILE)
    _write_json([asdict(chain) for chain in chains], out / CHAINS_FILE)
    # Last: with it the next flights can begin.
    _write_json(list(_wanted(chains)), out / WANTED_FILE)


def _rows(chain: Chain, tries: Sequence[Try]) -> Iterator[dict[str, object]]:
    head = asdict(chain)
    del head["tries"], head["new"], head["order"], head["digest"]
    for number, one in enumerate(tries, start=1):
        # Where nothing is suggested the error stays.
        gone = False if one.value is None else one.gone
        yield {**head, **asdict(one), "gone": gone, "tries": number}


def _wanted(chains: Sequence[Chain]) -> Iterator[dict[str, object]]:
    """The first open try of each mission."""
    seen: set[str] = set()
    for chain in chains:
        if not chain.tries or not chain.tries[-1].is_open or chain.mission in seen:
            continue
        seen.add(chain.mission)
        last = chain.tries[-1]
        yield {
            "system": chain.system,
            "treatment": chain.treatment,
            "seed": chain.seed,
            "parameter": last.parameter,
            "node": last.node,
            "value": last.value,
        }


def _write_json(document: object, path: Path) -> None:
    write_atomic(path, json.dumps(document, indent=1).encode() + b"\n")
