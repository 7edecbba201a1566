"""A small robot whose missions go wrong until a parameter is right, with real files to change."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from mission_samples import comparison, events, ns, static_info

from pytpc.cli.main import main
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording, save_recording

SPEED, HEIGHT, TILT = 0, 1, 2
STATIC = static_info(
    comparison(SPEED, "~max_speed"),
    comparison(HEIGHT, "~max_height"),
    comparison(TILT, "~max_tilt"),
)
PARAMS = (
    "# the robot's limits\nnode:\n  max_speed: 1.0   # m/s\n  max_height: 9.0\n  max_tilt: 2.0\n"
)
LINES = {"max_speed": 3, "max_height": 4, "max_tilt": 5}
STARTS = (20, 50, 80, 110)


def flight(name, *, speed=1.0, tilt=2.0, marks=STARTS, at=0, kind="I", calm=0.5):
    """Speed peaks at 1.6 and tilt at 2.6 a second later, at each of four times.

    8 s after the times ``marks`` somebody marks; the height stays near 1, and the
    speed else at ``calm``.
    """
    rows = []
    for tick in range(1400):
        t = tick / 10
        fast, steep = calm * (1 + 0.02 * (tick % 7)), 1 + 0.01 * (tick % 5)
        for start in STARTS:
            if start <= t < start + 2:
                fast = 1.6 - abs(t - start - 1) * 0.2
            if start + 1 <= t < start + 3:
                steep = 2.6 - abs(t - start - 2) * 0.2
        rows.append((at + t, SPEED, fast > speed, fast, speed))
        rows.append((at + t + 0.01, HEIGHT, False, 1 + 0.01 * (tick % 5), 9.0))
        rows.append((at + t + 0.02, TILT, steep > tilt, steep, tilt))
    seen = tuple(Mark(ns(at + one + 8), kind, "ana") for one in marks)
    return Recording(name, events(rows), seen, ns(at), ns(at + 140))


def recorded(robot: Path, name: str, **changes) -> Path:
    """A mission in a folder, with the values of its parameters and where they came from."""
    folder = robot / name
    save_recording(flight(name, **changes), folder)
    values = {"max_speed": changes.get("speed", 1.0), "max_tilt": changes.get("tilt", 2.0)}
    values["max_height"] = 9.0
    (folder / "params.yaml").write_text(json.dumps({"node": values}))
    file = robot / "src/robot/params.yaml"
    origins = {
        f"/node/{one}": {
            "kind": "yaml",
            "value": values[one],
            "path": str(file),
            "lineno": line,
            "keys": ["node", one],
        }
        for one, line in LINES.items()
    }
    digest = hashlib.sha256(file.read_bytes()).hexdigest()
    document = {"schema": 1, "launch": None, "nodes": [], "files": {str(file): digest}}
    (folder / "origins.json").write_text(json.dumps({**document, "parameters": origins}))
    return folder


def robot_environment(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The robot in the current folder, without any other workspace; its journal is there, too."""
    monkeypatch.setenv("XDG_STATE_HOME", str(folder / "state"))
    for name in ("ROS_PACKAGE_PATH", "CMAKE_PREFIX_PATH", "AMENT_PREFIX_PATH"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.chdir(folder)
    return make_robot(folder)


def fix(*words: object, answer: str | None = None, status: int = 0) -> Result:
    """What ``pytpc fix`` answers, in the current folder."""
    result = CliRunner().invoke(main, ["fix", *map(str, words)], input=answer)
    assert result.exit_code == status, result.output
    return result


def begun(*words: object, **more) -> Result:
    """Begin beside the good run."""
    given = ("today", "--static", "static.json", "--reference", "yesterday")
    return fix(*given, *words, **more)


def alone(*words: object, **more) -> Result:
    """Begin without a good run."""
    return fix("today", "--static", "static.json", *words, **more)


def state(file: str = "fix.json"):
    return json.loads(Path(file).read_text())


def file_of(robot: Path) -> str:
    return (robot / "src/robot/params.yaml").read_text()


def make_robot(folder: Path) -> Path:
    """Its package, its static information, a bad mission and a good one with other limits."""
    package = folder / "src/robot"
    package.mkdir(parents=True)
    (package / "package.xml").write_text("<package/>")
    (package / "params.yaml").write_text(PARAMS)
    STATIC.save(folder / "static.json")
    recorded(folder, "today")
    recorded(folder, "yesterday", speed=4.0, tilt=4.0, marks=(), at=1000)
    return folder
