"""The state of ``pytpc fix``: a JSON file (docs/reference/formats.md#the-state-of-a-fix)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal, cast, get_args

from pytpc.base.atomic import write_atomic
from pytpc.base.checked_json import dump_json, parse_json
from pytpc.base.errors import InputError
from pytpc.base.wording import Number
from pytpc.diagnosis.results.advice import Basis
from pytpc.diagnosis.trying import MOST_TRIES, VERDICTS, Try, Verdict

STATE_FILE = Path("fix.json")
SCHEMA = 1
Stand = Literal["open", "fixed", "exhausted"]
"""Where a conversation stands."""


@dataclass(frozen=True, slots=True)
class FixTry(Try):
    """A try, and what became of the file.

    ``name`` is the full name that is set, ``node`` the node that compared it. ``path`` is the file
    that is changed and ``undo`` the number of that change in the journal; without a ``path``, a
    person sets the value. ``when`` is the time of the try, and ``mission`` the recording with it.
    ``text`` is the suggestion, and ``probability`` how likely the parameter was when it was made.
    ``undone`` says that the old value is back.
    """

    name: str = ""
    node: str = ""
    path: Path | None = None
    undo: int | None = None
    when: str = ""
    mission: Path | None = None
    text: str = ""
    probability: float = 0.0
    undone: bool = False

    @property
    def is_open(self) -> bool:
        """Whether it waits for a word about it."""
        return self.verdict is None and not self.undone

    @property
    def counts(self) -> bool:
        """Whether it says something; a cure that was taken back does not."""
        return self.verdict is not None and not (self.verdict == "fixed" and self.undone)

    def to_json(self) -> dict[str, object]:
        """As it stands in the file."""
        return {
            "parameter": self.parameter,
            "name": self.name,
            "node": self.node,
            "old": self.old,
            "new": self.new,
            "basis": self.basis,
            "text": self.text,
            "probability": self.probability,
            "path": _text(self.path),
            "undo": self.undo,
            "when": self.when,
            "mission": _text(self.mission),
            "verdict": self.verdict,
            "undone": self.undone,
        }

    @classmethod
    def from_json(cls, document: Mapping[str, Any]) -> FixTry:
        """The reverse of ``to_json``.

        Raises:
            ValueError: a field has no meaning; KeyError: one is missing.
        """
        verdict, basis = document["verdict"], document["basis"]
        if verdict is not None and verdict not in VERDICTS:
            raise ValueError(f"the verdict {verdict!r}")
        if basis is not None and basis not in get_args(Basis):
            raise ValueError(f"the basis {basis!r}")
        undo = document["undo"]
        return cls(
            parameter=str(document["parameter"]),
            old=_number(document["old"]),
            new=_number(document["new"]),
            basis=cast("Basis | None", basis),
            verdict=cast("Verdict | None", verdict),
            name=str(document["name"]),
            node=str(document["node"]),
            path=_path(document["path"]),
            undo=None if undo is None else int(undo),
            when=str(document["when"]),
            mission=_path(document["mission"]),
            text=str(document["text"]),
            probability=float(_number(document["probability"])),
            undone=bool(document["undone"]),
        )


@dataclass(frozen=True, slots=True)
class FixState:
    """A conversation: the mission in which the robot went wrong, and what was tried since.

    ``static`` is the static information that was given, ``references`` are the good runs and
    ``workspace`` the one in which files are looked for. ``most`` is how many tries there may be.
    ``go_on`` says that it does not end where it is likely none of the parameters.
    ``stand`` and ``why`` say where it stands, as far as that was known when the file was written.
    """

    mission: Path
    static: Path | None = None
    references: tuple[Path, ...] = ()
    workspace: Path | None = None
    most: int = MOST_TRIES
    tries: tuple[FixTry, ...] = ()
    stand: Stand = "open"
    why: str = ""
    go_on: bool = False

    @property
    def open_try(self) -> FixTry | None:
        """The try that waits for a word about it."""
        last = self.tries[-1] if self.tries else None
        return last if last is not None and last.is_open else None

    @property
    def counted(self) -> tuple[FixTry, ...]:
        """The tries that say something."""
        return tuple(one for one in self.tries if one.counts)

    @property
    def standing(self) -> tuple[FixTry, ...]:
        """The tries whose values are set now."""
        return tuple(one for one in self.tries if not one.undone)

    @property
    def is_fixed(self) -> bool:
        """Whether the last try was the cure."""
        return bool(self.standing) and self.standing[-1].verdict == "fixed"

    def with_try(self, changed: FixTry, place: int = -1) -> FixState:
        """The state with another try in the place of one."""
        tries = list(self.tries)
        tries[place] = changed
        return replace(self, tries=tuple(tries))

    def save(self, file: Path) -> None:
        """Write the file, atomically.

        Raises:
            TpcError: it cannot be written; what stood there before is untouched.
        """
        document = {
            "schema": SCHEMA,
            "state": self.stand,
            "why": self.why,
            "mission": str(self.mission),
            "static": _text(self.static),
            "references": [str(one) for one in self.references],
            "workspace": _text(self.workspace),
            "most": self.most,
            "go_on": self.go_on,
            "tries": [one.to_json() for one in self.tries],
        }
        write_atomic(file, dump_json(document))

    @classmethod
    def load(cls, file: Path) -> FixState:
        """Read the file.

        Raises:
            InputError: there is none, it is broken, or another version of TPC wrote it.
        """
        if not file.exists():
            raise InputError("no fix was begun here; begin one with `pytpc fix MISSION`", file)
        document = parse_json(file)
        if not isinstance(document, dict) or "schema" not in document:
            raise InputError("not a file of `pytpc fix`; give another one with -o FILE", file)
        if document["schema"] != SCHEMA:
            raise InputError(
                f"written by another TPC (format {document['schema']}; this one reads {SCHEMA});"
                " take the values back with `pytpc apply --list` and `pytpc apply --undo`, and"
                " begin anew with -o FILE",
                file,
            )
        try:
            return cls._of(document)
        except (KeyError, TypeError, ValueError, OverflowError) as error:
            why = f"{error.args[0]} is missing" if isinstance(error, KeyError) else str(error)
            raise InputError(
                f"broken: {why}; `pytpc apply --list` has the changes; begin anew with -o FILE",
                file,
            ) from error

    @classmethod
    def _of(cls, document: Mapping[str, Any]) -> FixState:
        stand, mission = document["state"], _path(document["mission"])
        if stand not in get_args(Stand) or mission is None:
            raise ValueError(f"the state {stand!r} of {mission}")
        return cls(
            mission,
            _path(document["static"]),
            tuple(Path(str(one)) for one in document["references"]),
            _path(document["workspace"]),
            int(document["most"]),
            tuple(FixTry.from_json(one) for one in document["tries"]),
            cast(Stand, stand),
            str(document["why"]),
            # A file of an earlier version does not say it.
            bool(document.get("go_on", False)),
        )


def _text(path: Path | None) -> str | None:
    return None if path is None else str(path)


def _path(text: object) -> Path | None:
    if text is None:
        return None
    if not isinstance(text, str):
        raise TypeError(f"{text!r} is no path")
    return Path(text)


def _number(value: object) -> Number:
    if not isinstance(value, bool | int | float) or not math.isfinite(value):
        raise TypeError(f"{value!r} is no number")
    return value
