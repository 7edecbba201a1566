"""Which figures of a study are drawn; apart from what draws them, which takes long to import."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pytpc.diagnosis.question import WINDOW_S


@dataclass(frozen=True, slots=True)
class Figures:
    """What is drawn of a study, where and how.

    ``folder`` is for the files, ``formats`` are of `pytpc_evaluation.stats.drawing.FORMATS`,
    ``states`` what of the robot is drawn (see `pytpc_evaluation.stats.states`), ``window_s`` is the
    window of type II.
    """

    folder: Path
    formats: Sequence[str] = ("png",)
    states: Sequence[str] = ()
    window_s: float = WINDOW_S
