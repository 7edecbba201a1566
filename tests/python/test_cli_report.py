"""The command report: which page it writes of what, and what it says."""

from __future__ import annotations

import json
import re
import shutil
from dataclasses import replace

import pytest
from click.testing import CliRunner
from mission_samples import BagFile, SummaryBuilder, comparison, events, key, line, ns, static_info
from report_samples import Page

from pytpc.cli.main import main
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording, save_recording
from pytpc.recording.summaries import Summary
from pytpc.values.origins import ORIGINS_FILE, Origin, write_origins

ENOUGH = {"enough": True, "reason": ""}


@pytest.fixture
def files(tmp_path):
    """The folder of a mission with a mark of each type, and the static information.

    Mark 1 (15 s into it, type I): comparison 0 flopped a second before, 1 never: 0 is first.
    Mark 2 (19 s, type II): 1 is 0.2 of 0.3 from its limit, 0 is above it by 1 of 3 and flopped
    three times in the window: 1 is first.
    """
    folder = tmp_path / "night flight"
    folder.mkdir()
    with BagFile(folder / "mission.bag") as writer:
        for step in range(200):
            t = 1 + step / 10
            faces = t >= 15 or 13 <= t < 14
            writer.log(t, "/uav", line(0, int(faces), 4 if faces else 1, 3))
            writer.log(t, "/uav", line(1, 0, 0.5 if step % 2 else 0.3, 0.6))
        writer.mark(16, "/mark_action")
        writer.mark(20, "/mark_no_action")
    static = tmp_path / "static.json"
    faces = comparison(0, "~faces", ">=", default=3)
    static_info(faces, comparison(1, "~coverage")).save(static)
    return folder, static


def run(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def text_of(page):
    return " ".join("".join(Page(page.read_text()).text).split())


def mark(seconds, kind):
    """A mark as all commands print it; the recording begins at 1 s."""
    time_ns = round((seconds + 1) * 1e9)
    said = {"observer": "", "note": "", "where": [], "began": None}
    return {"time_ns": time_ns, "seconds": seconds, "type": kind, **said}


def test_a_page_is_written_of_a_folder(files, tmp_path):
    folder, static = files
    page = tmp_path / "r.html"
    result = run("report", folder, "--static", static, "-o", page, "--json")
    assert result.exit_code == 0
    said = json.loads(result.stdout)
    assert said["bytes"] == page.stat().st_size
    diagnosis = said["missions"][0].pop("diagnosis")
    assert diagnosis["suspects"][0]["parameter"] == "~faces"
    assert said["missions"] == [
        {
            "mission": "night flight",
            "name": "night flight",
            "marks": [
                {**mark(15.0, "I"), "first": "~faces", **ENOUGH},
                {**mark(19.0, "II"), "first": "~coverage", **ENOUGH},
            ],
        }
    ]
    assert "night flight" in text_of(page)


def test_the_page_of_one_folder_is_in_it_and_others_are_here(files, tmp_path, monkeypatch):
    folder, static = files
    monkeypatch.chdir(tmp_path)
    assert run("report", folder, "--static", static).exit_code == 0
    assert (folder / "report.html").is_file()
    assert not (tmp_path / "report.html").exists()
    assert run("report", folder / "mission.bag", "--static", static).exit_code == 0
    assert (tmp_path / "report.html").is_file()


def test_top_is_how_many_cards_a_mark_has(files, tmp_path):
    folder, static = files
    cards = {}
    for top in (1, 2):
        page = tmp_path / f"{top}.html"
        assert run("report", folder, "--static", static, "-o", page, "--top", top).exit_code == 0
        cards[top] = [
            name for name in Page(page.read_text()).ids if re.fullmatch("m1-2-[0-9]+", name)
        ]
    assert (sorted(cards[1]), sorted(cards[2])) == (["m1-2-1"], ["m1-2-1", "m1-2-2"])
    assert run("report", folder, "--static", static, "--top", 0).exit_code == 2


def test_what_was_done_to_the_robot_and_where_values_came_from(files, tmp_path):
    folder, static = files
    document = {
        "name": "low",
        "type": "type2",
        "parameter": "~coverage",
        "node": "/uav",
        "old": 0.4,
        "new": 0.6,
        "launch": {},
        "effect": "It <never> takes off.",
    }
    (folder / "treatment.json").write_text(json.dumps(document))
    (folder / "params.yaml").write_text("{}\n")
    origin = Origin("/uav/coverage", "yaml", 0.6, tmp_path / "c" / "p.yaml", 4, "coverage: 0.6")
    write_origins({}, {origin.name: origin}, folder / ORIGINS_FILE)
    page = tmp_path / "r.html"
    arguments = ("report", folder, "--static", static, "-o", page)
    assert run(*arguments).exit_code == 0
    # What only a study knows is not on a user's page.
    text = text_of(page)
    assert "takes off" not in text
    assert "changed" not in page.read_text().partition("<main>")[2].partition("Each mark")[0]
    assert run(*arguments, "--with-treatment").exit_code == 0
    text = text_of(page)
    assert "night flight It <never> takes off." in text
    assert "The changed parameter's position: 1." in text
    assert f"Value set in{tmp_path}/c/p.yaml:4coverage: 0.6" in text
    # Nobody set the other one.
    assert "Value set indefault in the code" in text


@pytest.mark.parametrize(
    "document", [[], {"effect": "It lands."}, {"effect": 3, "parameter": None}]
)
def test_a_broken_treatment_is_named(files, tmp_path, document):
    folder, static = files
    path = folder / "treatment.json"
    path.write_text(json.dumps(document))
    arguments = ("report", folder, "--static", static, "-o", tmp_path / "r.html")
    assert run(*arguments).exit_code == 0
    result = run(*arguments, "--with-treatment")
    assert result.exit_code == 1
    assert f"{path}: effect must be a text" in result.stderr


def test_types_and_window_are_those_of_rank(files, tmp_path):
    folder, static = files
    page = tmp_path / "r.html"
    arguments = ("report", folder, "--static", static, "-o", page, "--window", "2")
    assert run(*arguments, "--types", "ignore").exit_code == 0
    text = text_of(page)
    assert "2 s window" in text
    # At mark 1 both scores count, so that also what never flopped is ranked.
    assert text.count("2 of 2 parameters have a score.") == 2


def test_several_missions_have_a_table(files, tmp_path):
    folder, static = files
    other = tmp_path / "day"
    shutil.copytree(folder, other)
    page = tmp_path / "r.html"
    result = run("report", folder, other, "--static", static, "-o", page)
    assert result.stdout == f"2 missions with 4 marks: {page}\n"
    found = Page(page.read_text())
    assert {"overview", "m1", "m2"} <= set(found.ids)
    assert {"#m1", "#m2"} <= found.references


def test_without_marks_it_says_what_to_do(files, tmp_path):
    _, static = files
    bag = tmp_path / "calm.bag"
    with BagFile(bag) as writer:
        writer.log(1, "/uav", line(1, 0, 0.3, 0.6))
        writer.log(2, "/uav", line(1, 0, 0.3, 0.6))
    page = tmp_path / "r.html"
    assert run("report", bag, "--static", static, "-o", page).exit_code == 0
    assert "No marks, so no verdict." in text_of(page)
    assert f"Add marks with pytpc mark {bag}, and write this page again." in text_of(page)


def test_open_shows_the_page(files, tmp_path, monkeypatch):
    folder, static = files
    shown = []
    monkeypatch.setattr("webbrowser.open", lambda address: shown.append(address) or len(shown) == 1)
    page = tmp_path / "a page.html"
    arguments = ("report", folder, "--static", static, "-o", page, "--open")
    assert run(*arguments).exit_code == 0
    assert shown == [page.as_uri()]
    result = run(*arguments)
    assert result.exit_code == 1
    assert "a page.html: no browser was found" in result.stderr


def test_a_page_that_cannot_be_written_is_one_line(files, tmp_path):
    folder, static = files
    (tmp_path / "file").write_text("")
    result = run("report", folder, "--static", static, "-o", tmp_path / "file" / "r.html")
    assert result.exit_code == 1
    (said,) = [row for row in result.stderr.splitlines() if "error" in row]
    assert "cannot be written" in said


def test_another_build_is_told(files, tmp_path):
    folder, _ = files
    other = tmp_path / "other.json"
    static_info(replace(comparison(7, "x"), lineno=3)).save(other)
    result = run("report", folder, "--static", other, "-o", tmp_path / "r.html")
    assert result.exit_code == 1
    assert (
        "the static information knows none of its reports: it is of another build; give the one"
        " that was recorded, with --static WORKSPACE or --static FILE"
    ) in result.stderr
    assert not (tmp_path / "r.html").exists()


# Under `edges` a recorder that came late has summaries alone of what does not change.
def test_a_recording_of_summaries_alone(tmp_path):
    builder = SummaryBuilder()
    builder.add(
        Summary(
            key=key(0), node="/node", begin_ns=ns(2), end_ns=ns(3), count=2, flops=0, far=2, odd=0,
            result=False, res=False, cmp=0.375, thresh=0.75, diff_min=-0.375, diff_max=-0.25,
            diff_mean=-0.3125, abs_mean=0.3125, low=0.375, high=0.75,
        )
    )  # fmt: skip
    marks = (Mark(ns(4), "II"),)
    recording = Recording("late", events([]), marks, 0, ns(5), summaries=builder.build())
    save_recording(recording, tmp_path / "late")
    static_info(comparison(0, "limit")).save(tmp_path / "static.json")
    static_info(comparison(1, "limit")).save(tmp_path / "other.json")
    page = tmp_path / "r.html"
    result = run("report", tmp_path / "late", "--static", tmp_path / "static.json", "-o", page)
    assert result.exit_code == 0, result.output
    # 0.5 is the nearest to 0.75.
    assert "Any value below 0.5 would do" in text_of(page)
    result = run("report", tmp_path / "late", "--static", tmp_path / "other.json", "-o", page)
    assert result.exit_code == 1
    assert (
        "the static information knows none of its reports: it is of another build" in result.output
    )
