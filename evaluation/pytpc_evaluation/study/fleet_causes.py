"""Asks the fleet's ranking about fleets with several wrong parameters, each in other missions.

A question has bad missions of several treatments of a system, which change different parameters,
and good ones. The answer is what the ranking names as causes, however many.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pytpc.static.parameters import same_parameter
from pytpc_evaluation.study.fleet_questions import BAD, GOOD, MARKED, by_turns, by_verdict

CausesOf = Callable[[str, Sequence[str]], Sequence[str]]
"""The parameters that are named as causes, of a system and folders of missions."""


@dataclass(frozen=True, slots=True)
class CausesQuestion:
    """A question with known answers.

    ``treatments`` are sorted, and ``parameters`` what is wrong in the missions of each;
    ``missions`` are the folders of bad and good ones.
    """

    system: str
    draw: int
    treatments: tuple[str, ...]
    parameters: tuple[str, ...]
    missions: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class CausesVerdict:
    """What was named.

    ``named`` says of each treatment whether its parameter was; ``false`` are the parameters that
    were named and are wrong in none of the missions.
    """

    system: str
    draw: int
    treatments: tuple[str, ...]
    named: tuple[bool, ...]
    false: tuple[str, ...]


def causes_questions(
    rows: Iterable[Mapping[str, Any]],
    draws: int,
    causes: int,
    bad_count: int = BAD,
    good_count: int = GOOD,
) -> Iterator[CausesQuestion]:
    """The questions that flown missions allow.

    Args:
        rows: of ``flights.json``.
        draws: how many questions there are of each system.
        causes: how many parameters are wrong in each question; a system of which fewer treatments
            can be asked about has none.
        bad_count: how many bad missions a treatment has; with less than 80 % of them it is out.
        good_count: how many good ones a question has; with fewer there is none.
    """
    good, bad = by_verdict(rows)
    for system in sorted(good):
        known = {
            treatment: marked
            for (of, treatment), marked in sorted(bad.items())
            if of == system and len(marked) >= MARKED * bad_count
        }
        parameters = {treatment: marked[0]["parameter"] for treatment, marked in known.items()}
        if len(good[system]) < good_count or len({*parameters.values()}) < causes:
            continue
        for draw in range(draws):
            dice = random.Random(f"causes {system} {causes} {draw}")
            order = sorted(known)
            dice.shuffle(order)
            # Two treatments of one parameter would be one cause.
            first: dict[str, str] = {}
            for treatment in order:
                first.setdefault(parameters[treatment], treatment)
            chosen = sorted([*first.values()][:causes])
            missions = [
                folder
                for treatment in chosen
                for folder in by_turns(known[treatment], bad_count, dice)
            ]
            yield CausesQuestion(
                system=system,
                draw=draw,
                treatments=tuple(chosen),
                parameters=tuple(parameters[treatment] for treatment in chosen),
                missions=(*missions, *by_turns(good[system], good_count, dice)),
            )


def judge_causes(question: CausesQuestion, causes_of: CausesOf) -> CausesVerdict:
    """Ask a question."""
    named = causes_of(question.system, question.missions)
    return CausesVerdict(
        question.system,
        question.draw,
        question.treatments,
        tuple(any(same_parameter(own, one) for one in named) for own in question.parameters),
        tuple(
            one for one in named if not any(same_parameter(own, one) for own in question.parameters)
        ),
    )
