"""What differs between two builds as Markdown, for a comment on a pull request.

Names and lines of the source come from whoever wrote the change. Each stands in a span of code, in
which nothing is a link, a mention, an image or HTML; there is no table, whose cells a `|` ends.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence

from pytpc.base.wording import listed, many, plain
from pytpc.present.build_comparison import (
    parameter_text,
    remarks_of,
    rerouted_texts,
    spot_text,
    summary_of,
    warnings_of,
)
from pytpc.static.budget import Verdict, place_of
from pytpc.static.build_changes import BuildChanges, ComparisonChange, Status

MOST = 65_536
"""A comment on GitHub has at most this many characters."""

_LONGEST = 240
_TITLES: dict[Status, str] = {"new": "New", "gone": "Gone", "changed": "Changed"}
_TICKS = re.compile("`+")
_NAMED = 5
# What stands behind a list that is cut: the closing tag and how many are left.
_RESERVE = 200


def markdown(found: BuildChanges, judged: Sequence[Verdict] = (), *, most: int = MOST) -> str:
    """The comment: a summary, the broken rules, and the details folded; at most ``most`` long."""
    written = _Bounded(most)
    for line in _head(found, judged):
        written.add(line)
    for title, entries in _sections(found):
        written.section(title, entries)
    return written.text


def code(text: str) -> str:
    """A text on one line as a span of code, cut to a length that a comment can hold.

    >>> code("a`b"), code("@all <b>")
    ('``a`b``', '`@all <b>`')
    """
    line = plain(" ".join(text.split())) or "?"
    if len(line) > _LONGEST:
        line = f"{line[:_LONGEST]}..."
    ticks = "`" * (1 + max((len(run) for run in _TICKS.findall(line)), default=0))
    space = " " if line.startswith("`") or line.endswith("`") else ""
    return f"{ticks}{space}{line}{space}{ticks}"


def _head(found: BuildChanges, judged: Sequence[Verdict]) -> Iterator[str]:
    yield "### Comparisons with parameters"
    yield ""
    yield f"{summary_of(found)}."
    for warning in warnings_of(found):
        yield ""
        yield f"**Note:** {code(warning)}"
    broken = [one for one in judged if one.is_broken]
    if broken:
        yield ""
        yield f"**{many(len(broken), 'rule')} broken:**"
        yield ""
        for one in broken:
            names = listed(list(dict.fromkeys(each.name for each in one.findings)), _NAMED)
            yield f"- {one.rule}, {len(one.findings):,} found: {code(names)}"
    yield ""


def _sections(found: BuildChanges) -> Iterator[tuple[str, list[str]]]:
    for status, title in _TITLES.items():
        every = found.of(status)
        yield f"{title}: {many(len(every), 'comparison')}", [_entry(one) for one in every]
    topics = [f"- {code(text)}" for text in rerouted_texts(found)]
    yield f"Shown first on another topic: {len(topics):,}", topics
    parameters = [
        f"- {code(one.parameter)} in {code(one.package)}: {code(parameter_text(one))}"
        for one in found.parameters
    ]
    yield f"Parameters: {many(len(parameters), 'change')}", parameters
    spots = [f"- {code(spot_text(one))}" for one in found.spots]
    yield f"New blind spots: {len(spots):,}", spots


def _entry(one: ComparisonChange) -> str:
    site = one.site
    lines = [f"- {code(site.threshold)} at {code(place_of(one))}: {code(site.source_line)}"]
    lines += [f"  - {code(text)}" for text in remarks_of(one)]
    return "\n".join(lines)


class _Bounded:
    """Text that never is longer than a limit; what does not fit is counted."""

    def __init__(self, most: int) -> None:
        self._most = most
        self.text = ""

    def add(self, line: str) -> None:
        if len(self.text) + len(line) + 1 <= self._most - _RESERVE:
            self.text += f"{line}\n"

    def section(self, title: str, entries: Iterable[str]) -> None:
        """A folded list, of which as much is shown as there is room for."""
        every = list(entries)
        head = f"<details><summary>{title}</summary>\n\n"
        if not every or len(self.text) + len(head) + 2 * _RESERVE > self._most:
            return
        self.text += head
        shown = 0
        for entry in every:
            if len(self.text) + len(entry) + 1 + 2 * _RESERVE > self._most:
                break
            self.text += f"{entry}\n"
            shown += 1
        if shown < len(every):
            self.text += f"- and {len(every) - shown:,} more\n"
        self.text += "\n</details>\n\n"
