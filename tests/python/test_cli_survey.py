"""The command ``pytpc survey``, as a user meets it; the builds are in tests/ros."""

import json
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from survey_samples import BAD, build, found, result

from pytpc.cli.main import main
from pytpc_evaluation.commands import survey_commands
from pytpc_evaluation.survey.surveying import Options, SurveyProgress
from pytpc_evaluation.survey.trees import TreeResult

RESULTS = [result("arm", 10.0, 12.5, found=found(4)), result("leg", 4.0, build(5.0, BAD))]


def run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(main, ["survey", *(str(argument) for argument in arguments)])


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[Options]:
    """The options of the surveys that were asked for; each has RESULTS."""
    options: list[Options] = []

    def survey(
        folders: Sequence[Path], given: Options, on_step: Callable[[SurveyProgress], None]
    ) -> list[TreeResult]:
        options.append(given)
        for what, line in (("building with TPC", ""), ("building with TPC", "Starting >>> a")):
            on_step(SurveyProgress(folders[0].name, 1, 2, what, line))
        return RESULTS

    monkeypatch.setattr(survey_commands, "survey", survey)
    return options


def test_tables_are_written_and_shown(tmp_path: Path, asked: list[Options]) -> None:
    output = tmp_path / "out"
    result = run(tmp_path, "-o", output)
    assert result.exit_code == 0
    assert "Comparisons with parameters" in result.stdout
    assert sorted(path.name for path in output.iterdir()) == [
        "comparisons.csv",
        "faults.csv",
        "lines.csv",
        "survey.md",
        "survey.tex",
        "times.csv",
    ]
    assert result.stderr.splitlines() == [
        f"[0 s] 1/2 {tmp_path.name}: building with TPC",
        f"pytpc: warning: leg: bad not built with TPC: {BAD.reason}",
        "pytpc: warning: leg: no factor: the two builds did not build the same packages",
    ]


def test_json(tmp_path: Path, asked: list[Options]) -> None:
    result = run(tmp_path, "-o", tmp_path / "out", "--json", "--format", "markdown")
    data = json.loads(result.stdout)
    assert [(tree["name"], tree["processor_factor"]) for tree in data] == [
        ("arm", 1.25),
        ("leg", None),
    ]
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["survey.md"]


def test_options(tmp_path: Path, asked: list[Options]) -> None:
    setup = tmp_path / "setup.bash"
    more = ("--jobs", "3", "--underlay", setup, "--no-plain", "--rerun", "--cmake-arg", "-DX=1")
    assert run(tmp_path, "-o", tmp_path / "out", *more).exit_code == 0
    assert asked == [Options(tmp_path / "out", 3, (setup,), ("-DX=1",), plain=False, rerun=True)]


def test_an_unknown_format_is_refused(tmp_path: Path, asked: list[Options]) -> None:
    result = run(tmp_path, "--format", "csv,word")
    assert (result.exit_code, asked) == (2, [])
    assert "'word' is none of csv, markdown, latex" in result.stderr


def test_a_folder_that_is_not_there(tmp_path: Path, asked: list[Options]) -> None:
    result = run(tmp_path, tmp_path / "x")
    assert (result.exit_code, asked) == (1, [])
    assert result.stderr == f"pytpc: error: {tmp_path / 'x'}: no such folder\n"
