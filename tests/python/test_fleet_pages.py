"""The answers about a fleet: tables for terminals and pipes, JSON, Parquet and pages."""

from __future__ import annotations

import io
import json
import math
from collections import Counter
from dataclasses import replace
from html.parser import HTMLParser

import pyarrow.parquet as pq
import pytest
from fleet_answers import (
    START_NS,
    decision,
    drift,
    drifts,
    mission,
    outliers,
    place,
    ranking,
    rising,
    setting,
    suspect,
    turn,
    uncompared,
    value,
)
from rich.console import Console

from pytpc.base.columns import write_table
from pytpc.base.wording import plain_json
from pytpc.diagnosis.results.fleet import DayMargin, FleetCause, FleetEvidence
from pytpc.present.fleet_columns import (
    DRIFTS,
    FOUND,
    METADATA,
    OUTLIERS,
    RANKING,
    drifts_table,
    found_table,
    outliers_table,
    ranking_table,
)
from pytpc.present.fleet_json import drifts_json, found_json, outliers_json, ranking_json
from pytpc.present.fleet_page import (
    CARDS,
    ROWS,
    drifts_page,
    found_page,
    outliers_page,
    ranking_page,
    write_page,
)
from pytpc.present.fleet_tables import print_drifts, print_found, print_outliers, print_ranking

HOSTILE = "</script><img src=x onerror=alert(1)>{{7*7}}\x1b[31m\u202e\n|'\"&amp;\ud800"
BLAMED = ranking(
    suspect(1, "~safe_distance", 0.85), suspect(2, "~gain", 0.05), uncompared(3, "~mode")
)


def printed(printer, answer, top=10, *, width=400, is_terminal=False) -> str:
    out = io.StringIO()
    console = Console(file=out, width=width, force_terminal=is_terminal, color_system=None)
    printer(console, answer, top)
    return out.getvalue()


def line_of(text: str, word: str) -> str:
    (found,) = (line for line in text.splitlines() if word in line)
    return " ".join(found.split())


class Page(HTMLParser):
    """How often each tag is there, the attributes by name, and all text outside of scripts."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: Counter[str] = Counter()
        self.attributes: dict[str, list[str]] = {}
        self.text = ""
        self._inside: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags[tag] += 1
        self._inside.append(tag)
        for name, own in attrs:
            self.attributes.setdefault(name, []).append(own or "")

    def handle_endtag(self, tag):
        while self._inside and self._inside.pop() != tag:
            pass

    def handle_data(self, data):
        if not {"script", "style"} & set(self._inside[-1:]):
            self.text += data

    @property
    def words(self) -> str:
        return " ".join(self.text.split())


def test_a_ranking_has_the_judgement_the_reasons_and_the_methods() -> None:
    # 0.85, 0.05 and 0.01 leave 0.09 for none of them.
    text = printed(print_ranking, replace(BLAMED, notes=("robots without a good mission: r7",)))
    lines = [line.strip() for line in text.splitlines()]
    assert lines[0] == "4 bad and 10 good missions of 3 robots; 2 bad ones have a diagnosis"
    assert lines[1] == "blame ~safe_distance: 85 %; none of the parameters: 9 %"
    assert [" ".join(line.split()) for line in lines if line.startswith("1  ")] == [
        "1 ~safe_distance 85 % 3 of 4 bad missions have a value that no good mission of the robot"
        " has: 0.3 0.3 (3), 0.8 (1) 0.8 (9) 0.02 0.4 r1, r2 src/guard.cpp:12 /guard"
    ]
    methods = lines[lines.index("Methods side by side") :]
    assert " ".join(methods[2].split()) == "~safe_distance 1 0.4 1 75 % 1.5"
    assert "robots without a good mission: r7" in lines


MIXED = replace(
    ranking(suspect(1, "~a", 0.5), suspect(2, "~b", 0.4)),
    causes=(
        FleetCause("~b", 0.992, 3, ("r1", "r2")),
        FleetCause("~a", 0.85, 1, tuple(f"r{n}" for n in range(20))),
    ),
)


def test_several_causes_are_told_in_every_output() -> None:
    lines = [" ".join(line.split()) for line in printed(print_ranking, MIXED).splitlines()]
    assert lines[1] == "blame ~b, 99 %, for 3 of 4 bad missions; ~a, 85 %, for 1"
    table = lines[lines.index("Causes") :]
    assert table[2:4] == ["~b 99 % 3 r1, r2", "~a 85 % 1 r0, r1, r2, r3 and 16 more"]
    document = ranking_json(MIXED)
    assert document["accused"] == "~b"
    assert document["causes"][0] == {
        "parameter": "~b", "probability": 0.992, "bad": 3, "robots": ["r1", "r2"],
    }  # fmt: skip
    metadata = json.loads(ranking_table(MIXED).schema.metadata[METADATA])
    assert [one["bad"] for one in metadata["causes"]] == [3, 1]
    words = Page(ranking_page(MIXED, "A fleet")).words
    assert "Causes ParameterProbabilityBad missionsRobots ~b 99 % 3 r1, r2" in words
    assert "and 8 more" in words


def test_the_only_cause_need_not_be_the_likeliest_single_suspect() -> None:
    """Every output blames the same parameter."""
    found = replace(
        ranking(suspect(1, "~a", 0.85), suspect(2, "~b", 0.1)),
        causes=(FleetCause("~b", 0.9, 3, ("r1",)),),
    )
    assert (found.accused, found.is_mixed) == ("~b", True)
    assert found.text == "blame ~b, 90 %, for 3 of 4 bad missions"


def test_one_cause_has_no_table_of_its_own() -> None:
    one = replace(BLAMED, causes=(FleetCause("~safe_distance", 0.9, 3, ("r1",)),))
    assert "Causes" not in printed(print_ranking, one)
    assert "Causes" not in Page(ranking_page(one, "A fleet")).words


def test_a_ranking_shows_what_importance_puts_first_however_far_it_is() -> None:
    found = ranking(
        suspect(1, "~a", 0.5, importance_position=2),
        suspect(2, "~b", 0.2, importance_position=3),
        suspect(3, "~c", 0.1, importance_position=1),
    )
    text = printed(print_ranking, found, 1)
    assert "and 2 more: --top shows more" in text
    assert "~b" not in text
    assert line_of(text, "~c").startswith("~c 3 0.4 1")


def test_ties_and_what_is_unknown() -> None:
    text = printed(print_ranking, ranking(suspect(1, "~a", 0.3, tied=True), uncompared(2, "~b")))
    rows = [" ".join(line.split()) for line in text.splitlines()]
    assert any(row.startswith("1= ~a 30 %") for row in rows)
    assert "2 ~b 1 % no comparison reports it" in rows
    assert "~b 2" in rows


def test_drifts_by_the_day_of_turning() -> None:
    text = printed(print_drifts, drifts(drift(), rising()))
    assert text.startswith(
        "2 of 40 tested margins drift; the first to turn: ~safe_distance on r1, 2026-11-20"
        " (2026-11-16 to 2026-11-27)"
    )
    assert line_of(text, "~battery").startswith("~battery all robots least 0.2 +0.5 10 2026-11-01")
    # 40 tests, each with a chance of 0.001.
    assert "about 0.04 of 40 would still look like this" in text
    assert "not judged: 3 with fewer than 5 days" in text


def test_what_may_be_by_chance_is_not_the_first_to_turn() -> None:
    early = drift("~early", turns_on="2026-11-12", is_clear=False)
    text = printed(print_drifts, drifts(early, drift("~late"))).splitlines()[0]
    assert "2 of 40 tested margins drift, 1 clearly; the first to turn: ~late on r1" in text
    alone = printed(print_drifts, drifts(early)).splitlines()[0]
    assert "1 of 40 tested margins drifts, none clearly; the first to turn: ~early" in alone


@pytest.mark.parametrize(
    ("earliest", "latest", "wanted"),
    [
        (None, None, "2026-11-20 least"),
        ("2026-11-16", None, "2026-11-20 2026-11-16 or later least"),
        (None, "2026-11-27", "2026-11-20 2026-11-27 or earlier least"),
    ],
)
def test_an_interval_with_open_ends(earliest, latest, wanted) -> None:
    text = printed(print_drifts, drifts(drift(earliest=earliest, latest=latest)))
    assert f"~safe_distance r1 {wanted}" in line_of(text, "src/guard.cpp")


def test_outliers_in_two_lists_and_the_robots_that_have_some() -> None:
    found = outliers((setting(),), (decision("r2"),), ("r9 has no sisters",))
    text = printed(print_outliers, found)
    assert text.startswith("2 of 3 robots differ from their sisters: 1 decision and 1 setting")
    rows = [" ".join(line.split()) for line in text.splitlines()]
    assert "r2 ~safe_distance turns a minute 4 0.5 8.25 <0.001 9 src/guard.cpp:12 /guard" in rows
    assert "r3 ~gain 2.5 1 100 % of 9" in rows
    assert {"r2 1 0", "r3 0 1", "r9 has no sisters"} <= set(rows)
    assert "r1" not in text


def test_found_missions_and_their_turns() -> None:
    text = printed(print_found, [(mission(), [turn(1.5)]), (mission("r2", is_bad=False), [])])
    rows = [" ".join(line.split()) for line in text.splitlines()]
    assert rows[0] == "2 missions of 2 robots, 1 bad"
    where = "~safe_distance (src/guard.cpp:12)"
    assert f"r1 2026-11-03 flight-1a2b bad 1 of 2 0.05 {where}" in rows
    assert f"r2 2026-11-03 flight-1a2b good 2 0.05 {where}" in rows
    at = "src/guard.cpp:12 /guard"
    assert f"r1 flight-1a2b 1.5 ~safe_distance true 0.75 0.8 0.05 {at}" in rows


EMPTY = (
    (print_ranking, ranking(), ranking_page, "no parameter is compared"),
    (print_drifts, drifts(), drifts_page, "none of 40 tested margins drift"),
    (print_outliers, outliers(), outliers_page, "none of 3 robots differs"),
    (print_found, [], found_page, "no mission fits"),
)


@pytest.mark.parametrize(("printer", "answer", "page", "says"), EMPTY)
def test_an_empty_answer_says_so(printer, answer, page, says) -> None:
    assert says in printed(printer, answer)
    text = Page(page(answer, "Fleet")).words
    assert says.lower() in text.lower()


def hostile() -> dict[str, object]:
    where = place(HOSTILE)._replace(place=HOSTILE, node=HOSTILE, key=HOSTILE)
    evil = suspect(
        1,
        HOSTILE,
        0.6,
        values=(value(HOSTILE, 2, 1, (HOSTILE,)),),
        shows=where,
        robots=(HOSTILE,),
        reason=HOSTILE,
        unit=HOSTILE,
    )
    turned = replace(turn(), parameter=HOSTILE, place=HOSTILE, node=HOSTILE, key=HOSTILE)
    found = replace(mission(HOSTILE, HOSTILE), where=(where,), day=HOSTILE)
    return {
        "ranking": ranking(evil, notes=(HOSTILE,)),
        "drifts": drifts(replace(drift(HOSTILE, HOSTILE), where=where)),
        "outliers": outliers(
            (replace(setting(HOSTILE, HOSTILE), value=HOSTILE, usual=HOSTILE),),
            (replace(decision(HOSTILE), where=where, measure=HOSTILE),),
            (HOSTILE,),
        ),
        "found": [(found, [turned])],
    }


def tame() -> dict[str, object]:
    """The same answers with harmless names."""
    evil = suspect(1, "~a", 0.6, values=(value("0.3", 2, 1, ("r1",)),), robots=("r1",))
    return {
        "ranking": ranking(evil, notes=("note",)),
        "drifts": drifts(drift()),
        "outliers": outliers((setting(),), (decision(),), ("note",)),
        "found": [(mission(), [turn()])],
    }


PRINTERS = {
    "ranking": print_ranking,
    "drifts": print_drifts,
    "outliers": print_outliers,
    "found": print_found,
}
PAGES = {
    "ranking": ranking_page,
    "drifts": drifts_page,
    "outliers": outliers_page,
    "found": found_page,
}


@pytest.mark.parametrize("kind", PRINTERS)
@pytest.mark.parametrize(("width", "is_terminal"), [(300, False), (70, True)])
def test_no_name_steers_the_terminal(kind, width, is_terminal) -> None:
    text = printed(PRINTERS[kind], hostile()[kind], width=width, is_terminal=is_terminal)
    assert "onerror" in text
    assert not {"\x1b", "\u202e", "\ud800"} & set(text)


@pytest.mark.parametrize("kind", PAGES)
def test_no_name_becomes_markup(kind) -> None:
    page = PAGES[kind](hostile()[kind], HOSTILE)
    found, wanted = Page(page), Page(PAGES[kind](tame()[kind], "Fleet"))
    assert set(found.tags) - {"br", "wbr"} == set(wanted.tags) - {"br", "wbr"}
    assert "onerror" not in found.attributes
    assert "onerror=alert(1)>{{7*7}}\ufffd[31m\ufffd" in found.text
    assert not {"\x1b", "\u202e", "\ud800"} & set(page)
    for name in ("src", "href", "srcset", "action"):
        assert all(one.startswith("#") for one in found.attributes.get(name, []))


@pytest.mark.parametrize("kind", PAGES)
def test_a_page_asks_the_network_for_nothing_and_runs_only_its_own_scripts(kind) -> None:
    text = PAGES[kind](tame()[kind], "Fleet")
    policies = [one for one in Page(text).attributes["content"] if "script-src" in one]
    assert [one.count("sha256-") for one in policies] == [2]
    assert policies[0].startswith("default-src 'none'; ")
    without_namespaces = text.replace("http://www.w3.org/", "")
    assert not any(word in without_namespaces for word in ("http:", "https:", "url(//", "@import"))


def test_a_page_of_a_ranking() -> None:
    page = Page(ranking_page(BLAMED, "Fleet rovers"))
    assert "Blame ~safe_distance: 85 %; none of the parameters: 9 %." in page.words
    # The row of none of them is between those of 85 % and of 5 %.
    assert "1 ~safe_distance 85 % +0.5 +3.0 +1.0 -2.0 0.4 #1 75 % 1.5 none of the" in page.words
    assert "none of the parameters 9 % 2 ~gain 5 %" in page.words
    # The longest evidence is 3, so that half of the room is 3: 1 is 16.7 %, -2 is 33.3 % before.
    assert "left:50.0%;width:16.7%" in page.attributes["style"]
    assert "left:16.7%;width:33.3%" in page.attributes["style"]
    # 9 missions are the most; 3 are a third of them.
    assert "left:0.0%;width:33.3%" in page.attributes["style"]
    assert "No value of it is known." in page.words


def test_none_of_them_may_be_the_first_or_the_last() -> None:
    unsure = Page(ranking_page(ranking(suspect(1, "~a", 0.2)), "Fleet")).words
    assert "Alone none of the parameters 80 % 1 ~a 20 %" in unsure
    sure = Page(ranking_page(ranking(suspect(1, "~a", 0.7)), "Fleet")).words
    assert "1.5 none of the parameters 30 %" in sure


def test_evidence_of_nothing_has_no_sign() -> None:
    nothing = suspect(1, "~a", 0.5, evidence=FleetEvidence(0.0, -0.04, 0.0, 0.04))
    assert "50 % 0.0 0.0 0.0 0.0 0.4" in Page(ranking_page(ranking(nothing), "Fleet")).words


def test_a_page_of_many_suspects_stays_small() -> None:
    robots = tuple(f"robot_{n}" for n in range(500))
    values = tuple(value(str(n), 3, 2, robots) for n in range(12))
    name = "/a_rather_long_namespace/of_a_node/parameter"
    many = [
        suspect(n, f"{name}_{n}", 0.004, values=values, robots=robots, reason="x" * 5000)
        for n in range(1, 201)
    ]
    text = ranking_page(ranking(*many), "Fleet")
    assert len(text) < 600_000
    page = Page(text)
    assert page.tags["details"] == CARDS
    assert f"And {200 - ROWS} more" in page.words
    assert "robot_11 and 488 more" in page.words
    assert "robot_12" not in page.words


def test_charts_of_drifts() -> None:
    days = [f"2026-11-{n:02d}" for n in range(1, 11)]
    values = [0.38 - 0.02 * n for n in range(9)] + [math.nan]
    shown = drift(margins=tuple(map(DayMargin, days, values)))
    calls = []
    text = drifts_page(drifts(shown, rising()), "Fleet", lambda: calls.append(1))
    page = Page(text)
    assert len(calls) == page.tags["svg"] == 2
    label = "least margin of ~safe_distance, r1, 2026-11-01 to 2026-11-10, turns on 2026-11-20"
    assert page.attributes["aria-label"].count(label) == 1
    # The second has no days to show, and does not turn.
    assert page.words.count("margin of a day") == 1
    assert page.words.count("day of turning between") == 1
    assert "Not towards turning" in page.words


@pytest.mark.parametrize(
    "fields",
    [
        {"since": "long ago"},
        {"turns_on": "2999-01-01", "earliest": None, "latest": None},
        {"now": 1e300, "per_day": -1e299},
        {"now": math.nan},
        {"since": "2026-11-10"},
        {"turns_on": "2026-11-10"},
        {"since": "0001-01-01", "until": "9999-12-31", "turns_on": "9999-12-31"},
    ],
)
def test_odd_drifts_have_a_page(fields) -> None:
    fields = {"margins": (DayMargin("2026-11-09", 1.0),), **fields}
    text = drifts_page(drifts(drift(**fields)), "Fleet")
    assert Page(text).tags["svg"] == (fields.get("since") != "long ago")


def test_a_day_far_off_is_not_drawn() -> None:
    far = drift(turns_on="2031-01-01", earliest=None, latest=None)
    page = Page(drifts_page(drifts(far), "Fleet"))
    assert "Turns on 2031-01-01" in page.words
    assert "day of turning" not in page.words


def test_a_page_of_many_drifts_draws_the_first_ones() -> None:
    many = drifts(*(drift(f"~p{n}") for n in range(ROWS + 7)))
    page = Page(drifts_page(many, "Fleet"))
    assert page.tags["svg"] == CARDS
    assert "And 7 more" in page.words


def test_the_matrix_of_outliers() -> None:
    low = replace(decision("r2"), own=0.1)
    found = outliers((setting("r3", "~gain"), setting("r3", "~safe_distance")), (decision(), low))
    page = Page(outliers_page(found, "Fleet"))
    told = page.attributes["title"]
    # Robots in the order of the counts; the parameter with decisions first.
    assert told == [
        "~safe_distance",
        "~gain",
        "r2, ~safe_distance: turns a minute 0.1, usual 0.5",
        "r3, ~safe_distance: set to 2.5, usual 1; turns a minute 4, usual 0.5",
        "r3, ~gain: set to 2.5, usual 1",
    ]
    assert "Robot~safe_distance~gainr2▼r32.5▲2.5" in "".join(page.text.split())
    assert "Not shown here" not in page.words


def test_a_large_matrix_says_what_it_leaves_out() -> None:
    names = [f"/namespace_of_some_length/parameter_number_{n:02d}" for n in range(35)]
    found = outliers(tuple(setting(f"r{n}", name) for n in range(60) for name in names))
    text = outliers_page(found, "Fleet")
    page = Page(text)
    assert "Not shown here: 20 more robots, 5 more parameters." in page.words
    # The end of a name tells more than its namespaces; it is cut to 32 characters.
    assert "…some_length/parameter_number_00" in page.words
    assert f"And {60 * 35 - ROWS:,} more" in page.words
    assert len(text) < 500_000


def test_a_page_of_found_missions() -> None:
    page = Page(found_page([(mission(), [turn(), turn(4.0)]), (mission("r2", "m2"), [])], "Fleet"))
    assert page.tags["details"] == 1
    assert page.attributes["href"] == ["#m1"]
    assert "1.5 ~safe_distance true 0.75 0.8 0.05 src/guard.cpp:12 in /guard" in page.words


def test_a_page_is_written_atomically(tmp_path) -> None:
    file = tmp_path / "page.html"
    write_page(file, "caf\u00e9 \ud800")
    assert file.read_bytes() == "caf\u00e9 ?".encode()


def test_json_round_trip() -> None:
    document = json.loads(plain_json(ranking_json(BLAMED)))
    assert document["accused"] == "~safe_distance"
    assert document["none"] == pytest.approx(0.09)
    first, *_, last = document["suspects"]
    assert first["evidence"] == {"prior": -2.0, "diagnoses": 0.5, "values": 3.0, "behaviour": 1.0}
    assert first["values"][1] == {
        "text": "0.8",
        "number": 0.8,
        "bad": 1,
        "good": 9,
        "fresh": 0,
        "robots": ["r1", "r2", "r3"],
    }
    where = {"parameter": "~safe_distance", "node": "/guard", "place": "src/guard.cpp:12"}
    assert first["shows"] == {**where, "key": "key-~safe_distance"}
    assert last["shows"] is last["margin_bad"] is last["differs"] is None

    document = json.loads(plain_json(drifts_json(drifts(drift(now=math.inf), rising()))))
    assert document["by_chance"] == pytest.approx(0.04)
    assert [one["robot"] for one in document["drifts"]] == ["r1", None]
    assert [one["clear"] for one in document["drifts"]] == [True, True]
    assert document["drifts"][0]["now"] is None
    assert "is_clear" not in document["drifts"][0]
    assert document["drifts"][0]["where"]["place"] == "src/guard.cpp:12"

    document = json.loads(
        plain_json(outliers_json(outliers((setting(), setting(parameter="~b")), (decision(),))))
    )
    assert document["decisions"][0]["set_otherwise"] is False
    assert "is_set_otherwise" not in document["decisions"][0]
    assert document["settings"][0]["usual"] == "1"
    assert document["robots"][2] == {"robot": "r3", "decisions": 1, "settings": 2}

    (document,) = json.loads(plain_json(found_json([(mission(), [turn(2)])])))
    assert (document["bad"], document["least"]) == (True, 0.05)
    assert "is_bad" not in document
    assert document["turned"][0]["time_ns"] == START_NS + 2_000_000_000


@pytest.mark.parametrize("kind", PAGES)
def test_nothing_is_lost_in_json_and_all_of_it_is_ascii(kind) -> None:
    documents = {
        "ranking": ranking_json,
        "drifts": drifts_json,
        "outliers": outliers_json,
        "found": found_json,
    }
    text = plain_json(documents[kind](hostile()[kind]))
    assert text.isascii()
    assert json.dumps(HOSTILE) in text


TABLES = (
    (ranking_table, RANKING, "ranking", 1),
    (drifts_table, DRIFTS, "drifts", 1),
    (outliers_table, OUTLIERS, "outliers", 2),
    (found_table, FOUND, "found", 1),
)


@pytest.mark.parametrize(("table", "schema", "kind", "rows"), TABLES)
def test_parquet_has_the_same_schema_whatever_the_rows(table, schema, kind, rows, tmp_path) -> None:
    nothing = {"ranking": ranking(), "drifts": drifts(), "outliers": outliers(), "found": []}
    for answers, count in ((nothing, 0), (tame(), rows), (hostile(), rows)):
        file = tmp_path / "answer.parquet"
        write_table(table(answers[kind]), file)
        found = pq.read_table(file)
        assert found.schema.equals(schema)
        assert len(found) == count


def test_the_columns_of_a_ranking(tmp_path) -> None:
    file = tmp_path / "ranking.parquet"
    write_table(ranking_table(BLAMED), file)
    found = pq.read_table(file)
    first, *_, last = found.to_pylist()
    evidence = ("prior", "diagnoses", "from_values", "behaviour")
    assert [first[name] for name in evidence] == [-2.0, 0.5, 3.0, 1.0]
    assert [one["text"] for one in first["values"]] == ["0.3", "0.8"]
    assert (first["node"], first["place"]) == ("/guard", "src/guard.cpp:12")
    assert last["place"] is last["importance_position"] is last["mean_position"] is None
    about = json.loads(found.schema.metadata[METADATA])
    assert about["none"] == pytest.approx(0.09)
    assert about["accused"] == "~safe_distance"


def test_the_columns_of_outliers() -> None:
    one, other = outliers_table(outliers((setting(),), (decision(),))).to_pylist()
    assert (one["kind"], one["parameter"], one["own"], one["usual"]) == (
        "decision",
        "~safe_distance",
        4.0,
        0.5,
    )
    assert (other["kind"], other["value"], other["usual_value"]) == ("setting", "2.5", "1")
    assert other["usual"] is other["chance"] is other["place"] is None


def test_the_margins_of_the_days_are_in_json_and_parquet(tmp_path) -> None:
    found = drifts(drift(margins=(DayMargin("2026-11-01", 0.4), DayMargin("2026-11-02", 0.3))))
    days = [{"day": "2026-11-01", "margin": 0.4}, {"day": "2026-11-02", "margin": 0.3}]
    assert drifts_json(found)["drifts"][0]["margins"] == days
    write_table(drifts_table(found), tmp_path / "drifts.parquet")
    assert pq.read_table(tmp_path / "drifts.parquet")["margins"].to_pylist() == [days]


def test_numbers_that_are_none_are_null() -> None:
    (row,) = found_table([(mission(), [replace(turn(), value=math.nan, margin=None)])]).to_pylist()
    assert row["turned"][0]["value"] is row["turned"][0]["margin"] is None
