"""A mission for the report page, and a reader of the page."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import replace
from html.parser import HTMLParser

from mission_samples import comparison, events, ns, static_info

from pytpc.api.report import MissionReport, write_missions
from pytpc.diagnosis.ranking.mark_ranking import rank_marks
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.static.link_unit import PathStep

# Two known lines and a gap; the second line is the comparison's own.
WAY = (
    PathStep(
        "read", "src/node.cpp", 3, 1, "Node::Node", "coverage read into <i>", "get(&c); // <b>"
    ),
    PathStep("omitted", "", 0, 0, "", "7 steps left out", None),
    PathStep("compare", "src/node.cpp", 11, 9, "Node::step", "compared: a > b", "if (a > b)"),
)
NASTY = '<script>alert("1")</script>&$x_{1}$'


def mission(tmp_path, **changes):
    """40 s at 10 Hz: coverage rises to 0.5 below its limit of 0.6; faces flop at 30 s."""
    source = tmp_path / "src"
    source.mkdir(exist_ok=True)
    lines = [f"int line{n};" for n in range(1, 31)]
    lines[10] = "    if (coverage > coverage_) { // <b>"
    (source / "node.cpp").write_text("\n".join(lines))
    static = static_info(
        comparison(0, "faces", ">=", lineno=5, source_code="not what is there now", default=3),
        comparison(
            1,
            "coverage",
            lineno=11,
            source_code="if (coverage > coverage_) { // <b>",
            path=WAY,
        ),
        comparison(2, NASTY, "<", file="gone.cpp", topic=NASTY, function=NASTY, name=NASTY),
        comparison(3, "never"),
        source_root=str(tmp_path),
    )
    rows = []
    for step in range(400):
        t = step / 10
        coverage = min(0.5, t / 60)
        rows += [
            (t, 0, t >= 30, 4 if t >= 30 else 1, 3),
            (t, 1, False, coverage, 0.6),
            (t, 2, step % 50 < 25, step % 50, 25),
        ]
    recording = Recording(
        "night <flight>",
        events(rows, node=f"/node{NASTY}"),
        (Mark(ns(31), "I", "o<b>"), Mark(ns(35), "II"), Mark(ns(36), None)),
        0,
        ns(40),
    )
    report = MissionReport(
        name=recording.name,
        recording=recording,
        static_info=static,
        rankings=rank_marks(recording, static),
        treatment="limit 0.4 <raised>",
        changed_parameter="coverage",
    )
    return replace(report, **changes)


class Page(HTMLParser):
    """Collects what the tests ask of a page, and checks that its elements close."""

    VOID = frozenset(
        {"meta", "br", "path", "use", "rect", "line", "stop", "link", "img", "input", "wbr"}
    )

    def __init__(self, text):
        super().__init__()
        self.ids, self.references, self.tags, self.text = Counter(), set(), Counter(), []
        self.addresses = set()
        self.open = []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.tags[tag] += 1
        if tag not in self.VOID:
            self.open.append(tag)
        self._attributes(attrs)

    def handle_startendtag(self, tag, attrs):
        self.tags[tag] += 1
        self._attributes(attrs)

    def handle_endtag(self, tag):
        if tag not in self.VOID:
            assert self.open.pop() == tag

    def handle_data(self, data):
        self.text.append(data)

    def _attributes(self, attrs):
        for name, text in attrs:
            value = text or ""
            assert not name.startswith("on")
            if name == "id":
                self.ids[value] += 1
            if name in {"aria-labelledby", "aria-describedby"}:
                self.references.add(f"#{value}")
            if name in {"href", "xlink:href", "src", "action"}:
                (self.references if value.startswith("#") else self.addresses).add(value)
            self.references.update(f"#{found}" for found in re.findall(r"url\(#([^)]*)\)", value))
            self.addresses.update(re.findall(r"url\(([^#)][^)]*)\)", value))


def written(tmp_path, *missions, **options):
    path = tmp_path / "report.html"
    write_missions(path, missions, **options)
    return path.read_text(encoding="utf-8")
