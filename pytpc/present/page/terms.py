"""The terms that the report page explains where they stand, and in a list at its end."""

from __future__ import annotations

import re
from typing import NamedTuple

from markupsafe import Markup, escape

from pytpc.present.page.environment import seen


class Term(NamedTuple):
    """A term; ``pattern`` finds it in a text, ``meaning`` explains it in a sentence or two."""

    ident: str
    name: str
    pattern: str
    meaning: str


TERMS = (
    Term("type-1", "type I", r"type I", "The robot did something that it should not have done."),
    Term("type-2", "type II", r"type II", "The robot should be doing something, and does not."),
    Term(
        "good-run",
        "good run",
        r"good runs?",
        "A recording of the robot behaving as it should; the option --reference names it.",
    ),
    Term(
        "away",
        "away from marks",
        r"away from (?:the )?marks",
        "More than a window before a mark, or after it: nobody said that anything was wrong there.",
    ),
    Term(
        "flop",
        "flop",
        r"flops?",
        "Two evaluations of a comparison, one after the other, with different results.",
    ),
    Term(
        "flag",
        "flag",
        r"flag",
        "A parameter that is itself the condition, as in if (use_gps); it is true or false.",
    ),
    Term(
        "exposing",
        "exposing statement",
        r"exposing statements?",
        "A call through which the rest of the robot sees what the node decided: a publish, a"
        " service call, the result of an action.",
    ),
    Term(
        "score",
        "score",
        r"score",
        "The thesis's score of a comparison at one mark: lower is more suspicious. Type I: it"
        " changed just before, and seldom else. Type II: its value was close to the threshold, and"
        " the result stayed.",
    ),
    Term(
        "rank",
        "rank",
        r"rank",
        "From 0 to 1, by the order of the scores: 1 is the most suspicious, 0 has no score.",
    ),
    Term(
        "distance",
        "distance",
        r"distance",
        "How many backward steps a comparison is from the nearest exposing statement.",
    ),
)
_BY_IDENT = {term.ident: term for term in TERMS}
_PERCENT = re.compile(r"(\d) %")
_ONE_OF = "|".join(f"(?P<{term.ident.replace('-', '_')}>{term.pattern})" for term in TERMS)
# Not in the name of a parameter or a file, which may hold such a word.
_ANY = re.compile(rf"(?<![\w/~.#&-])(?:{_ONE_OF})(?![\w/;-])")


def term(ident: str, text: str = "") -> Markup:
    """A term that explains itself; ``text`` is how it stands in the sentence."""
    found = _BY_IDENT[ident]
    return Markup('<a class="term" href="#term-{0}" aria-describedby="term-{0}">{1}</a>').format(
        ident, text or found.name
    )


def explained(text: str) -> Markup:
    """A text, escaped, in which each term explains itself where it stands first."""
    told: set[str] = set()

    def linked(match: re.Match[str]) -> str:
        ident = (match.lastgroup or "").replace("_", "-")
        if ident in told:
            return match[0]
        told.add(ident)
        return str(term(ident, match[0]))

    shown = _PERCENT.sub("\\1\N{NO-BREAK SPACE}%", str(escape(seen(text))))
    return Markup(_ANY.sub(linked, shown))
