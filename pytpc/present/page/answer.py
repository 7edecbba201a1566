"""The top of a mission on the page: the verdict, which parameter to change, and to what value."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup

from pytpc.base.wording import many, percent
from pytpc.diagnosis.results.advice import MissionAnswer
from pytpc.present.page.cards import CardView


@dataclass(frozen=True)
class AnswerView:
    """Marks that name the same first suspect and the same direction, and that suspect's card.

    The card is the one whose value answers the most of these marks, and changes least elsewhere.
    ``numbers`` are the marks' numbers from 1, ``marks`` are the same in words, ``types`` the scores
    that put it first there. ``reason`` says why the evidence at these marks is not enough; empty if
    it is.
    """

    numbers: tuple[int, ...]
    marks: str
    card: CardView
    plot: Markup
    others: list[CardView]
    types: str
    reason: str = ""

    @property
    def mark(self) -> str:
        """The ident of the mark whose card it is."""
        return self.card.ident.rpartition("-")[0]


def answers(cards: Sequence[Sequence[CardView]], reasons: Sequence[str]) -> list[AnswerView]:
    """The answers of a mission, beginning with the one that most marks give.

    Marks without enough evidence come last, in groups of their own.

    Args:
        cards: the cards of the first suspects of each mark, in order; may be empty.
        reasons: for each mark why there is not enough evidence; empty if there is.
    """
    groups: dict[tuple[str, str, bool], list[int]] = {}
    for place, first in enumerate(cards):
        if first:
            row, lacking = first[0].row, bool(reasons[place])
            way = first[0].lead.direction
            groups.setdefault((row.parameter, way, lacking), []).append(place)
    found = []
    for places in groups.values():
        best = min(places, key=lambda place: _worth(cards[place][0]))
        chosen = cards[best]
        numbers = tuple(place + 1 for place in places)
        types = sorted({cards[place][0].row.type for place in places})
        found.append(
            AnswerView(
                numbers=numbers,
                marks=_marks(numbers, len(cards)),
                card=chosen[0],
                plot=_copy(chosen[0]),
                others=[*chosen[1:]],
                types=" and ".join(types),
                reason=reasons[best],
            )
        )
    return sorted(found, key=lambda one: (bool(one.reason), -len(one.numbers), one.numbers))


def spoken(texts: Sequence[str]) -> str:
    """Texts in their order, repetitions joined: ``1 (x4), 2``."""
    found: list[tuple[str, int]] = []
    for text in texts:
        count = found.pop()[1] + 1 if found and found[-1][0] == text else 1
        found.append((text, count))
    return ", ".join(text if count == 1 else f"{text} (x{count})" for text, count in found)


def _worth(card: CardView) -> tuple[int, int]:
    """The less the better."""
    then = card.what_if
    return (0, 0) if then is None else (-then.answered, then.flipped_away)


def _copy(card: CardView) -> Markup:
    """The figure of a card with other ids, which must be unique in a page."""
    return Markup(card.plot.replace(f"{card.ident}-", f"{card.ident}a-"))


def _marks(numbers: Sequence[int], of: int) -> str:
    """``at the mark``, ``at all 4 marks``, ``at mark 3 of 5``, ``at marks 1-2, 4 of 5``."""
    if len(numbers) == of:
        return "at the mark" if of == 1 else f"at all {many(of, 'mark')}"
    runs: list[list[int]] = []
    for number in numbers:
        if runs and number == runs[-1][-1] + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    listed = ", ".join(str(run[0]) if len(run) == 1 else f"{run[0]}-{run[-1]}" for run in runs)
    return f"at mark{'' if len(numbers) == 1 else 's'} {listed} of {of}"


@dataclass(frozen=True)
class TogetherView:
    """The verdict, the value to try for the first suspect, and the other suspects.

    ``remedy`` is empty without a suspect or a suggestion. ``notes`` say what limits the verdict.
    """

    title: str
    text: str
    sure: bool
    remedy: str
    others: list[str]
    notes: list[str]


def together(answer: MissionAnswer) -> TogetherView | None:
    """The verdict on a mission, None where it has no mark."""
    found, first = answer.blame, answer.first
    if found is None:
        return None
    return TogetherView(
        title=found.title,
        text=found.text,
        sure=found.accused is not None,
        remedy="" if first is None or first.remedy.value is None else first.remedy.text,
        others=[
            f"{one.parameter} ({percent(one.probability)})"
            for one in found.suspects[1 : answer.question.top]
        ],
        notes=list(found.notes),
    )
