"""The conversation that ends with the fixed robot, or with what was excluded."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from pytpc.api.diagnosing import AskedMission
from pytpc.api.fix_files import name_on_robot
from pytpc.api.fix_state import FixState, FixTry, Stand
from pytpc.base.wording import Number, exact, show
from pytpc.diagnosis.question import Question
from pytpc.diagnosis.results.advice import BlamedAdvice, Remedy
from pytpc.diagnosis.results.suspects import Accused, Uncompared
from pytpc.diagnosis.suggestion.advise import advise_blamed, declared_for
from pytpc.diagnosis.trying import (
    KNOWN_GOOD,
    STILL_THERE,
    Odds,
    Search,
    after_tries,
    beyond,
    mean_of,
    next_proposals,
    search_of,
    why_over,
)
from pytpc.recording.declaration import Declared
from pytpc.recording.marks import Mark
from pytpc.static.parameters import same_parameter
from pytpc.values.origins import Origin, read_origins

_BETWEEN = "between a value that did not help and one that was too much"
_ONWARD = "as far again, since the last step helped"
_NO_VALUE = "no suspect is left with a value to try"


@dataclass(frozen=True, slots=True)
class Proposal:
    """A change that is proposed: the try that it would be, and why.

    ``beyond`` says why the value leaves the known range; empty if it does not. ``origin`` is where
    the present value came from, None if that is not known. ``effect`` is what the value would have
    changed in the recorded mission. ``place`` is where the parameter is compared, or what else is
    known of it if it is not ``is_compared``.
    """

    would_be: FixTry
    effect: str
    place: str
    beyond: str
    origin: Origin | None
    is_compared: bool = True


@dataclass(frozen=True)
class Conversation:
    """What the missions and the tries say so far.

    ``first`` is the mission in which the robot went wrong. ``later`` are those of tries after which
    the error was still there, if they have marks.
    """

    state: FixState
    first: AskedMission
    later: Mapping[Path, AskedMission]

    @cached_property
    def odds(self) -> Odds:
        """What the marks and the tries say together."""
        first = _odds(self.first)
        later = [_named_as(first, _odds(one)) for one in self.later.values()]
        marks = mean_of([first, *later])
        return after_tries(marks, self.state.counted)

    @property
    def marks(self) -> Sequence[Mark]:
        """The marks of the mission with the values that are set now, without the open try."""
        return self._base.run.recording.marks

    @cached_property
    def judged(self) -> FixState:
        """The state, with where it stands now."""
        stand, why = self._stand
        return replace(self.state, stand=stand, why=why)

    @property
    def _stand(self) -> tuple[Stand, str]:
        if self.state.is_fixed:
            return "fixed", ""
        if self.state.open_try is not None:
            return "open", ""
        state = self.state
        why = why_over(self.odds, state.counted, state.most, go_on=state.go_on)
        if not why and next(self._values(), None) is None:
            why = _NO_VALUE
        return ("exhausted", why) if why else ("open", "")

    def proposals(self) -> Iterator[Proposal]:
        """What to try next, the likeliest first; nothing if it is over, or if a try is open."""
        if self.judged.stand == "open" and self.state.open_try is None:
            yield from self._values()

    def _values(self) -> Iterator[Proposal]:
        return next_proposals(self.odds, self._proposal)

    @property
    def _base(self) -> AskedMission:
        """The mission with the values that are set now: what helped, stays."""
        better = [one for one in self.state.standing if one.verdict == "better"]
        flown = better[-1].mission if better else None
        return self.first if flown is None else self.later.get(flown, self.first)

    def _proposal(self, parameter: str) -> Proposal | None:
        tries = [one for one in self.state.counted if one.parameter == parameter]
        search = search_of(tries) if tries else None
        if tries and search is None:
            return None
        offered = []
        for asked, question in self._questions(search, tries):
            advice = _advised(asked, parameter, question)
            if advice is not None:
                found = _next_of(advice.remedy, search)
                if found.value is not None:
                    return self._proposed(asked, replace(advice, remedy=found), tries)
                offered.append((asked, advice))
        if search is None or not offered:
            return None
        # The log says nothing about a further value, but the last step helped.
        asked, advice = offered[-1]
        if isinstance(advice.accused, Uncompared):
            # Nor does anything say how far it may go.
            return None
        onward = search.onward(whole=isinstance(advice.remedy.current, int))
        if onward is None:
            return None
        found = replace(
            advice.remedy, value=onward, basis="growth", text="", doubt="", reason=_ONWARD
        )
        return self._proposed(asked, replace(advice, remedy=found), tries)

    def _questions(
        self, search: Search | None, tries: Sequence[FixTry]
    ) -> Iterator[tuple[AskedMission, Question]]:
        """What to ask for the next value of a parameter, the best question first."""
        first = self.first
        if search is None:
            yield self._base, self._base.question
            if self._base is not first:
                yield first, first.question
            return
        if not search.goes_further:
            yield first, first.question
            return
        for one in reversed(tries):
            if one.mission is not None and one.mission in self.later and one.new == search.near:
                # Its log shows what the value that did not help has changed.
                asked = self.later[one.mission]
                yield asked, _by_log(asked.question, [v for v in search.still if v != one.new])
        yield first, _by_log(first.question, [search.base] * (len(search.still) - 1))

    def _proposed(
        self, asked: AskedMission, advice: BlamedAdvice, tries: Sequence[FixTry]
    ) -> Proposal | None:
        found, accused, parameter = advice.remedy, advice.accused, advice.accused.parameter
        assert found.value is not None, "what is proposed has a value"
        mission = self.state.mission
        compared = accused if isinstance(accused, Accused) else None
        node = "" if compared is None else compared.last.node.partition(" ")[0]
        name, origin = name_on_robot(mission, found.parameter, node)
        changed = _changed_as(found, asked.question)
        if isinstance(accused, Uncompared) and accused.difference.parameter.startswith("/"):
            changed = accused.difference.parameter
        if changed:
            name, origin = changed, read_origins(mission).get(changed, origin)
        standing = [one for one in tries if not one.undone]
        base = _base_of(found, tries, math.nan if compared is None else compared.last.thresh)
        old = standing[-1].new if standing else base
        if found.value == old:
            return None
        declared = _declared(asked, advice)
        known = [float(base), *(one.value for one in found.known)]
        known += [float(one.new) for one in tries if one.basis in KNOWN_GOOD]
        if found.basis in KNOWN_GOOD:
            known.append(float(found.value))
        would_be = FixTry(
            parameter,
            old,
            found.value,
            found.basis,
            name=name,
            node=node,
            text=_text(found, old),
            probability=self.odds.suspects[parameter],
        )
        return Proposal(
            would_be,
            advice.what_if.text if advice.what_if is not None and found.text else "",
            f"{accused.place}  {accused.condition}".rstrip(),
            beyond(found.value, known, declared, found.doubt),
            origin,
            compared is not None,
        )


def with_verdict(state: FixState, said: FixTry) -> FixState:
    """The state after a word about its open try."""
    return replace(state.with_try(said), stand="fixed" if said.verdict == "fixed" else "open")


def missions_with_the_error(state: FixState) -> list[Path]:
    """The recordings of tries after which the error was still there, each once."""
    found = [one.mission for one in state.counted if one.verdict in STILL_THERE]
    return list(dict.fromkeys(one for one in found if one is not None))


def _odds(asked: AskedMission) -> Odds:
    blame = asked.diagnosis.blame
    return Odds({one.parameter: one.probability for one in blame.suspects}, blame.none)


def _named_as(first: Odds, other: Odds) -> Odds:
    """The odds of another mission under the names of the first; nodes may have told other ones."""
    suspects = {}
    for name in first.suspects:
        alike = [name] if name in other.suspects else _alike(name, other.suspects)
        if len(alike) == 1:
            suspects[name] = other.suspects[alike[0]]
    return Odds(suspects, other.none)


def _alike(name: str, others: Iterable[str]) -> list[str]:
    return [one for one in others if same_parameter(one, name) or same_parameter(name, one)]


def _advised(asked: AskedMission, parameter: str, question: Question) -> BlamedAdvice | None:
    """The advice for one suspect; None if it is none in this mission."""
    blame = asked.diagnosis.blame
    own = tuple(one for one in blame.suspects if one.parameter == parameter)
    only = replace(blame, suspects=own)
    return next(iter(advise_blamed(only, asked.run.recording, asked.static_info, question)), None)


def _by_log(question: Question, flown: Sequence[float]) -> Question:
    """The question for a value further than these, by the log alone.

    What was known to be good has been tried, or is on the other side.
    """
    return replace(question, flown=flown, references=(), changes=(), sources=frozenset())


def _next_of(found: Remedy, search: Search | None) -> Remedy:
    """The remedy with a value that the tries leave; without a value if they leave none."""
    if search is None:
        return found
    whole = isinstance(found.current, int)
    middle = search.between(whole=whole)
    if middle is not None and search.up not in search.closed:
        return replace(found, value=middle, basis="between", text="", doubt="", reason=_BETWEEN)
    if found.value is not None and search.allows(found.value):
        return found
    for one in found.known if search.up in search.closed else ():
        value: Number = int(one.value) if whole and one.value.is_integer() else one.value
        if search.allows(value):
            reason = f"in the other direction, and known to be good: {one.source}"
            return replace(found, value=value, basis=one.source, text="", doubt="", reason=reason)
    return replace(found, value=None, basis=None, direction=None)


def _base_of(found: Remedy, tries: Sequence[FixTry], threshold: float) -> Number:
    """The value with which the error was seen."""
    if tries:
        return tries[0].old
    return threshold if found.current is None else found.current


def _declared(asked: AskedMission, advice: BlamedAdvice) -> Declared | None:
    if isinstance(advice.accused, Uncompared):
        return None
    source = asked.static_info.source_path(advice.accused.key)
    return declared_for(asked.question.declared or (), advice.accused, source)


def _changed_as(found: Remedy, question: Question) -> str:
    """The full name under which a value that worked was changed; empty if it is not known."""
    if found.basis not in {"reference", "before"}:
        return ""
    named = (one.parameter for one in question.changes if one.parameter.startswith("/"))
    return next((one for one in named if same_parameter(one, found.parameter)), "")


def _text(found: Remedy, old: Number) -> str:
    """The suggestion as a sentence; its own, if it is about this step."""
    assert found.value is not None, "what is proposed has a value"
    if found.text and found.current == old:
        return found.text
    why = found.reason or "further in the direction that the log shows"
    way = "raise" if found.value > old else "lower"
    return f"{way} {found.parameter} from {show(old)} to {exact(found.value)} ({why})"
