"""Which suggestions to fly, and their results: in rounds, one flight for each mission.

``next_round`` takes in what ``pytpc study suggested`` has flown, works out what each chain of tries
asks for next, and writes

- ``results/suggestions-wanted.json``: the next flights;
- ``results/suggestion-tries.parquet``: every try of every variant;
- ``results/suggestions.parquet``: the first tries of ``HEADLINE``, one for each mission, flown or
  to be flown;
- ``results/suggestion-chains.json``: how far each chain is.

A chain is one mission and one variant. ``smallest`` is the thesis's value. ``lasting`` has what the
log alone says, and tries again from the log of each flight that did not help. ``with-default`` may
also take the default in the source (in these robots it is the value before the treatment, which
flatters), and ``with-reference`` a good run's value. These are told the changed parameter and the
right types of the marks, of all users. ``suspects`` is told the types: it tries the first of a
ranking in turn, each with what the log alone says. ``ranked`` is told nothing: it takes the first
of the ranking beside a good run, by the marks as they were said, with what the log alone says;
``ranked-reference`` is the same with the good run's value. ``fix`` and ``fix-2-runs`` are
conversations of ``pytpc fix`` (`pytpc_evaluation.study.fix_chains`). What was flown for one chain
counts for all that want the same.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import pyarrow as pa

from pytpc.base.atomic import write_atomic
from pytpc.base.checked_json import parse_json
from pytpc.base.columns import write_table
from pytpc.base.errors import InputError
from pytpc_evaluation.study.case import Method
from pytpc_evaluation.study.data import load_mission
from pytpc_evaluation.study.dataset import DONE_FILE, STUDY_FILE, load_done
from pytpc_evaluation.study.fix_chains import with_verdict
from pytpc_evaluation.study.plan import SEEDS, Half, Setting
from pytpc_evaluation.study.suggested import (
    MOST_FAILURES,
    SUGGESTION_FILE,
    WANTED_FILE,
    Failed,
    load_failed,
)
from pytpc_evaluation.study.suggestion_chains import (
    CHAINS_FILE,
    HEADLINE,
    MOST_TRIES,
    SUSPECTS,
    VARIANTS,
    Chain,
    Try,
    load_chains,
)
from pytpc_evaluation.study.suggestion_values import next_try

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
        ("failed", pa.bool_()),
        ("observer", pa.string()),
        ("verdict", pa.string()),
    ]
)


@dataclass(frozen=True, slots=True)
class Asked:
    """Which suggestions are asked for.

    ``halves`` and ``seeds`` are those whose missions are asked about; chains of others stay as they
    are.
    ``method`` is for the chains ``suspects``, of which there are none without it. There are new
    chains for ``variants``. ``again``: their chains in ``halves`` begin anew, because the ranking
    or the advice has changed. What was flown for them is not forgotten.
    """

    halves: Sequence[Half] = ("tuning",)
    method: Method | None = None
    variants: Sequence[str] = tuple(VARIANTS)
    seeds: Collection[int] = SEEDS
    again: bool = False

    def renews(self, chain: Chain) -> bool:
        """Whether a chain begins anew."""
        return self.again and chain.variant in self.variants and self.has(chain.half, chain.seed)

    def has(self, half: Half, seed: int) -> bool:
        """Whether it is about a mission."""
        return half in self.halves and seed in self.seeds


def next_round(
    out: Path,
    asked: Asked | None = None,
    on_progress: Callable[[int, int], None] | None = None,
) -> list[Chain]:
    """Take in what was flown, and write what is to be flown next.

    Args:
        out: the study's folder.
        asked: what is asked for; by default all variants of the tuning half.
        on_progress: called with (chains done, chains in all).

    Returns:
        All chains, in the order of the missions and variants.

    Raises:
        InputError: a file of the study is missing or broken.
        TpcError: a file cannot be written.
    """
    wanted = asked or Asked()
    failed = load_failed(out)
    before = [one for one in load_chains(out / CHAINS_FILE) if not wanted.renews(one)]
    chains = _chains(before, out, wanted)
    for number, chain in enumerate(chains, start=1):
        while not chain.is_over:
            if not (chain.tries and chain.tries[-1].is_open):
                chain.tries.append(next_try(chain, out))
            elif not _take_in(chain, out, failed):
                break
        if on_progress is not None:
            on_progress(number, len(chains))
    _save(chains, out)
    return chains


def _chains(before: Sequence[Chain], out: Path, asked: Asked) -> list[Chain]:
    """Those of before, and new ones for what was flown or marked since."""
    known = {(one.mission, one.variant): one for one in before}
    for row in _missions(out):
        if not asked.has(row["half"], int(row["seed"])):
            continue
        done = load_done(out / "missions" / _name(row))
        digest = "" if done is None else done.digest
        known = {
            place: one
            for place, one in known.items()
            if one.digest == digest or one.mission != _name(row)
        }
        for variant in asked.variants:
            chain = Chain(
                row["system"], row["treatment"], row["type"], row["half"],
                int(row["seed"]), variant, float(row["old"]), float(row["new"]), digest=digest,
            )  # fmt: skip
            place = (chain.mission, variant)
            if place in known or (variant == SUSPECTS and asked.method is None):
                continue
            if asked.method is not None and variant == SUSPECTS:
                mission = load_mission(out, out / "missions" / chain.mission, row["half"])
                order = asked.method(mission.case("typed")).order
                chain.order = order[: MOST_TRIES[SUSPECTS]]
            known[place] = chain
    place_of = list(VARIANTS).index
    return sorted(known.values(), key=lambda one: (one.mission, place_of(one.variant)))


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
        raise InputError(f"not a study's file: {error}", out / STUDY_FILE) from error


def _name(row: Mapping[str, Any]) -> str:
    """As `Chain.mission`."""
    return f"{row['system']}/{row['treatment']}/seed-{row['seed']}"


def _take_in(chain: Chain, out: Path, failed: Sequence[Failed]) -> bool:
    """Take in what came of the open try of a chain; whether it was flown, or failed too often."""
    last = chain.tries[-1]
    flown = _flown(out / chain.flown(), chain.digest)
    if flown is not None:
        gone, new, errors = flown["gone"], bool(flown["new"]), "; ".join(flown["errors"])
        chain.tries[-1] = replace(last, gone=gone, new_error=new, reason=errors)
        if last.fix is not None:
            chain.tries[-1] = with_verdict(chain, out)
        return True
    for one in failed:
        same = Setting(one.parameter, one.node, one.value) == last.setting
        if same and (one.mission, one.digest) == (chain.mission, chain.digest):
            if one.times < MOST_FAILURES:
                return False
            reason = f"the flight failed {one.times} times: {one.failure}"
            chain.tries[-1] = replace(last, gone=False, reason=reason, failed=True)
            return True
    return False


def _flown(folder: Path, digest: str) -> dict[str, Any] | None:
    """The result of a flight; None where there is none of a mission with this digest.

    Raises:
        InputError: it cannot be read.
    """
    path = folder / SUGGESTION_FILE
    if not (folder / DONE_FILE).is_file() or not path.is_file():
        return None
    flown = parse_json(path)
    if not isinstance(flown, dict) or not {"gone", "new", "errors"} <= flown.keys():
        raise InputError("not the result of a suggestion", path)
    return flown if flown.get("mission", digest) == digest else None


def _save(chains: Sequence[Chain], out: Path) -> None:
    rows = [
        row for chain in chains for row in _rows(chain, [t for t in chain.tries if not t.is_open])
    ]
    write_table(pa.Table.from_pylist(rows, schema=_TRIES), out / TRIES_FILE)
    first = [
        {**row, "new": row["new_error"], "failure": row["reason"] if row["failed"] else ""}
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
        said = {**asdict(one), "verdict": one.verdict}
        del said["fix"]
        yield {**head, **said, "gone": gone, "tries": number}


def _wanted(chains: Sequence[Chain]) -> Iterator[dict[str, object]]:
    """The open tries, each flight once."""
    seen: set[str] = set()
    for chain in chains:
        if not chain.tries or not chain.tries[-1].is_open or chain.flown() in seen:
            continue
        seen.add(chain.flown())
        *kept, _ = (asdict(one) for one in chain.settings())
        last = chain.tries[-1]
        yield {
            "system": chain.system,
            "treatment": chain.treatment,
            "seed": chain.seed,
            "parameter": last.parameter,
            "node": last.node,
            "value": last.value,
            **({"kept": kept} if kept else {}),
        }


def _write_json(document: object, path: Path) -> None:
    write_atomic(path, json.dumps(document, indent=1).encode() + b"\n")
