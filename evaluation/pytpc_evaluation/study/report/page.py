"""docs/study.md and docs/study/tables.md from their templates: nothing is worked out here."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache

from jinja2 import Environment, PackageLoader, StrictUndefined, Template

from pytpc_evaluation.study.metrics import CONFIDENT, DRAWS
from pytpc_evaluation.study.report.changed import Changed
from pytpc_evaluation.study.report.conclusion import conclusion
from pytpc_evaluation.study.report.confidence import SURE_METHODS
from pytpc_evaluation.study.report.drawings import Drawing
from pytpc_evaluation.study.report.headline import TOP, Headline
from pytpc_evaluation.study.report.parts import Part
from pytpc_evaluation.study.report.repairs import TARGET
from pytpc_evaluation.study.report.systems import NEAR
from pytpc_evaluation.study.suggestion_chains import HEADLINE
from pytpc_evaluation.tables import Table, as_markdown, markdown

IMAGES = "images/study"
BESIDE = "study"
"""Where figures and tables are, from the page."""

_LONGEST_LINE = 120
_PREFIX = re.compile(r" *(?:\d+\. |- )?")
_NOTHING = "There is nothing for this table yet."
_GAPS = re.compile(r"\n{3,}")


@dataclass(frozen=True, eq=False)
class Contents:
    """All that is on the page: ``tables`` by label; ``halves`` and ``parts`` are what is shown,
    ``others`` the parts that were ranked by other people's marks, too.
    ``rounds`` are counts of treatments with a changed parameter, see `rounds_of`.

    ``judged`` is how often the half that is held back was judged, empty where that is not known.
    """

    systems: Sequence[str]
    changed: Changed
    rounds: Mapping[str, int]
    missions: int
    halves: Sequence[str]
    parts: Sequence[Part]
    others: Sequence[Part]
    tables: Mapping[str, Table]
    drawings: Sequence[Drawing]
    headlines: Sequence[Headline]
    troubles: Sequence[str]
    remarks: Sequence[str]
    judged: str


def page(contents: Contents) -> str:
    """The page as Markdown, the same for the same contents."""
    return _made("study.md.j2", contents)


def tables_page(contents: Contents) -> str:
    """The page with every table and figure, as Markdown; it is beside the tables, in ``BESIDE``."""
    return _made("tables.md.j2", contents)


def _made(template: str, contents: Contents) -> str:
    def table(label: str) -> str:
        found = contents.tables.get(label)
        if found is None or not (found.rows or found.summary):
            return _NOTHING
        return as_markdown(found).strip()

    def drawn(beginning: str, folder: str) -> str:
        found = (one for one in contents.drawings if one.file.startswith(beginning))
        return _images(found, folder)

    def missions_of(system: str, folder: str) -> str:
        own = (one for one in contents.drawings if one.system == system)
        return _images((one for one in own if one.file != f"{system}-runtime.png"), folder)

    text = _template(template).render(
        vars(contents),
        conclusion=conclusion(contents.tables),
        table=table,
        drawn=drawn,
        missions_of=missions_of,
        draws=DRAWS,
        near=f"{NEAR:g}",
        confident=f"{CONFIDENT:g}",
        target=f"{100 * TARGET:.0f}",
        headline=HEADLINE,
        top=TOP,
        sure_methods=SURE_METHODS,
    )
    return wrapped(_GAPS.sub("\n\n", text).strip()) + "\n"


def wrapped(text: str) -> str:
    """Markdown whose prose has lines of at most 120 characters; tables and links stay whole."""
    lines: list[str] = []
    for line in text.split("\n"):
        if len(line) <= _LONGEST_LINE or line.startswith(("|", "!", "#")):
            lines.append(line)
            continue
        beginning = _PREFIX.match(line)
        indent = " " * (0 if beginning is None else beginning.end())
        lines += textwrap.wrap(
            line,
            _LONGEST_LINE,
            subsequent_indent=indent,
            break_long_words=False,
            break_on_hyphens=False,
        )
    return "\n".join(lines)


def _images(drawings: Iterable[Drawing], folder: str) -> str:
    return "\n\n".join(
        f"![{markdown(one.caption)}]({folder}/{one.file})\n\n*{markdown(one.caption)}*"
        for one in drawings
    )


@cache
def _template(name: str) -> Template:
    environment = Environment(
        loader=PackageLoader(__package__, "templates"),
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=StrictUndefined,
    )
    environment.filters["markdown"] = markdown
    return environment.get_template(name)
