"""``pytpc fix --command``: a simulator flies each change, and its marks decide."""

from __future__ import annotations

import json
import os
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from fix_samples import PARAMS, begun, file_of, fix, recorded, robot_environment, state

from terminals import pytpc

FASTER = PARAMS.replace("max_speed: 1.0 ", "max_speed: 4.0 ")

# It has the error as long as the speed is limited below the peaks, and writes what it was told.
SIMULATOR = """
import os, re, sys
from pathlib import Path
sys.path.insert(0, {tests!r})
from fix_samples import file_of, recorded
robot = Path({robot!r})
found = re.findall(r"max_(\\w+): ([0-9.]+)", file_of(robot))
limit = {{name: float(value) for name, value in found}}
mission, number = Path(os.environ["TPC_FIX_MISSION"]), int(os.environ["TPC_FIX_TRY"])
with (robot / "told.txt").open("a") as told:
    print(number, mission.name, limit["speed"], limit["tilt"], file=told)
marks = (20, 50, 80, 110) if limit["speed"] < 1.6 else ()
values = {{"speed": limit["speed"], "tilt": limit["tilt"]}}
recorded(robot, mission.name, **values, marks=marks, at=5000 + number)
print("a line of the simulator")
"""


@pytest.fixture
def robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    return robot_environment(tmp_path, monkeypatch)


@pytest.fixture
def simulator(robot: Path) -> str:
    script = robot / "simulator.py"
    tests = str(Path(__file__).parent)
    script.write_text(SIMULATOR.format(tests=tests, robot=str(robot)))
    return shlex.join([sys.executable, str(script)])


def error_of(result) -> str:
    (line,) = [one for one in result.stderr.splitlines() if one.startswith("pytpc: error: ")]
    return line


def test_it_flies_until_the_robot_is_right(robot, simulator):
    shown = begun("--command", simulator).stdout
    assert "today: fixed" in shown
    first, second = state()["tries"]
    assert (first["parameter"], first["verdict"]) == ("~max_tilt", "same")
    assert (second["parameter"], second["verdict"]) == ("~max_speed", "fixed")
    assert file_of(robot) == FASTER


def test_the_command_is_told_the_number_and_the_folder(robot, simulator):
    begun("--command", simulator)
    told = (robot / "told.txt").read_text()
    assert told == "1 fix-try-1 1.0 4.0\n2 fix-try-2 4.0 2.0\n"
    assert [one["mission"] for one in state()["tries"]] == [
        str(robot / "fix-try-1"),
        str(robot / "fix-try-2"),
    ]


def test_its_output_does_not_mix_with_json(robot, simulator, capfd):
    answer = json.loads(begun("--command", simulator, "--json").stdout)
    assert (answer["state"], len(answer["tries"])) == ("fixed", 2)
    assert "a line of the simulator" in capfd.readouterr().err


def test_it_ends_when_the_tries_are_used_up(robot, simulator):
    shown = begun("--command", simulator, "--tries", 1).stdout
    assert "not fixed: 1 try is used up" in shown
    assert (state()["state"], file_of(robot)) == ("exhausted", PARAMS)


def test_a_folder_that_is_there_is_left_alone(robot, simulator):
    (robot / "fix-try-1").mkdir()
    begun("--command", simulator, "--tries", 1)
    assert state()["tries"][0]["mission"] == str(robot / "fix-try-1-2")


@pytest.mark.parametrize(
    ("command", "timeout", "why"),
    [
        ("exit 3", (), "the command of try 1 ended with status 3"),
        ("true", (), "the command of try 1 recorded nothing; it must record into $TPC_FIX_MISSION"),
        ("sleep 60", ("--timeout", 0.2), "the command of try 1 took longer than 0.2 s"),
    ],
)
def test_a_command_that_fails_leaves_the_try_open(robot, command, timeout, why):
    line = error_of(begun("--command", command, *timeout, status=1))
    assert why in line
    assert "take the value back with `pytpc fix --undo`" in line
    (one,) = state()["tries"]
    assert (one["verdict"], one["undone"]) == (None, False)
    fix("--undo")
    assert file_of(robot) == PARAMS


def test_the_open_try_is_flown_again(robot, simulator):
    begun("--command", "exit 3", status=1)
    fix("--command", simulator)
    assert [one["verdict"] for one in state()["tries"]] == ["same", "fixed"]


def test_a_recording_without_reports_is_an_error(robot):
    line = error_of(begun("--command", 'mkdir "$TPC_FIX_MISSION"', status=1))
    assert "fix-try-1" in line
    assert state()["tries"][0]["verdict"] is None


def test_what_a_file_does_not_set_is_passed_over(robot, simulator):
    origins = json.loads((robot / "today/origins.json").read_text())
    del origins["parameters"]["/node/max_tilt"]
    origins["parameters"]["/node/max_tilt"] = {"kind": "unknown", "value": 2.0}
    (robot / "today/origins.json").write_text(json.dumps(origins))
    result = begun("--command", simulator)
    assert "passed over: set /node/max_tilt to 4 yourself" in result.stderr
    assert [one["parameter"] for one in state()["tries"]] == ["~max_speed"]


def test_ctrl_c_ends_the_command_and_leaves_the_try_open(robot):
    words = ("fix", "today", "--static", "static.json", "--reference", "yesterday", "--command")
    command = 'echo $$ > "$PWD/pid"; exec sleep 60'
    with subprocess.Popen(
        pytpc(*words, command), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        try:
            for _ in range(600):
                if (robot / "pid").exists() and (robot / "pid").read_text():
                    break
                time.sleep(0.1)
            process.send_signal(signal.SIGINT)
            said = process.communicate(timeout=120)[1]
        finally:
            process.kill()
    assert (process.returncode, said.splitlines()[-1]) == (130, "pytpc: interrupted")
    with pytest.raises(ProcessLookupError):
        os.kill(int((robot / "pid").read_text()), 0)
    (one,) = state()["tries"]
    assert (one["verdict"], one["undone"]) == (None, False)
    fix("--undo")
    assert file_of(robot) == PARAMS


def test_fewer_than_half_as_many_marks_are_better(robot):
    recorded(robot, "few", tilt=4.0, marks=(20,), at=2000)
    begun("--command", 'cp -r few "$TPC_FIX_MISSION"', "--tries", 1)
    assert state()["tries"][0]["verdict"] == "better"
    assert "max_tilt: 4.0" in file_of(robot)


def test_a_mark_of_another_type_is_another_error(robot):
    recorded(robot, "stuck", tilt=4.0, kind="II", at=2000)
    begun("--command", 'cp -r stuck "$TPC_FIX_MISSION"', "--tries", 1)
    assert state()["tries"][0]["verdict"] == "other"
    assert file_of(robot) == PARAMS
