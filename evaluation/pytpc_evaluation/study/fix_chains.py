"""Chains of ``pytpc fix``, as a user has them: one observer, and nobody tells the treatment.

The conversation is that of the command line (`pytpc.api.fixing`), with ``--command``: each change
is flown, the same observer marks the new mission, and the marks decide what came of it. Types are
those that the observer said.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from pathlib import Path

from pytpc.api.comparing import RecordedRun
from pytpc.api.diagnosing import AskedMission
from pytpc.api.fix_state import FixState, FixTry
from pytpc.api.fixing import Conversation, Proposal, missions_with_the_error
from pytpc.diagnosis.question import PLAIN
from pytpc.diagnosis.trying import TAKEN_BACK, judged
from pytpc.recording.marks import Mark
from pytpc.recording.mission import load_recording
from pytpc.static.static_info import StaticInfo
from pytpc.values.target import options_to_apply
from pytpc_evaluation.study.data import UserMark, drawn_good_runs, user_marks
from pytpc_evaluation.study.dataset import MARKED_FILE
from pytpc_evaluation.study.people import USERS
from pytpc_evaluation.study.suggestion_chains import FIX_RUNS, Chain, Try


def observer_of(mission: str, marks: Sequence[UserMark]) -> str:
    """Who watches a mission: one of the four, drawn for it, of those who set a mark.

    Nobody begins to fix a robot in which they saw nothing wrong. Empty if all saw nothing.
    """
    users = [f"user{number}" for number in range(1, USERS + 1)]
    random.Random(f"observer of {mission}").shuffle(users)
    seen = {one.observer for one in marks}
    return next((one for one in users if one in seen), "")


@dataclass(frozen=True)
class _Talk:
    """The conversation of a chain so far."""

    chain: Chain
    out: Path

    @cached_property
    def _folder(self) -> Path:
        return self.out / "missions" / self.chain.mission

    @cached_property
    def observer(self) -> str:
        return observer_of(self.chain.mission, user_marks(self._folder / MARKED_FILE))

    @cached_property
    def tries(self) -> tuple[FixTry, ...]:
        """Those of the chain, each with the folder of its flight."""
        return tuple(
            replace(FixTry.from_json(one.fix), mission=self.out / self.chain.flown(place))
            for place, one in enumerate(self.chain.tries)
            if one.fix is not None
        )

    @cached_property
    def conversation(self) -> Conversation:
        state = FixState(self._folder, tries=self.tries)
        asked = ((path, self._asked(path)) for path in missions_with_the_error(state))
        later = {path: one for path, one in asked if one.run.recording.marks}
        return Conversation(state, self._asked(self._folder), later)

    def _asked(self, folder: Path) -> AskedMission:
        run = RecordedRun(replace(load_recording(folder), marks=self.marks(folder)), folder)
        static = _static(self.out / "systems" / self.chain.system / "static.json")
        runs = drawn_good_runs(self.out, self._folder)[: FIX_RUNS[self.chain.variant]]
        return AskedMission.of(run, static, PLAIN, [_good(one) for one in runs])

    def marks(self, folder: Path) -> tuple[Mark, ...]:
        """What the observer marked in a mission, with the types that they said."""
        every = user_marks(folder / MARKED_FILE)
        own = (one.mark("confused") for one in every if one.observer == self.observer)
        return tuple(sorted(own, key=Mark.order))


def next_fix(chain: Chain, out: Path) -> Try:
    """What ``pytpc fix`` tries next in a chain that is not over; without a value at its end.

    Raises:
        InputError: a file of the study is missing or broken.
    """
    talk = _Talk(chain, out)
    chain.observer = talk.observer
    if not talk.observer:
        return Try("", None, None, None, reason="nobody set a mark")
    found = talk.conversation
    for proposal in found.proposals():
        if _is_unattended(proposal):
            one = proposal.would_be
            return Try(one.name, None, float(one.new), one.basis, fix=one.to_json())
    why = found.judged.why or "only values are left that no file sets, or beyond the known range"
    return Try("", None, None, None, reason=why)


def with_verdict(chain: Chain, out: Path) -> Try:
    """The last try of a chain, which was flown, with what the observer's marks say of it.

    Raises:
        InputError: its flight cannot be read.
    """
    talk = _Talk(chain, out)
    flown = talk.tries[-1]
    assert flown.mission is not None, "it was flown"
    verdict = judged(talk.conversation.marks, talk.marks(flown.mission))
    undone = verdict in TAKEN_BACK
    told = replace(flown, verdict=verdict, undone=undone, mission=None).to_json()
    return replace(chain.tries[-1], fix=told)


def _is_unattended(proposal: Proposal) -> bool:
    """Whether ``--command`` tries it: what no file sets, or leaves the known range, it passes."""
    origin = proposal.origin
    settable = origin is not None and options_to_apply(origin) is not None
    return settable and not proposal.beyond


@cache
def _static(path: Path) -> StaticInfo:
    return StaticInfo.load(path)


@cache
def _good(path: Path) -> RecordedRun:
    return RecordedRun(load_recording(path), path)
