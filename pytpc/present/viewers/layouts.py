"""Layouts for the MCAP file of a mission: for Foxglove and Lichtblick, and for PlotJuggler.

They show the first suspects: value and threshold, margin, results, probabilities, marks, log.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from pytpc.base.atomic import write_atomic
from pytpc.base.wording import plain
from pytpc.diagnosis.results.exported import (
    LOG_TOPIC,
    MARKS_TOPIC,
    SUSPECTS_TOPIC,
    ComparisonSeries,
    MissionExport,
)

_RED, _BLUE = "#d62728", "#1f77b4"
_COLOURS = ("#d62728", "#1f77b4", "#2ca02c", "#9467bd", "#8c564b")
_TITLES = ("foxglovePanelTitle", "lichtblickPanelTitle")
_ROOM = 0.05

Layout = dict[str, Any]


def write_foxglove(found: MissionExport, path: Path) -> None:
    """Write the layout that Foxglove and Lichtblick import.

    Raises:
        TpcError: it cannot be written.
    """
    write_atomic(path, json.dumps(foxglove_layout(found), indent=1).encode() + b"\n")


def write_plotjuggler(found: MissionExport, path: Path, mcap: Path | None) -> None:
    """Write the layout that PlotJuggler loads, and with it the MCAP file if there is one.

    Raises:
        TpcError: it cannot be written.
    """
    root = plotjuggler_layout(found, path, mcap)
    ElementTree.indent(root, " ")
    write_atomic(path, ElementTree.tostring(root, "utf-8", xml_declaration=True) + b"\n")


def foxglove_layout(found: MissionExport) -> Layout:
    """The layout as the document that the viewers export themselves."""
    shown = [found.series[number] for number in found.first]
    plots: Layout = {
        f"Plot!value{number}": _plot(
            title_of(one),
            [
                {"value": f"{one.topic}.value", "label": "value", "color": _BLUE},
                {"value": f"{one.topic}.threshold", "label": "threshold", "color": _RED},
            ],
        )
        for number, one in enumerate(shown)
    }
    others: Layout = {
        "StateTransitions!results": _titled(
            "Results of the first suspects",
            paths=[
                {
                    "value": f"{one.topic}.result",
                    "label": title_of(one),
                    "enabled": True,
                    "timestampMethod": "receiveTime",
                }
                for one in shown
            ],
            isSynced=True,
        ),
        "Plot!probability": _plot("Probability after each mark", _probabilities(found)),
        "Plot!marks": _plot(
            "Marks: type 1 or 2",
            [{"value": f"{MARKS_TOPIC}.type", "label": "mark", "color": _RED, "showLine": False}],
        ),
        "Table!suspects": _titled("Suspects", topicPath=f"{SUSPECTS_TOPIC}.suspects"),
        "RosOut!log": _titled(
            "Marks, verdicts and turns", searchTerms=[], minLogLevel=1, topicToRender=LOG_TOPIC
        ),
    }
    right = _stacked(["Plot!probability", "Plot!marks", "Table!suspects", "RosOut!log"])
    left = _stacked([*plots, "StateTransitions!results"])
    return {
        "configById": {**plots, **others},
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 1},
        "layout": {"direction": "row", "first": left, "second": right, "splitPercentage": 60},
    }


def title_of(one: ComparisonSeries) -> str:
    """What a plot is called: parameter, node and place."""
    return plain(f"{one.parameter} in {one.node} ({one.place})")


def _plot(title: str, paths: Sequence[Mapping[str, object]]) -> Layout:
    return _titled(
        title,
        paths=[{"enabled": True, "timestampMethod": "receiveTime", **one} for one in paths],
        showLegend=True,
        legendDisplay="floating",
        showPlotValuesInLegend=False,
        showXAxisLabels=True,
        showYAxisLabels=True,
        isSynced=True,
        xAxisVal="timestamp",
        sidebarDimension=240,
    )


def _titled(title: str, **config: object) -> Layout:
    return {**dict.fromkeys(_TITLES, title), **config}


def _probabilities(found: MissionExport) -> list[dict[str, object]]:
    if not found.suspects:
        return []
    first = found.suspects[-1].suspects[: len(_COLOURS)]
    return [
        {
            "value": f"{found.probability_topics[one.parameter]}.probability",
            "label": plain(one.parameter),
            "color": colour,
        }
        for one, colour in zip(first, _COLOURS, strict=False)
    ]


def _stacked(names: Sequence[str]) -> str | Layout:
    """Panels one below the other, all of the same height."""
    if len(names) == 1:
        return names[0]
    return {
        "direction": "column",
        "first": names[0],
        "second": _stacked(names[1:]),
        "splitPercentage": 100 / len(names),
    }


def plotjuggler_layout(found: MissionExport, path: Path, mcap: Path | None) -> ElementTree.Element:
    """The layout, which is for the folder of ``path``: it names ``mcap`` relative to that."""
    root = ElementTree.Element("root")
    tabs = _sub(root, "tabbed_widget", parent="main_window", name="Main Window")
    shown = [found.series[number] for number in found.first]
    values = [
        (title_of(one), [(f"{one.topic}/value", _BLUE), (f"{one.topic}/threshold", _RED)], limits)
        for one, limits in zip(shown, found.ranges, strict=True)
    ]
    results = [(title_of(one), [(f"{one.topic}/result", _BLUE)], (0.0, 1.0)) for one in shown]
    probabilities = [
        (str(one["value"]).replace(".", "/"), str(one["color"])) for one in _probabilities(found)
    ]
    others = [("Probability after each mark", probabilities, (0.0, 1.0))] if probabilities else []
    if found.marks:
        others.append(("Marks: type 1 or 2", [(f"{MARKS_TOPIC}/type", _RED)], (0.0, 2.0)))
    for name, plots, style in (
        ("suspects", values, "Lines"),
        ("results", results, "Steps"),
        ("marks", others, "Dots"),
    ):
        if plots:
            _tab(tabs, name, plots, style, found)
    _sub(tabs, "currentTabIndex", index="0")
    _sub(root, "use_relative_time_offset", enabled="1")
    if mcap is not None:
        files = _sub(root, "previouslyLoaded_Datafiles")
        file = _sub(files, "fileInfo", prefix="", filename=_relative(mcap, path))
        _sub(file, "selected_datasources", value="")
        plugin = _sub(file, "plugin", ID="DataLoad MCAP")
        topics = [one.topic for one in found.series] + [one.topic for one in found.values]
        topics += [MARKS_TOPIC, *found.rank_topics, *found.probability_topics.values()]
        _sub(
            plugin,
            "parameters",
            use_timestamp="0",
            use_mcap_log_time="1",
            clamp_large_arrays="1",
            max_array_size="500",
            selected_topics=";".join(dict.fromkeys(topics)),
        )
    return root


def _tab(
    tabs: ElementTree.Element,
    name: str,
    plots: Sequence[tuple[str, Sequence[tuple[str, str]], tuple[float, float]]],
    style: str,
    found: MissionExport,
) -> None:
    """A tab with its plots one below the other."""
    tab = _sub(tabs, "Tab", tab_name=name, containers="1")
    sizes = ";".join(f"{1 / len(plots):.6f}" for _ in plots)
    container = _sub(tab, "Container")
    splitter = _sub(container, "DockSplitter", orientation="-", count=str(len(plots)), sizes=sizes)
    for title, curves, (low, high) in plots:
        area = _sub(splitter, "DockArea", name=title)
        plot = _sub(area, "plot", mode="TimeSeries", style=style, flip_x="false", flip_y="false")
        room = _ROOM * (high - low) or 1.0
        _sub(
            plot,
            "range",
            left="0.000000",
            right=f"{(found.end_ns - found.start_ns) / 1e9:.6f}",
            # All digits: limits may be far below a millionth.
            bottom=repr(low - room),
            top=repr(high + room),
        )
        _sub(plot, "limitY")
        for curve, colour in curves:
            _sub(plot, "curve", name=curve, color=colour)


def _sub(above: ElementTree.Element, tag: str, /, **attributes: str) -> ElementTree.Element:
    return ElementTree.SubElement(above, tag, attributes)


def _relative(mcap: Path, layout: Path) -> str:
    return os.path.relpath(mcap.absolute(), layout.absolute().parent)
