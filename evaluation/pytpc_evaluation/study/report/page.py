"""docs/study.md from its template: nothing is worked out here."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache

from jinja2 import Environment, PackageLoader, StrictUndefined, Template

from pytpc.base.tables import Table, as_markdown, markdown
from pytpc_evaluation.study.metrics import CONFIDENT, DRAWS
from pytpc_evaluation.study.report.changed import Changed
from pytpc_evaluation.study.report.confidence import SURE_METHODS
from pytpc_evaluation.study.report.drawings import Drawing
from pytpc_evaluation.study.report.headline import TOP, Headline
from pytpc_evaluation.study.report.parts import Part
from pytpc_evaluation.study.report.repairs import TARGET
from pytpc_evaluation.study.report.systems import NEAR
from pytpc_evaluation.study.suggestion_chains import HEADLINE

IMAGES = "images/study"
BESIDE = "study"
"""Where figures and tables are, from the page."""

_TEMPLATE = "study.md.j2"
_NOTHING = "There is nothing for this table yet."
_GAPS = re.compile(r"\n{3,}")


@dataclass(frozen=True, eq=False)
class Contents:
    """All that is on the page: ``tables`` by label; ``halves`` and ``parts`` are what is shown,
    ``others`` the parts that were ranked by other people's marks, too.
    ``rounds`` are counts of treatments with a changed parameter, see `rounds_of`.

    ``judged`` is how often the half that is held back was judged, empty where that is not known.
    ``tried`` and ``discussion`` are Markdown that people wrote, empty where nobody did.
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
    tried: str
    discussion: str


def page(contents: Contents) -> str:
    """The page as Markdown, the same for the same contents."""

    def table(label: str) -> str:
        found = contents.tables.get(label)
        if found is None or not (found.rows or found.summary):
            return _NOTHING
        return as_markdown(found).strip()

    def drawn(beginning: str) -> str:
        return _images(one for one in contents.drawings if one.file.startswith(beginning))

    def missions_of(system: str) -> str:
        own = (one for one in contents.drawings if one.system == system)
        return _images(one for one in own if one.file != f"{system}-runtime.png")

    text = _template().render(
        vars(contents),
        table=table,
        drawn=drawn,
        missions_of=missions_of,
        beside=BESIDE,
        draws=DRAWS,
        near=f"{NEAR:g}",
        confident=f"{CONFIDENT:g}",
        target=f"{100 * TARGET:.0f}",
        headline=HEADLINE,
        top=TOP,
        sure_methods=SURE_METHODS,
    )
    return _GAPS.sub("\n\n", text).strip() + "\n"


def _images(drawings: Iterable[Drawing]) -> str:
    return "\n\n".join(
        f"![{markdown(one.caption)}]({IMAGES}/{one.file})\n\n*{markdown(one.caption)}*"
        for one in drawings
    )


@cache
def _template() -> Template:
    environment = Environment(
        loader=PackageLoader(__package__, "templates"),
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=StrictUndefined,
    )
    environment.filters["markdown"] = markdown
    return environment.get_template(_TEMPLATE)
