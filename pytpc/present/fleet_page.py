"""The answers about a fleet as pages: one HTML file each, which asks the network for nothing.

Whatever comes from a robot is cut to a bounded length and escaped. A page is bounded, too: where it
shows a part it says so, and the JSON has all.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from pytpc.base.atomic import write_atomic
from pytpc.base.wording import percent
from pytpc.diagnosis.results.fleet import (
    FleetCause,
    FleetDrift,
    FleetDrifts,
    FleetOutliers,
    FleetRanking,
    FleetSuspect,
    ValueInMissions,
)
from pytpc.present.fleet_texts import (
    CauseTexts,
    DecisionTexts,
    DriftTexts,
    Found,
    MissionTexts,
    SettingTexts,
    SuspectTexts,
    TurnTexts,
    drifts_notes,
    drifts_title,
    found_title,
    outliers_title,
    ranking_title,
)
from pytpc.present.page.drift_chart import DriftChart, drift_chart
from pytpc.present.page.environment import environment, page_script, script_hash
from pytpc.present.page.plots import shortened

ROWS = 100
"""So many rows a table has."""
CARDS = 20
"""So many suspects, drifts and missions are shown at length."""
_LONGEST = 240
_LONGEST_NAME = 48
_LONGEST_CELL = 9
_LONGEST_HEADING = 32
_ROBOTS_SHOWN = 12
_MATRIX = (40, 30)
Texts = TypeVar("Texts", bound="tuple[str, ...]")


def write_page(path: Path, page: str) -> None:
    """Write a page, atomically.

    Raises:
        TpcError: the file cannot be written; what stood there before is untouched.
    """
    write_atomic(path, page.encode("utf-8", "replace"))


@dataclass(frozen=True)
class Bar:
    """A bar: where it begins and how long it is, in percent of its room."""

    begin: float
    length: float
    is_against: bool = False


@dataclass(frozen=True)
class EvidenceView:
    """A kind of evidence: its number, and its bar to the left or right of the middle."""

    text: str
    bar: Bar


@dataclass(frozen=True)
class ValueView:
    """A value, and how many bad and good missions had it."""

    text: str
    bad: int
    good: int
    fresh: int
    bad_bar: Bar
    good_bar: Bar
    robots: tuple[str, ...]
    more_robots: int


@dataclass(frozen=True)
class CauseView:
    """A cause; ``more_robots`` are not in ``robots``."""

    texts: CauseTexts
    bar: Bar
    robots: tuple[str, ...]
    more_robots: int


@dataclass(frozen=True)
class SuspectView:
    """A suspect; ``margins`` are a name, a text and a bar each. ``ident`` is that of its card."""

    ident: str
    texts: SuspectTexts
    bar: Bar
    evidence: list[EvidenceView]
    values: list[ValueView]
    more_values: int
    margins: list[tuple[str, str, Bar]]
    unit: str
    robots: tuple[str, ...]
    more_robots: int


def ranking_page(ranking: FleetRanking, title: str) -> str:
    """The page of a judgement: the suspects, the evidence, values and margins."""
    shown = ranking.suspects[:ROWS]
    longest = max((abs(number) for one in shown for number in _evidence(one)), default=0.0)
    views = [_suspect_view(one, f"s{n}", longest) for n, one in enumerate(shown, start=1)]
    before = sum(one.probability > ranking.none for one in shown)
    return _page(
        "fleet-ranking.html.j2",
        title,
        judged=ranking_title(ranking),
        claim=_short(ranking.text),
        is_sure=ranking.accused is not None,
        notes=_shorts(ranking.notes),
        causes=[_cause_view(one) for one in ranking.causes] if ranking.is_mixed else [],
        suspects=views,
        cards=views[:CARDS],
        more=len(ranking.suspects) - len(shown),
        none_text=percent(ranking.none),
        none_bar=Bar(0.0, 100 * ranking.none),
        none_after=before,
    )


def _cause_view(one: FleetCause) -> CauseView:
    return CauseView(
        _cut(CauseTexts.of(one)),
        Bar(0.0, 100 * one.probability),
        *_robots(one.robots),
    )


def _evidence(one: FleetSuspect) -> tuple[float, float, float, float]:
    found = one.evidence
    return found.diagnoses, found.values, found.behaviour, found.prior


def _suspect_view(one: FleetSuspect, ident: str, longest: float) -> SuspectView:
    most = max((max(value.bad, value.good) for value in one.values), default=0)
    margins = [("bad", one.margin_bad), ("good", one.margin_good)]
    widest = max((abs(margin) for _, margin in margins if margin is not None), default=0.0)
    texts = _cut(SuspectTexts.of(one))
    told = {"bad": texts.margin_bad, "good": texts.margin_good}
    robots, more_robots = _robots(one.robots)
    return SuspectView(
        ident=ident,
        texts=texts,
        bar=Bar(0.0, 100 * one.probability),
        evidence=[
            EvidenceView(_signed(number), _both_ways(number, longest)) for number in _evidence(one)
        ],
        values=[_value_view(value, most) for value in one.values[:ROWS]],
        more_values=one.more_values + max(0, len(one.values) - ROWS),
        margins=[
            (name, told[name], _bar(abs(margin), widest))
            for name, margin in margins
            if margin is not None
        ],
        unit=one.unit,
        robots=robots,
        more_robots=more_robots,
    )


def _signed(number: float) -> str:
    """``+1.2``; no sign is before a zero."""
    return f"{number:+.1f}" if round(number, 1) else "0.0"


def _value_view(value: ValueInMissions, most: int) -> ValueView:
    return ValueView(
        _short(value.text),
        value.bad,
        value.good,
        value.fresh,
        _bar(value.bad, most),
        _bar(value.good, most),
        *_robots(value.robots),
    )


def _robots(robots: Sequence[str]) -> tuple[tuple[str, ...], int]:
    """The first ones, and how many more there are."""
    return _shorts(robots[:_ROBOTS_SHOWN]), max(0, len(robots) - _ROBOTS_SHOWN)


def _bar(value: float, most: float) -> Bar:
    return Bar(0.0, 100 * value / most if most else 0.0)


def _both_ways(value: float, longest: float) -> Bar:
    length = 50 * abs(value) / longest if longest else 0.0
    return Bar(50 - length, length, True) if value < 0 else Bar(50.0, length)


@dataclass(frozen=True)
class DriftView:
    """A drift; ``chart`` is None where none is drawn."""

    ident: str
    texts: DriftTexts
    turns: bool
    chart: DriftChart | None


def drifts_page(
    drifts: FleetDrifts,
    title: str,
    on_figure: Callable[[], None] = lambda: None,
) -> str:
    """The page of the margins that drift, with a chart for each of the first ones.

    Args:
        drifts: the drifts.
        title: of the page.
        on_figure: called after each chart: those of a full page take seconds.
    """
    views = []
    for n, one in enumerate(drifts.drifts[:ROWS]):
        chart = _chart(one, f"d{n + 1}") if n < CARDS else None
        if n < CARDS:
            on_figure()
        texts = _cut(DriftTexts.of(one))
        views.append(DriftView(f"d{n + 1}", texts, one.turns_on is not None, chart))
    return _page(
        "fleet-drifts.html.j2",
        title,
        claim=_short(drifts_title(drifts)),
        notes=drifts_notes(drifts),
        drifts=views,
        cards=views[:CARDS],
        more=len(drifts.drifts) - len(views),
    )


def _chart(one: FleetDrift, ident: str) -> DriftChart | None:
    texts = DriftTexts.of(one)
    label = f"{texts.measure} margin of {texts.parameter}, {texts.robot}, {texts.since} to"
    when = f", turns on {one.turns_on}" if one.turns_on is not None else ""
    return drift_chart(one, f"{ident}-c", _short(f"{label} {texts.until}{when}"))


@dataclass(frozen=True)
class CellView:
    """What a robot does otherwise with a parameter.

    ``setting`` is its value; ``is_more``: None without a decision, else whether its measure is
    above the sisters'. ``told`` says all of it.
    """

    setting: str
    is_more: bool | None
    told: str


@dataclass(frozen=True)
class MatrixView:
    """Robots by parameters, short and in full; a cell is None where a robot is as its sisters."""

    parameters: list[tuple[str, str]]
    rows: list[tuple[str, list[CellView | None]]]
    more_robots: int
    more_parameters: int


def outliers_page(outliers: FleetOutliers, title: str) -> str:
    """The page of the robots that differ: a matrix of robots and parameters, and both lists."""
    return _page(
        "fleet-outliers.html.j2",
        title,
        claim=outliers_title(outliers),
        notes=_shorts(outliers.notes),
        matrix=_matrix(outliers),
        decisions=[_cut(DecisionTexts.of(one)) for one in outliers.decisions[:ROWS]],
        more_decisions=max(0, len(outliers.decisions) - ROWS),
        settings=[_cut(SettingTexts.of(one)) for one in outliers.settings[:ROWS]],
        more_settings=max(0, len(outliers.settings) - ROWS),
    )


def _matrix(outliers: FleetOutliers) -> MatrixView:
    decisions = [(one.robot, one.where.parameter) for one in outliers.decisions]
    settings = [(one.robot, one.parameter) for one in outliers.settings]
    # Those with decisions are of more interest than those with settings, and first of those equal.
    weights = Counter(name for _, name in decisions)
    every = Counter(name for _, name in (*decisions, *settings))
    parameters = sorted(every, key=lambda name: (-weights[name], -every[name], name))
    robots = [one.robot for one in outliers.counts if one.decisions or one.settings]
    most_robots, most_parameters = _MATRIX
    told = {(one.robot, one.parameter): one for one in outliers.settings}
    # The first of a parameter's comparisons deviates most.
    decided = {(one.robot, one.where.parameter): one for one in reversed(outliers.decisions)}
    rows: list[tuple[str, list[CellView | None]]] = []
    for robot in robots[:most_robots]:
        cells = []
        for name in parameters[:most_parameters]:
            setting, decision = told.get((robot, name)), decided.get((robot, name))
            words = []
            if setting is not None:
                words.append(f"set to {setting.value}, usual {setting.usual}")
            if decision is not None:
                texts = DecisionTexts.of(decision)
                words.append(f"{texts.measure} {texts.own}, usual {texts.usual}")
            cells.append(
                CellView(
                    "" if setting is None else shortened(setting.value, _LONGEST_CELL),
                    None if decision is None else decision.own > decision.usual,
                    _short(f"{robot}, {name}: {'; '.join(words)}"),
                )
                if words
                else None
            )
        rows.append((shortened(robot, _LONGEST_NAME), cells))
    return MatrixView(
        [(_end_of(name), _short(name)) for name in parameters[:most_parameters]],
        rows,
        max(0, len(robots) - most_robots),
        max(0, len(parameters) - most_parameters),
    )


@dataclass(frozen=True)
class FoundView:
    """A mission with the first of its turns."""

    ident: str
    texts: MissionTexts
    turns: list[TurnTexts]
    more_turns: int


def found_page(found: Sequence[Found], title: str) -> str:
    """The page of the missions that were found, with turns where there are some."""
    views = [
        FoundView(
            f"m{n}",
            _cut(MissionTexts.of((mission, turns))),
            [_cut(TurnTexts.of(turn, mission.start_ns)) for turn in turns[:ROWS]],
            max(0, len(turns) - ROWS),
        )
        for n, (mission, turns) in enumerate(found[:ROWS], start=1)
    ]
    return _page(
        "fleet-found.html.j2",
        title,
        claim=found_title(found),
        missions=views,
        cards=[one for one in views if one.turns][:CARDS],
        more=len(found) - len(views),
    )


def _end_of(name: str) -> str:
    """The end of a name, which tells more than its namespaces."""
    return name if len(name) <= _LONGEST_HEADING else f"…{name[1 - _LONGEST_HEADING :]}"


def _short(text: str) -> str:
    return shortened(text, _LONGEST)


def _shorts(texts: Iterable[str]) -> tuple[str, ...]:
    return tuple(map(_short, texts))


def _cut(texts: Texts) -> Texts:
    """The texts of an answer, none of them longer than a page can bear."""
    return type(texts)(*map(_short, texts))


def _page(template: str, title: str, **known: Any) -> str:  # noqa: ANN401 - each template has its own
    scripts = [page_script("theme.js"), page_script("cards.js") + page_script("fleet.js")]
    return (
        environment()
        .get_template(template)
        .render(
            title=title,
            scripts=scripts,
            hashes=[script_hash(script) for script in scripts],
            **known,
        )
    )
