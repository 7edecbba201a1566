"""Mistakes that people make, each with its status and the one line that is printed.

The line says which file or word is wrong, what is wrong with it, and what to type next. A usage
error has click's two lines of usage before it.
"""

# ruff: noqa: E501 (the lines are shown as they are printed)
from __future__ import annotations

import json
import shlex
import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner
from mission_samples import BagFile, comparison, line, static_info

from pytpc.cli.main import main

EXAMPLE = Path(__file__).parents[2] / "examples/recorded_mission"
NO_MASTER = (
    "the ROS master at http://127.0.0.1:9 does not answer ({}: Connection refused); is roscore"
    " running, and is ROS_MASTER_URI right?"
)
GIVE = "give it with --static WORKSPACE, the one that `pytpc build` built"

# What is typed; the status; the line, with ``pytpc: error: `` (status 1) or ``Error: `` (2) left out.
MISTAKES = [
    # Commands, options and their values.
    ("rnk today", 2, "no command 'rnk'; did you mean rank?"),
    ("ingest today", 2, "ingest is now called convert: pytpc convert"),
    ("rank", 2, "Missing argument 'RECORDING...'."),
    ("rank today --statc ws", 2, "No such option '--statc'. (Did you mean one of: '--at', '--each', '--static'?)"),
    ("rank today --top 0", 2, "Invalid value for '--top': 0 is not in the range x>=1."),
    ("marks today --add 5 III", 2, "Invalid value for '--add': 'III' is not one of 'I', 'II', 'none'."),
    ("marks today --remove 99", 2, "Invalid value for --remove: there are 5 marks; `pytpc marks today` lists them"),
    ("suggest today limit --value fast", 2, "Invalid value for --value: 'fast' is not a number, true or false"),
    ("suggest today --value 3", 2, "--value needs a PARAMETER"),
    ("record ws -o out", 2, "give both WORKSPACE and LAUNCH (a file, or PACKAGE and FILE); for a robot that runs already: pytpc record --static WORKSPACE"),
    ("record -o today", 1, "today: already has a recording; give another folder"),
    (
        "export today/static.json",
        2,
        "give --sarif FILE, --html FILE or both; for a recording --mcap, --foxglove, --plotjuggler,"
        " --rerun, --csv or --parquet",
    ),
    ("apply p.yaml limit", 2, "give TARGET PARAMETER VALUE, or --live PARAMETER VALUE"),
    ("apply p.yaml limit 1 rate=3", 2, "'rate=3' is not NAME:=VALUE"),
    # Recordings.
    ("rank toda", 1, "toda: no such bag, file or folder; did you mean today?"),
    ("rank nowhere/mission.bag", 1, "nowhere/mission.bag: no such bag, file or folder; there is no folder nowhere"),
    ("report ws", 1, "ws: no recordings in this folder; give a bag, or a folder that `pytpc record` wrote"),
    ("rank empty.bag", 1, "empty.bag: the file is empty: nothing was recorded, or nothing copied"),
    ("rank notes.txt", 1, "notes.txt: no threshold reports: was /rosout recorded, and the workspace built with TPC? Files of the sink `file` belong in the same folder, or in its folder tpc"),
    ("rank unmarked.bag", 1, "unmarked.bag: no marks: add some with `pytpc mark unmarked.bag`, or give a time with --at"),
    ("suggest unmarked.bag", 1, "unmarked.bag: no marks: add some with `pytpc mark unmarked.bag`, or ask for a --value"),
    ("rank today --reference today", 1, "today: has the same reports as the mission today itself; give a recording of a good run"),
    # Static information.
    ("rank unknown.bag", 1, f"unknown.bag: no static information in its folder, above it, in this folder, or in a sourced workspace; {GIVE}"),
    ("watch --once", 1, f"no static information in this folder, or in a sourced workspace; {GIVE}"),
    ("rank today --static gone", 1, "gone: no such file or folder; give a built workspace or a static.json"),
    ("rank today --static ws", 1, "ws: no static information here; run `pytpc build ws`"),
    ("rank today --static other.json", 1, "today: the static information knows none of its reports: it is of another build; give the one that was recorded, with --static WORKSPACE or --static FILE"),
    ("list old.json", 1, "old.json: /schema: written by an older TPC (format 0; this one reads 1); rebuild the workspace with `pytpc build`"),
    ("coverage list.json", 1, 'list.json: /: not merged static information, "units" is missing; give the static.json that `pytpc build` or `pytpc collect` wrote'),
    ("list ws", 1, "ws: no static information here; run `pytpc build ws`"),
    # Names.
    ("suggest today min_coverge_limit", 1, "no comparison with a parameter min_coverge_limit is known; did you mean ~min_coverage_limit or ~max_coverage_limit?"),
    ("show today/static.json min_coverge_limit", 1, "no parameter, key or FILE:LINE 'min_coverge_limit' in this static information; did you mean ~min_coverage_limit or ~max_coverage_limit?"),
    ("list today/static.json --parameter min_coverge_limit", 1, "no comparison with a parameter min_coverge_limit in this static information; did you mean ~min_coverage_limit or ~max_coverage_limit?"),
    ("explain today/static.json face_traker.cpp:3", 1, "nothing was found in a file face_traker.cpp; did you mean src/mission/face_tracker.cpp?"),
    # Values.
    ("apply p.yaml limi 0.4", 1, "p.yaml: limi is not in the file; did you mean mission/limit?"),
    ("apply p.yaml limit fast", 1, "p.yaml: the parameter is a number and 'fast' is not; --force changes its type"),
    ("apply robot/p.yaml limit 9", 1, "{here}/robot/p.yaml:1: 9 is outside of what {here}/robot/R.cfg:3 declares for limit: 0 to 1; --force writes it all the same"),
    ("apply pp.yaml limit 1", 1, "pp.yaml: no such file; did you mean p.yaml?"),
    ("apply today min_coverage_limit 0.04", 1, "today: no origins.json: the origins of its values were not recorded; give the launch file, or record with `pytpc record`"),
    ("apply --undo", 1, "no change is recorded: nothing to undo"),
    # Workspaces and graphs.
    ("build w", 1, "w: no such folder; did you mean ws?"),
    ("build notes.txt", 1, "notes.txt: not a folder"),
    ("build ws", 1, "ws: no packages here: no package.xml in this folder or below; give the one with src"),
    ("record ws robot.launch -o out", 1, "{here}/ws/.tpc/install: no setup.bash here; build the workspace first, with `pytpc build`"),
    ("sink", 1, NO_MASTER.format("getSystemState")),
]  # fmt: skip


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a marked mission, one without marks, a workspace without sources, and so on."""
    here = tmp_path_factory.mktemp("mistakes") / "here"
    shutil.copytree(EXAMPLE, here / "today")
    for folder in ("ws/src", "robot"):
        (here / folder).mkdir(parents=True)
    for name, text in {
        "empty.bag": "",
        "notes.txt": "nothing\n",
        "p.yaml": "mission:\n  limit: 0.5\n",
        "old.json": '{"schema": 0, "units": []}',
        "list.json": "[]",
        "robot/package.xml": "<package/>",
        "robot/p.yaml": "limit: 0.5\n",
        "robot/R.cfg": "from d import *\ngen = ParameterGenerator()\n"
        'gen.add("limit", double_t, 0, "", 0.5, 0, 1)\n',
    }.items():
        (here / name).write_text(text)
    static_info(comparison(7, "limit")).save(here / "other.json")
    for name in ("unmarked.bag", "unknown.bag"):
        with BagFile(here / name) as bag:
            bag.log(100, "/node", line(0, 1, 5, 4))
            bag.log(104, "/node", line(0, 0, 3, 4))
            if name == "unknown.bag":
                bag.mark(105, "/mark_action")
    return here


@pytest.mark.parametrize(("typed", "status", "said"), MISTAKES, ids=[row[0] for row in MISTAKES])
def test_mistakes(
    typed: str, status: int, said: str, place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(place)
    monkeypatch.setenv("ROS_MASTER_URI", "http://127.0.0.1:9")
    monkeypatch.setenv("XDG_STATE_HOME", str(place.parent / "state"))
    for name in ("CMAKE_PREFIX_PATH", "AMENT_PREFIX_PATH", "ROS_PACKAGE_PATH", "TPC_STATIC"):
        monkeypatch.delenv(name, raising=False)
    before = sorted(place.rglob("*"))
    result = CliRunner().invoke(main, shlex.split(typed))
    begin = "Error: " if status == 2 else "pytpc: error: "
    assert result.stderr.splitlines()[-1] == begin + said.replace("{here}", str(place))
    assert (result.exit_code, result.stdout) == (status, "")
    # Nothing was written.
    assert sorted(place.rglob("*")) == before


def test_there_are_enough() -> None:
    assert len({typed for typed, _, _ in MISTAKES}) == len(MISTAKES) >= 30
    assert json.loads((EXAMPLE / "static.json").read_text())["schema"] == 1
