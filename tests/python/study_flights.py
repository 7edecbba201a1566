"""A small robot for the tests of the study, and someone who only seems to fly it."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path

import pytest

from pytpc.base.errors import RunError
from pytpc.ros.mission_run import Progress
from pytpc_evaluation.demo import demo_examples
from pytpc_evaluation.demo.demo_examples import Example
from pytpc_evaluation.study.dataset import Done, load_done, save_done
from pytpc_evaluation.study.plan import Flight
from pytpc_evaluation.treatment import Treatment, TreatmentType

PARAMETERS = """\
world: {wind: 0.1}
pump:
  a: 1.0
  b: 2.0
  c: 0.004
  nothing: 0.0
  count: 3
  on: true
  unused: 7.0
mission: {limit: 20, pace: 0.5, deep/er: 4.0}
"""

DECOYS = (
    {"parameter": "~a", "node": "/pump", "new": 1.5},
    {"parameter": "~c", "node": "/pump", "new": 0.008},
)


def treatment(name: str, kind: TreatmentType | None = None, parameter: str | None = None):
    """``type1_b`` changes ``~b`` of /pump from 2 to 0.5, ``clean`` and ``fault_x`` nothing."""
    sort = kind or name.partition("_")[0]
    changed = sort in ("type1", "type2")
    return Treatment(
        name=name,
        type=sort,
        parameter=(parameter or f"~{name.partition('_')[2]}") if changed else None,
        node="/pump" if changed else None,
        old=2.0 if changed else None,
        new=0.5 if changed else None,
        launch={},
        effect="It leaks.",
        overlay=Path("params.yaml"),
    )


def robot(folder: Path, monkeypatch: pytest.MonkeyPatch, *names: str) -> Example:
    """A robot in a folder of its own, with these treatments and the clean one."""
    monkeypatch.setattr(demo_examples, "project_root", lambda: folder)
    example = Example(
        name="robot",
        title="Robot",
        watched=("/truth/robot",),
        goal_topic="/truth/full",
        reached="the vial was filled",
        missed="the vial was not filled",
        missed_under=frozenset({"type2"}),
        shown=("clean",),
        simulator="/world",
    )
    for file, text in (
        ("config/params.yaml", PARAMETERS),
        ("launch/robot.launch", "<launch/>\n"),
        ("src/node.cpp", "int main() {}\n"),
        ("study.json", json.dumps({"decoys": DECOYS})),
    ):
        path = example.folder / file
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    for name in ("clean", *names):
        one = treatment(name)
        place = example.folder / "treatments" / name
        place.mkdir(parents=True)
        (place / "params.yaml").write_text("pump: {b: 0.5}\n" if one.parameter else "# none\n")
        fields = ("name", "type", "parameter", "node", "old", "new", "launch", "effect")
        (place / "treatment.json").write_text(
            json.dumps({field: getattr(one, field) for field in fields})
        )
    return example


class FakeFlier:
    """Seems to fly: writes ``done.json`` with the digest that it is given; may fail.

    ``failures`` says how often the flight of a label fails before it does not.
    """

    def __init__(self, out: Path, failures: Mapping[str, int] | None = None, digest: str = "1"):
        self.out = out
        self.failures = dict(failures or {})
        self.digest = digest
        self.flown: list[str] = []

    def kept(self, flight: Flight) -> Done | None:
        done = load_done(flight.folder(self.out))
        return done if done is not None and done.flight == self.digest else None

    def fly(self, flight: Flight, on_progress: Callable[[Progress], None] | None = None) -> Done:
        self.flown.append(flight.label)
        if on_progress is not None:
            on_progress(Progress(1.0, 0.1, 0, 0))
        if self.failures.get(flight.label, 0):
            self.failures[flight.label] -= 1
            raise RunError(f"pump died at try {len(self.flown)}", flight.folder(self.out))
        done = made(self.digest)
        save_done(done, flight.folder(self.out))
        return done


def made(digest: str = "1", **changes: object) -> Done:
    plain = {
        "flight": digest,
        "marked": "2",
        "rate": 12.0,
        "seed": 1,
        "people": 7,
        "sim_s": 60.0,
        "wall_s": 5.0,
        "reports": 100,
        "reached": True,
        "causes": 0,
        "marks": 0,
    }
    return Done(**{**plain, **changes})
