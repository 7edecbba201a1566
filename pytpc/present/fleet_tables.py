"""The answers about a fleet as tables, for a terminal and for pipes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rich.console import Console, Group, RenderableType
from rich.padding import Padding
from rich.text import Text

from pytpc.base.wording import plain
from pytpc.diagnosis.results.fleet import (
    FleetDrifts,
    FleetOutliers,
    FleetRanking,
    FleetSuspect,
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
from pytpc.present.listing import Heading, Listing

_NUMBER = Heading("#", right=True, in_line=True)
_ROBOT = Heading("Robot", in_line=True)
_PARAMETER = Heading("Parameter", in_line=True)
_COMPARED = Heading("Compared at")
_CAUSES = (
    _PARAMETER,
    Heading("Probability", right=True, in_line=True),
    Heading("Bad missions", right=True),
    Heading("Robots"),
)
_CAUSE_TERMS = (
    "Each by the bad missions that no other cause explains. The suspects below are judged as if all"
    " bad missions had one cause."
)
_SUSPECTS = (
    _NUMBER,
    _PARAMETER,
    Heading("Probability", right=True, in_line=True),
    Heading("Why"),
    Heading("Values in bad (missions)"),
    Heading("Values in good (missions)"),
    Heading("Margin bad", right=True),
    Heading("Margin good", right=True),
    Heading("Robots"),
    _COMPARED,
)
_METHODS = (
    _PARAMETER,
    Heading("Position", right=True),
    Heading("Importance", right=True),
    Heading("Its position", right=True),
    Heading("Differs", right=True),
    Heading("Each mission alone", right=True),
)
_METHOD_TERMS = (
    "Importance: how well the parameter's comparisons tell bad missions from good ones. Differs:"
    " the share of bad missions with a value that no good one has. Each mission alone: the mean"
    " position in the diagnoses of single missions."
)
_ROBOT_TERMS = "Robots: those whose bad missions have a value that none of their good ones has."
_DRIFTS = (
    _PARAMETER,
    _ROBOT,
    Heading("Turns on"),
    Heading("Between"),
    Heading("Margin"),
    Heading("Now", right=True),
    Heading("Per day", right=True),
    Heading("Threshold", right=True),
    Heading("Days", right=True),
    Heading("Since"),
    Heading("Turned", right=True),
    Heading("Chance", right=True),
    Heading("Clear"),
    _COMPARED,
)
_DRIFT_TERMS = (
    "Turns on: the day on which the margin will be 0 if it goes on so. Margin: the least or the"
    " median of each mission. Turned: how often it has turned since. Clear: hardly by chance,"
    " however many were tested."
)
_DECISIONS = (
    _ROBOT,
    _PARAMETER,
    Heading("What differs"),
    Heading("Own", right=True),
    Heading("Usual", right=True),
    Heading("Off by", right=True),
    Heading("Chance", right=True),
    Heading("Sisters", right=True),
    Heading("Set otherwise"),
    _COMPARED,
)
_SETTINGS = (
    _ROBOT,
    _PARAMETER,
    Heading("Value", right=True),
    Heading("Usual", right=True),
    Heading("Sisters with it", right=True),
    Heading("Off by", right=True),
)
_COUNTS = (_ROBOT, Heading("Decisions", right=True), Heading("Settings", right=True))
_OFF = "Off by: in median absolute deviations of the sisters."
_FOUND = (
    _ROBOT,
    Heading("Day", in_line=True),
    Heading("Mission", in_line=True),
    Heading("Went"),
    Heading("Turns", right=True),
    Heading("Least margin", right=True),
    Heading("Comparisons"),
)
_TURNS = (
    _ROBOT,
    Heading("Mission", in_line=True),
    Heading("Seconds", right=True, in_line=True),
    _PARAMETER,
    Heading("Became"),
    Heading("Value", right=True),
    Heading("Threshold", right=True),
    Heading("Margin", right=True),
    _COMPARED,
)


def print_ranking(console: Console, ranking: FleetRanking, top: int) -> None:
    """Print the judgement, the first ``top`` suspects, and what other methods say of them."""
    shown = ranking.suspects[:top]
    parts: list[RenderableType] = [
        Text(ranking_title(ranking), style="bold"),
        _indented(ranking.text, "bold" if ranking.accused is not None else "yellow"),
    ]
    if ranking.is_mixed:
        parts += [Text(), Text("Causes", style="bold")]
        parts.append(
            _listing(console, _CAUSES, [_cells(*CauseTexts.of(one)) for one in ranking.causes])
        )
        parts += [_indented(_CAUSE_TERMS, "dim"), Text(), Text("Suspects", style="bold")]
    if shown:
        rows = [_suspect_cells(one) for one in shown]
        parts.append(_listing(console, _SUSPECTS, rows))
        parts += _rest(len(ranking.suspects) - len(shown))
        parts.append(_indented(_ROBOT_TERMS, "dim"))
        parts += [Text(), Text("Methods side by side", style="bold")]
        parts.append(_listing(console, _METHODS, _method_rows(ranking.suspects, top)))
        parts.append(_indented(_METHOD_TERMS, "dim"))
    _print(console, [*parts, *_notes(ranking.notes)])


def _suspect_cells(one: FleetSuspect) -> list[Text]:
    texts = SuspectTexts.of(one)
    cells = _cells(
        texts.position,
        texts.parameter,
        texts.probability,
        texts.reason,
        texts.bad,
        texts.good,
        texts.margin_bad,
        texts.margin_good,
        texts.robots,
    )
    if one.position == 1:
        cells[1].stylize("bold")
    return [*cells, _compared(texts.place, texts.node)]


def _method_rows(suspects: Sequence[FleetSuspect], top: int) -> list[list[Text]]:
    """The first suspects, and behind them the first ones of Importance."""
    named = [one for n, one in enumerate(suspects) if n < top or one.importance_position == 1]
    return [
        _cells(
            texts.parameter,
            texts.position,
            texts.importance,
            texts.importance_position,
            texts.differs,
            texts.mean_position,
        )
        for texts in map(SuspectTexts.of, named)
    ]


def print_drifts(console: Console, drifts: FleetDrifts, top: int) -> None:
    """Print the first ``top`` margins that drift, and how many would by chance."""
    shown = drifts.drifts[:top]
    parts: list[RenderableType] = [Text(plain(drifts_title(drifts)), style="bold")]
    if shown:
        rows = [_drift_cells(DriftTexts.of(one)) for one in shown]
        parts.append(_listing(console, _DRIFTS, rows))
        parts += _rest(len(drifts.drifts) - len(shown))
        parts.append(_indented(_DRIFT_TERMS, "dim"))
    _print(console, [*parts, *_notes(drifts_notes(drifts))])


def _drift_cells(texts: DriftTexts) -> list[Text]:
    cells = _cells(
        texts.parameter,
        texts.robot,
        texts.turns_on,
        texts.interval.strip("()"),
        texts.measure,
        texts.now,
        texts.per_day,
        texts.threshold,
        texts.days,
        texts.since,
        texts.turned,
        texts.chance,
        texts.clear,
    )
    cells[2].stylize("bold")
    return [*cells, _compared(texts.place, texts.node)]


def print_outliers(console: Console, outliers: FleetOutliers, top: int) -> None:
    """Print the first ``top`` decisions and settings that differ, and how many each robot has."""
    parts: list[RenderableType] = [Text(plain(outliers_title(outliers)), style="bold")]
    if outliers.decisions:
        rows = [_decision_cells(DecisionTexts.of(one)) for one in outliers.decisions[:top]]
        parts += [_indented("What it decides otherwise", "bold")]
        parts.append(_listing(console, _DECISIONS, rows))
        parts += _rest(len(outliers.decisions) - len(rows))
    if outliers.settings:
        settings = [SettingTexts.of(one) for one in outliers.settings[:top]]
        parts += [_indented("What is set otherwise", "bold")]
        parts.append(_listing(console, _SETTINGS, [_cells(*texts) for texts in settings]))
        parts += _rest(len(outliers.settings) - len(settings))
    differing = [one for one in outliers.counts if one.decisions or one.settings]
    if differing:
        counts = [
            _cells(one.robot, f"{one.decisions:,}", f"{one.settings:,}") for one in differing[:top]
        ]
        parts += [_indented("Robots", "bold"), _listing(console, _COUNTS, counts)]
        parts += [*_rest(len(differing) - len(counts)), _indented(_OFF, "dim")]
    _print(console, [*parts, *_notes(outliers.notes)])


def _decision_cells(texts: DecisionTexts) -> list[Text]:
    cells = _cells(
        texts.robot,
        texts.parameter,
        texts.measure,
        texts.own,
        texts.usual,
        texts.score,
        texts.chance,
        texts.sisters,
        texts.set_otherwise,
    )
    return [*cells, _compared(texts.place, texts.node)]


def print_found(console: Console, found: Sequence[Found], top: int) -> None:
    """Print the first ``top`` missions and, where there are some, the first ``top`` turns."""
    parts: list[RenderableType] = [Text(found_title(found), style="bold")]
    if found:
        rows = [_cells(*MissionTexts.of(one)) for one in found[:top]]
        parts += [_listing(console, _FOUND, rows), *_rest(len(found) - len(rows))]
    turns = [(mission, turn) for mission, own in found for turn in own]
    if turns:
        cells = [
            [*_cells(mission.robot, mission.mission, *texts[:6]), _compared(*texts[6:])]
            for mission, turn in turns[:top]
            for texts in [TurnTexts.of(turn, mission.start_ns)]
        ]
        parts += [Text(), Text("Turns", style="bold"), _listing(console, _TURNS, cells)]
        parts += _rest(len(turns) - len(cells))
    _print(console, parts)


def _cells(*texts: str) -> list[Text]:
    return [Text(plain(text)) for text in texts]


def _compared(place: str, node: str) -> Text:
    """The source line, and the node below it."""
    text = Text(plain(place))
    return text.append(f"\n{plain(node)}", style="dim") if node else text


def _listing(
    console: Console, headings: Sequence[Heading], rows: Sequence[Sequence[Text]]
) -> RenderableType:
    """Rows; to a person without the columns in which nothing is said."""
    piped = not console.is_terminal
    kept = [
        n
        for n, one in enumerate(headings)
        if piped or one.in_line or any(row[n].plain for row in rows)
    ]
    cells = [[row[n] for n in kept] for row in rows]
    listing = Listing([headings[n] for n in kept], cells, one_line=piped)
    return Padding(listing, (0, 0, 0, 2), expand=False)


def _indented(text: str, style: str = "") -> RenderableType:
    return Padding(Text(plain(text), style=style), (0, 0, 0, 2), expand=False)


def _rest(count: int) -> list[RenderableType]:
    return [_indented(f"and {count:,} more: --top shows more", "dim")] if count else []


def _notes(notes: Iterable[str]) -> list[RenderableType]:
    return [_indented(note, "yellow") for note in notes]


def _print(console: Console, parts: Sequence[RenderableType]) -> None:
    console.print(Padding(Group(*parts), (0, 0, 1, 0), expand=False), highlight=False)
