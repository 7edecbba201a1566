"""Which methods rank which missions again, and what the table of positions says."""

from __future__ import annotations

import re
import shutil
from collections import Counter
from dataclasses import asdict
from datetime import datetime, timedelta
from multiprocessing import active_children
from pathlib import Path

import pytest
from click.testing import CliRunner
from study_samples import write_rows, write_said

from pytpc.base.errors import InputError, RunError
from pytpc.cli.main import main
from pytpc_evaluation.study import verdict_digest
from pytpc_evaluation.study.case import Verdict
from pytpc_evaluation.study.judge import POSITIONS_FILE, judge
from pytpc_evaluation.study.methods import METHODS
from pytpc_evaluation.study.report import judging
from pytpc_evaluation.study.report.judged import JUDGED_FILE, load_judgings, told_judgings
from pytpc_evaluation.study.report.judging import by_own_marks
from pytpc_evaluation.study.report.making import ReportOptions, make_report
from pytpc_evaluation.study.report.positions import Position, read_positions
from pytpc_evaluation.study.resume import alone_with_results
from pytpc_evaluation.study.verdict_digest import method_digest, modules_used

TUNING = {("type1_low", 1), ("type1_low", 2), ("fault_wires", 1), ("clean", 1)}


def rows_in(study: Path) -> list[Position]:
    return read_positions(study / POSITIONS_FILE)


def contents(study: Path) -> bytes:
    return (study / POSITIONS_FILE).read_bytes()


@pytest.fixture(scope="module")
def ranked(study, tmp_path_factory) -> Path:
    """The small study whose tuning half is ranked."""
    folder = Path(shutil.copytree(study, tmp_path_factory.mktemp("ranked") / "study"))
    by_own_marks().complete(folder, ["tuning"])
    return folder


@pytest.fixture
def own(ranked, tmp_path) -> Path:
    return Path(shutil.copytree(ranked, tmp_path / "own"))


@pytest.fixture
def asked(monkeypatch) -> list[tuple[str, int, tuple[str, ...]]]:
    """Each mission that is judged in this process, and by which methods."""
    found = []

    def spy(mission, methods):
        found.append((mission.treatment, mission.seed, tuple(methods)))
        return judge(mission, methods)

    monkeypatch.setattr(judging, "judge", spy)
    return found


# Two users and both together, three labels, all methods; a mission without a mark has no users. The
# error is of type I: ~low alone has flopped, so whoever believes that it is puts it first.
def test_every_method_ranks_the_wanted_half(ranked, study):
    rows = rows_in(ranked)
    tuning = [row for row in rows if row.half == "tuning"]
    counts = Counter((row.treatment, row.seed) for row in tuning)
    sets = {("type1_low", 1): 3, ("type1_low", 2): 1, ("fault_wires", 1): 2, ("clean", 1): 2}
    assert counts == {place: 3 * len(METHODS) * count for place, count in sets.items()}
    (found,) = [
        row
        for row in tuning
        if (row.treatment, row.seed, row.method, row.labels, row.who)
        == ("type1_low", 1, "thesis", "typed", "all")
    ]
    assert (found.position, found.parameters, found.marks) == (1.0, 4, 2)
    others = {row for row in rows_in(study) if row.half == "held-back"}
    assert {row for row in rows if row.half == "held-back"} == others


def test_only_what_is_missing_is_ranked(own, asked):
    before = contents(own)
    gone = [row for row in rows_in(own) if row.treatment == "clean" and row.method == "thesis"]
    gone += [row for row in rows_in(own) if row.treatment == "fault_wires"]
    rest = [asdict(row) for row in rows_in(own) if row not in gone]
    write_rows(own / POSITIONS_FILE, rest)
    by_own_marks().complete(own, ["tuning"])
    assert asked == [("clean", 1, ("thesis",)), ("fault_wires", 1, tuple(METHODS))]
    assert contents(own) == before
    by_own_marks().complete(own, ["tuning"])
    assert len(asked) == 2


def test_again_ranks_all_of_the_half(own, asked):
    before = contents(own)
    by_own_marks().complete(own, ["tuning"], again=True)
    assert {(name, seed) for name, seed, _ in asked} == TUNING
    assert contents(own) == before


# Then user1 alone marked it. Two sets of marks, three labels.
def test_a_mission_that_was_marked_anew_is_ranked_again(own, asked):
    before = rows_in(own)
    write_said(own / "missions/alpha/type1_low/seed-1", [(7, "user1", "I", "I")])
    by_own_marks().complete(own, ["tuning"])
    assert asked == [("type1_low", 1, tuple(METHODS))]
    rows = [row for row in rows_in(own) if (row.treatment, row.seed) == ("type1_low", 1)]
    assert len(rows) == 2 * 3 * len(METHODS)
    assert {row.marks for row in rows} == {1}
    others = [row for row in before if (row.treatment, row.seed) != ("type1_low", 1)]
    assert [row for row in rows_in(own) if row not in rows] == others


def test_what_a_method_is_given_has_it_rank_again(own, asked):
    (own / "missions/alpha/clean/seed-1/changes.json").write_text("[]")
    by_own_marks().complete(own, ["tuning"])
    assert asked == [("clean", 1, tuple(METHODS))]


def test_a_method_that_has_changed_ranks_all_again_and_no_other_does(own, asked, monkeypatch):
    def changed(method):
        return "new code" if method is METHODS["random"] else method_digest(method)

    monkeypatch.setattr(judging, "method_digest", changed)
    by_own_marks().complete(own, ["tuning"])
    assert {(name, seed) for name, seed, _ in asked} == TUNING
    assert {methods for _, _, methods in asked} == {("random",)}


def test_methods_come_and_go(own, asked, monkeypatch):
    new = {"first": lambda case: Verdict(("~high",)), "thesis": METHODS["thesis"]}
    monkeypatch.setattr(judging, "METHODS", new)
    monkeypatch.setattr(judging, "method_digest", lambda of: method_digest(METHODS["thesis"]))
    by_own_marks().complete(own, ["tuning"])
    assert {methods for _, _, methods in asked} == {("first",)}
    tuning = [row for row in rows_in(own) if row.half == "tuning"]
    assert {row.method for row in tuning} == {"first", "thesis"}


def test_the_table_is_the_same_however_many_processes_rank(own):
    before = contents(own)
    by_own_marks().complete(own, ["tuning"], again=True, jobs=2)
    assert contents(own) == before


def test_an_interrupted_ranking_is_gone_on_with(own, monkeypatch, asked):
    before = contents(own)
    shutil.rmtree(own / "results")
    with monkeypatch.context() as patch:

        def interrupted(mission, methods):
            if mission.treatment == "type1_low":
                raise KeyboardInterrupt
            return judge(mission, methods)

        patch.setattr(judging, "judge", interrupted)
        with pytest.raises(KeyboardInterrupt):
            by_own_marks().complete(own, ["tuning"])
    assert {row.treatment for row in rows_in(own)} == {"clean", "fault_wires"}
    by_own_marks().complete(own, ["tuning"])
    assert {name for name, _, _ in asked} == {"type1_low"}
    assert len(contents(own)) < len(before)


def test_an_interruption_ends_all_processes_and_keeps_what_they_did(own):
    shutil.rmtree(own / "results")

    def interrupt(done, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        by_own_marks().complete(own, ["tuning"], interrupt, jobs=2)
    assert active_children() == []
    assert len({(row.treatment, row.seed) for row in rows_in(own)}) == 1


def test_a_broken_mission_does_not_keep_others_from_being_ranked(own):
    shutil.rmtree(own / "results")
    (own / "missions/alpha/clean/seed-1/marks.parquet").write_text("x")
    with pytest.raises(InputError, match=r"clean/seed-1/marks\.parquet: not a file of marks"):
        by_own_marks().complete(own, ["tuning"])
    assert {(row.treatment, row.seed) for row in rows_in(own)} == TUNING - {("clean", 1)}


def test_two_do_not_rank_at_once(own):
    with alone_with_results(own):
        by_own_marks().complete(own, ["tuning"])
        with pytest.raises(RunError, match="another command is at work on these results"):
            by_own_marks().complete(own, ["tuning"], again=True)


@pytest.mark.parametrize("words", [["report", "--again", "--docs", "x.md"], ["suggestions"]])
def test_commands_that_make_results_do_so_one_at_a_time(own, words, monkeypatch):
    monkeypatch.chdir(own)
    with alone_with_results(own):
        result = CliRunner().invoke(main, ["study", *words, "--out", str(own)])
    assert result.exit_code == 1
    said = result.stderr.splitlines()[-1]
    assert said == f"pytpc: error: {own}/results: another command is at work on these results"


# Between the look at the table and the lock another command has ranked all of it.
def test_what_another_one_has_ranked_meanwhile_is_kept(own, asked, monkeypatch):
    before = contents(own)
    shutil.rmtree(own / "results")
    lock = judging.alone_with_results

    def late(folder):
        (own / POSITIONS_FILE).parent.mkdir()
        (own / POSITIONS_FILE).write_bytes(before)
        return lock(folder)

    monkeypatch.setattr(judging, "alone_with_results", late)
    by_own_marks().complete(own, ["tuning"])
    assert asked == []
    assert contents(own) == before


# Four missions are held back; judged once, again by the same code, and by other code. The tuning
# half is not counted, nor is a page for which there was nothing to rank.
def test_each_judging_of_what_is_held_back_is_written_down(own, tmp_path, monkeypatch):
    by_own_marks().complete(own, ["tuning"], again=True)
    assert load_judgings(own) == []
    by_own_marks().complete(own, ["held-back"])
    by_own_marks().complete(own, ["held-back"])
    by_own_marks().complete(own, ["held-back", "tuning"], again=True)
    monkeypatch.setattr(judging, "method_digest", lambda of: f"new {method_digest(of)}")
    by_own_marks().complete(own, ["held-back"])
    found = load_judgings(own)
    assert [one.missions for one in found] == [4, 4, 4]
    assert found[0].digest == found[1].digest != found[2].digest
    times = [datetime.fromisoformat(one.time) for one in found]
    assert times == sorted(times)
    assert {time.utcoffset() for time in times} == {timedelta(0)}
    text = re.sub(
        r"\n +",
        " ",
        make_report(own, tmp_path / "study.md", ReportOptions(draw=False)).page.read_text(),
    )
    said = f"judged 3 times, from {found[0].time} to {found[2].time}, by 2 states of the methods."
    assert said in text.replace("\\", "")
    tuning = make_report(
        own, tmp_path / "study.md", ReportOptions(["tuning"], draw=False)
    ).page.read_text()
    assert "was judged 3 times" not in tuning


def test_an_interrupted_judging_counts(own):
    def interrupt(done, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        by_own_marks().complete(own, ["held-back"], interrupt)
    (found,) = load_judgings(own)
    assert found.missions == 1
    assert told_judgings([found]).endswith(
        f"judged once, on {found.time}, by one state of the methods."
    )


def test_judgings_that_cannot_be_read_are_said(own, tmp_path):
    (own / JUDGED_FILE).write_text('[{"time": 1}]')
    made = make_report(own, tmp_path / "study.md", ReportOptions(draw=False))
    assert any(one.startswith("judged.json is left out: not a list") for one in made.troubles)


@pytest.fixture
def package(tmp_path, monkeypatch):
    """Sources of a package ``pytpc`` of its own, by module, in place of ours."""
    folder = tmp_path / "pytpc"

    def write(**modules: str) -> None:
        for name, text in modules.items():
            path = folder.joinpath(*name.split("__")).with_suffix(".py")
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        verdict_digest._code_digest.cache_clear()

    monkeypatch.setattr(verdict_digest, "_PACKAGES", {"pytpc": folder})
    monkeypatch.setattr(verdict_digest, "_JUDGES", ())
    yield write
    verdict_digest._code_digest.cache_clear()


def digest_of(module: str) -> str:
    def method(case):
        return Verdict(())

    method.__module__ = module
    return method_digest(method)


def test_the_code_of_a_method_is_all_that_it_imports(package):
    package(
        a="import json\nfrom pytpc.b import one\n",
        b="from pytpc import c\none = 1\n",
        c="import pytpc.d.e\n",
        d__e="two = 2\n",
        other="import pytpc.a\n",
    )
    assert modules_used("pytpc.a") == {"pytpc.a", "pytpc.b", "pytpc.c", "pytpc.d.e"}
    before = digest_of("pytpc.a")
    package(other="import pytpc.a\nthree = 3\n")
    assert digest_of("pytpc.a") == before
    package(d__e="two = 3\n")
    assert digest_of("pytpc.a") != before


def test_what_is_said_about_code_is_no_code(package):
    package(a='"""Text."""\ndef f():\n    return "x"\n')
    before = digest_of("pytpc.a")
    package(a='"""A better one."""\n\n\ndef f():  # comment\n    """And this."""\n    return "x"\n')
    assert digest_of("pytpc.a") == before
    package(a='"""Text."""\ndef f():\n    return "y"\n')
    assert digest_of("pytpc.a") != before


def test_the_rankings_of_users_are_the_code_of_the_methods():
    assert "pytpc.diagnosis.ranking.other_values" in modules_used(METHODS["tpc"].__module__)
    assert "pytpc.diagnosis.ranking.mark_ranking" in modules_used(METHODS["thesis"].__module__)
    assert not any(
        name.startswith("pytpc.cli") for name in modules_used("pytpc_evaluation.study.case")
    )


def test_what_cannot_be_ranked_is_said(own_study, tmp_path):
    shutil.rmtree(own_study / "results")
    (own_study / "missions/alpha/type1_low/seed-1/marks.parquet").write_text("x")
    made = make_report(
        own_study, tmp_path / "study.md", ReportOptions(["tuning"], rank="missing", draw=False)
    )
    said = "Not all missions are ranked: missions/alpha/type1_low/seed-1/marks.parquet: not a file"
    assert any(trouble.startswith(said) for trouble in made.troubles), made.troubles


def test_positions_without_a_number_have_none(tmp_path):
    path = tmp_path / "p.parquet"
    names = ("system", "treatment", "type", "half", "labels", "who", "method", "top")
    row = {**dict.fromkeys(names, "x"), "seed": 1, "parameters": 5, "marks": 0}
    write_rows(path, [{**row, "position": float("nan"), "confidence": float("nan")}])
    (found,) = read_positions(path)
    assert (found.position, found.confidence, found.place, found.within(5)) == (
        None,
        None,
        3,
        False,
    )
    # The middle one of five: 1 - 2/5.
    assert found.rank == pytest.approx(0.6)
