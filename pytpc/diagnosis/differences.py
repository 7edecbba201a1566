"""Compares a mission's parameter values with those of good runs, and replays what they decided.

A value comes from the recorded parameter server, else from the reports of the comparisons, as a
default of the code does. A parameter differs if no good run had the mission's value. Its
comparisons are evaluated again with the value of the last good run that has one
(`pytpc.diagnosis.thresholds.replay`).
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from pytpc.base.columns import Int64s
from pytpc.base.wording import listed
from pytpc.diagnosis.misspelt import with_alike
from pytpc.diagnosis.question import WINDOW_S
from pytpc.diagnosis.ranking.known_good import thresholds_of
from pytpc.diagnosis.ranking.summarised import with_summarised
from pytpc.diagnosis.results.differences import (
    CodeComparison,
    Difference,
    ReplayedComparison,
    RunDifferences,
    SetValue,
)
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.diagnosis.suggestion.known_values import value_in
from pytpc.diagnosis.suggestion.what_if import count_turned, spans_before
from pytpc.diagnosis.thresholds.replay import Track, tracks_of
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_change import Change
from pytpc.recording.parameter_values import ParameterValues
from pytpc.static.builds import Build, program_name
from pytpc.static.coverage import STATES, Covered, coverage
from pytpc.static.link_unit import Comparison
from pytpc.static.parameters import (
    DYNAMIC,
    ByParameter,
    parameter_name,
    resolved,
)
from pytpc.static.static_info import StaticInfo

_NAMED = 5
DEFAULT = "default in the code"
"""The place of a value that is on no parameter server, and that comparisons reported."""


@dataclass(frozen=True)
class RunValues:
    """A run and the values of its parameters.

    ``values`` are those of the parameter server by full name, None if they were not recorded;
    those that changed while it ran are in the recording, too. ``places`` says where they were set,
    by full name. ``build`` is what its nodes were built from; None if that is not known.
    """

    name: str
    recording: Recording
    values: Mapping[str, object] | None = None
    places: Mapping[str, str] = field(default_factory=dict)
    build: Build | None = None

    def set_value(self, name: str) -> SetValue:
        """The value of a parameter by its full name."""
        return SetValue((self.values or {}).get(name), self.places.get(name, ""))

    @cached_property
    def _over_time(self) -> ParameterValues:
        return ParameterValues(self.recording.values)

    def had(self, name: str) -> list[SetValue]:
        """The values that a parameter had in the run, the last one last; None is left out."""
        first, *later = self._over_time.history(name) or [(0, None)]
        if not later:
            return [self.set_value(name)] if name in (self.values or {}) else []
        found = [SetValue(first[1], self.places.get(name, ""))]
        for time_ns, value in later:
            second = (time_ns - self.recording.start_ns) / 1e9
            found.append(SetValue(value, f"set while it ran, at {second:.1f} s"))
        return [one for one in found if one.value is not None]

    def evaluated_in(self, name: str, comparison: Comparison) -> frozenset[str]:
        """The nodes that evaluated a comparison with the parameter of this name."""
        nodes, source = self.recording.nodes_of.get(comparison.key, frozenset()), comparison.source
        if source is None or DYNAMIC in source or not name.startswith("/"):
            return nodes
        return frozenset(node for node in nodes if resolved(source, node) == name)


def differences(
    bad: RunValues, good: Sequence[RunValues], static_info: StaticInfo, window_s: float = WINDOW_S
) -> RunDifferences:
    """What differs between a mission and good runs.

    Args:
        bad: the mission.
        good: at least one good run, the last one last.
        static_info: with the names of the mission (`pytpc.diagnosis.full_names`); the reports of
            the good runs have the mission's keys.
        window_s: how long before a mark counts as near to it, in seconds.

    Raises:
        ValueError: there is no good run.
    """
    if not good:
        raise ValueError("there is no good run to compare with")
    known = _Known(static_info)
    is_complete = bad.values is not None and any(run.values is not None for run in good)
    found = _on_the_server(bad, good, known) if is_complete else []
    names = {one.parameter for one in found}
    found += _reported(bad, good, known, names)
    made = [_replayed(one, bad, known, window_s) for one in found]
    runs = (bad, *good)
    meant = _names_by_source(runs, known) if made else {}
    made = [replace(one, source=_source_of(one, runs, meant, known)) for one in made]
    made = with_alike(made, bad.values or {}, [one.parameter for one in known.covered])
    code = _code(bad, good, static_info)
    differs = (code.line,) if code is not None and not code.is_same else ()
    return RunDifferences(
        tuple(run.name for run in good),
        bad.name,
        tuple(sorted(made, key=Difference.order)),
        is_complete,
        (*differs, *_notes(bad, good, static_info)),
        code,
    )


def _code(
    bad: RunValues, good: Sequence[RunValues], static_info: StaticInfo
) -> CodeComparison | None:
    """The comparison with the last good run of the same code, or else with the last one."""
    here = _programs(bad, static_info)
    every = [_code_of(bad, run, here, _programs(run, static_info)) for run in reversed(good)]
    found = [one for one in every if one is not None]
    return max(found, key=lambda one: one.is_same, default=None)


def _code_of(
    bad: RunValues, good: RunValues, here: set[str], there: set[str]
) -> CodeComparison | None:
    """The comparison with one run, by the programs that reported; None if it is not known."""
    if bad.build is None or good.build is None:
        return None
    both = bad.build.keys() & good.build.keys()
    if not here & there <= both:
        return None
    changed = sorted(name for name in both if bad.build[name] != good.build[name])
    return CodeComparison(good.name, tuple(changed), tuple(sorted(here - there)))


def _programs(run: RunValues, static_info: StaticInfo) -> set[str]:
    """The programs that reported."""
    known = run.recording.nodes_of.keys() & static_info.comparisons.keys()
    return {program_name(static_info.unit_of(key)) for key in known}


def changes_of(found: RunDifferences) -> tuple[Change, ...]:
    """The differences as changes since the robot worked; a value that is no number is nan."""
    changes = []
    for one in found.found:
        old, new = one.good.number, one.bad.number
        old, new = (math.nan if value is None else value for value in (old, new))
        changes.append(Change(one.parameter, "", old, new))
    return tuple(changes)


@dataclass(frozen=True)
class _Known:
    """What the analysis knows of parameters."""

    static_info: StaticInfo

    @cached_property
    def _by_source(self) -> ByParameter[Comparison]:
        every = (one for one in self.static_info.thresholds.values() if one.source)
        return ByParameter(every, lambda one: one.source or "")

    @cached_property
    def _by_name(self) -> Mapping[str, list[Comparison]]:
        found = defaultdict(list)
        for one in self.static_info.thresholds.values():
            found[parameter_name(one)].append(one)
        return found

    @cached_property
    def covered(self) -> Sequence[Covered]:
        """What became of each parameter that is read."""
        return coverage(self.static_info)

    @cached_property
    def _covered(self) -> ByParameter[Covered]:
        return ByParameter(self.covered, lambda one: one.parameter)

    def comparisons_of(self, name: str) -> list[Comparison]:
        """The comparisons with a parameter: by its full name, or by its name in the source."""
        return self._by_source.meant(name) if name.startswith("/") else self._by_name.get(name, [])

    def covered_as(self, name: str) -> list[Covered]:
        """What became of the parameter in the nodes that may read it, the most telling first."""
        order = list(STATES)
        return sorted(self._covered.meant(name), key=lambda one: order.index(one.state))


def _on_the_server(bad: RunValues, good: Sequence[RunValues], known: _Known) -> list[Difference]:
    values, recorded = bad.values or {}, [run for run in good if run.values is not None]
    names = sorted({*values, *(name for run in good for name in run.values or ())})
    found = []
    for name in names:
        there = [run for run in recorded if name in (run.values or {})]
        before = [one.value for run in there for one in run.had(name)]
        new = [one for one in bad.had(name) if not any(_same(one.value, old) for old in before)]
        if name in values and before and not new:
            continue
        if name not in values and len(there) < len(recorded):
            continue
        now = new[-1] if new else _told(bad, name, known)
        then = [_told(run, name, known) for run in good]
        if isinstance(now.value, str):
            # What a comparison reports of a text is not the text.
            then = [one if isinstance(one.value, str) else SetValue(None) for one in then]
        if any(one.value is not None and _same(one.value, now.value) for one in then):
            continue
        last = next((one for one in reversed(then) if one.value is not None), then[-1])
        made = _difference(name, last, now, (bad, known))
        found.append(replace(made, apart=_apart(now.value, [*before, *(v.value for v in then)])))
    return found


def _told(run: RunValues, name: str, known: _Known) -> SetValue:
    """The value of a parameter; a default in the code is on no server, but it is reported."""
    if name in (run.values or {}):
        return run.set_value(name)
    comparisons = [one for one in known.comparisons_of(name) if run.recording.nodes_of.get(one.key)]
    sources = {parameter_name(one) for one in comparisons}
    # Other nodes may have other values under the name in the source.
    only_here = all(
        run.evaluated_in(name, one) == run.recording.nodes_of[one.key] for one in comparisons
    )
    if len(sources) != 1 or not only_here:
        return SetValue(None)
    value = value_in(run.recording, known.static_info, sources.pop())
    return SetValue(value, "" if value is None else DEFAULT)


def _same(one: object, other: object) -> bool:
    """Whether two values of the server are the same; 1 and 1.0 are, true and 1 are not."""
    if isinstance(one, bool) or isinstance(other, bool):
        return one is other
    if isinstance(one, float) and isinstance(other, float) and math.isnan(one):
        return math.isnan(other)
    if isinstance(one, list) and isinstance(other, list):
        return len(one) == len(other) and all(map(_same, one, other))
    return one == other


def _reported(
    bad: RunValues, good: Sequence[RunValues], known: _Known, names: Collection[str]
) -> list[Difference]:
    """Parameters whose thresholds differ though the recorded servers do not say so."""
    tpcs = Tpcs.of(known.static_info)
    here = thresholds_of(with_summarised(bad.recording), tpcs)
    there = [thresholds_of(with_summarised(run.recording), tpcs) for run in good]
    differs = np.zeros(here.size, np.bool_)
    same = np.zeros(here.size, np.bool_)
    for one in there:
        differs |= (here != one) & ~np.isnan(here) & ~np.isnan(one)
        same |= here == one
    parameters = {tpcs.parameters[code] for code in np.flatnonzero(differs & ~same)}
    parameters -= {tpcs.parameters[code] for code in np.flatnonzero(same)}
    found = []
    told = ByParameter(parameters, str)
    parameters -= {one for name in names for one in told.meant(name)}
    for parameter in sorted(parameters):
        now = value_in(bad.recording, known.static_info, parameter)
        runs = [value_in(run.recording, known.static_info, parameter) for run in good]
        then = next((value for value in reversed(runs) if value is not None), None)
        if now is None and then is None:
            # Its thresholds are worked out from more than the parameter, which may be as it was.
            continue
        made = _difference(parameter, SetValue(then), SetValue(now), (bad, known))
        found.append(replace(made, apart=_apart(now, runs)))
    return found


def _apart(now: object, good: Sequence[object]) -> float | None:
    """See `Difference`."""
    here, *there = (_finite(value) for value in (now, *good))
    known = [value for value in there if value is not None]
    if here is None or not known:
        return None
    if min(known) < here < max(known):
        return 0.0
    return min(abs(math.log(here / then)) if here * then > 0.0 else math.inf for then in known)


def _finite(value: object) -> float | None:
    """A value as a number; None of a flag, a text and what is beyond any double."""
    number = None if isinstance(value, bool) else SetValue(value).number
    return number if number is not None and math.isfinite(number) else None


def _difference(
    name: str, good: SetValue, bad: SetValue, about: tuple[RunValues, _Known]
) -> Difference:
    run, known = about
    comparisons, covered = known.comparisons_of(name), known.covered_as(name)
    return Difference(
        parameter=name,
        good=good,
        bad=bad,
        state="compared" if comparisons else next((one.state for one in covered), None),
        reads=tuple(dict.fromkeys(place for one in covered for place in one.reads)),
        compared_at=tuple(dict.fromkeys(f"{one.file}:{one.lineno}" for one in comparisons)),
        keys=tuple(one.key for one in comparisons if run.evaluated_in(name, one)),
    )


def _names_by_source(runs: Sequence[RunValues], known: _Known) -> Mapping[str, set[str]]:
    """For each name in the source the parameters on the servers that it can mean."""
    found = defaultdict[str, set[str]](set)
    for name in {name for run in runs for name in run.values or ()}:
        sources = {parameter_name(one) for one in known.comparisons_of(name)}
        for source in sources | {one.parameter for one in known.covered_as(name)}:
            found[source].add(name)
    return found


def _source_of(
    found: Difference,
    runs: Sequence[RunValues],
    meant: Mapping[str, set[str]],
    known: _Known,
) -> str:
    """The parameter's name in the source, if it means no other parameter of the robot."""
    comparisons = known.comparisons_of(found.parameter)
    sources = {parameter_name(one) for one in comparisons}
    sources = sources or {one.parameter for one in known.covered_as(found.parameter)}
    if len(sources) != 1:
        return ""
    (source,) = sources
    # Of a default, only the nodes that compared it are known.
    compared = {
        resolved(source, node)
        for run in runs
        for one in comparisons
        for node in run.recording.nodes_of.get(one.key, ())
        if source.startswith("~")
    }
    return source if len(meant.get(source, set()) | compared | {found.parameter}) == 1 else ""


def _replayed(found: Difference, bad: RunValues, known: _Known, window_s: float) -> Difference:
    """The difference with its comparisons replayed; as it is where the value is no number."""
    value = found.good.number
    if value is None:
        return found
    recording, replayed = bad.recording, []
    spans = spans_before([mark.time_ns for mark in recording.marks], window_s)
    names = {parameter_name(known.static_info.comparisons[key]) for key in found.keys}
    for name in sorted(names):
        tracks = tracks_of(recording.events, recording.summaries, known.static_info, name)[1]
        for track in tracks:
            if track.comparison.key not in found.keys:
                continue
            nodes = bad.evaluated_in(found.parameter, track.comparison)
            own = _only_of(track, nodes, recording.events.nodes)
            replayed.append(_turned(own, value, spans, recording.start_ns))
    return replace(found, replayed=tuple(replayed))


def _only_of(track: Track, nodes: Collection[str], known: Sequence[str]) -> Track:
    """The track in which only evaluations of these nodes count."""
    codes = [code for code, name in enumerate(known) if name in nodes]
    kept = track.kept
    theirs = [code for code, name in enumerate(kept.nodes) if name in nodes]
    own = track.own & np.isin(track.node, codes)
    return replace(track, own=own, kept=kept.take(np.isin(kept.node, theirs)))


def _turned(track: Track, value: float, spans: Int64s, start_ns: int) -> ReplayedComparison:
    counted = count_turned(track, value, spans)
    times = track.time_ns[track.turned(track.threshold(value)) & track.own]
    comparison = track.comparison
    return ReplayedComparison(
        key=comparison.key,
        place=f"{comparison.file}:{comparison.lineno}",
        source_code=(comparison.source_code or "").strip(),
        evaluations=counted.evaluations,
        turned=counted.turned,
        turned_near=counted.near,
        first_s=(int(times[0]) - start_ns) / 1e9 if times.size else None,
        unsure=counted.unsure,
    )


def _notes(bad: RunValues, good: Sequence[RunValues], static_info: StaticInfo) -> tuple[str, ...]:
    runs = (*good, bad)
    names = ", ".join(dict.fromkeys(run.name for run in runs if run.values is None))
    if not names:
        return ()
    notes = [
        f"no values in a params.yaml beside {names}: of these runs only parameters that are"
        " compared are known; `pytpc record` writes one, and `rosparam dump"
        " BAG.params.yaml` does for a bag"
    ]
    tpcs, several = Tpcs.of(static_info), set()
    for events in (with_summarised(run.recording) for run in runs if run.values is None):
        without = np.isnan(thresholds_of(events, tpcs))
        for key in events.keys:
            values = events.thresh[events.rows_of(key)]
            if key in tpcs.keys and without[tpcs.keys.index(key)] and np.isfinite(values).any():
                several.add(tpcs.parameters[tpcs.keys.index(key)])
    if several:
        which = listed(sorted(several), _NAMED)
        notes.append(f"not compared, as the reports of a run have several values: {which}")
    return tuple(notes)
