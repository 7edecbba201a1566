"""All that is advised about the suspects at a mark: the entrance to this room."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from pytpc.advice.counterfactual import WhatIf
from pytpc.advice.declared import Declared
from pytpc.advice.suggest import Suggestion
from pytpc.ingest.recording import Recording
from pytpc.scoring.ranking import MarkRanking, Suspect
from pytpc.static_info import StaticInfo


@dataclass(frozen=True, slots=True)
class Advice:
    """A suspect with what to do: ``what_if`` is None where nothing is suggested."""

    suspect: Suspect
    suggestion: Suggestion
    what_if: WhatIf | None
    declared: Declared | None


def advise(
    recording: Recording,
    static_info: StaticInfo,
    ranking: MarkRanking,
    *,
    top: int = 5,
    declared: Sequence[Declared] = (),
) -> list[Advice]:
    """Advice for the first ``top`` suspects at a mark, in their order."""
    raise NotImplementedError
