"""Small rospy nodes as text, and what the analysis finds in them.

A sample is the body of a module behind ``PRELUDE``. The expected comparisons stand beside each line
as ``#: PARAMETER RELATION [TYPE]``, separated by commas; a line without this has none.
"""

from __future__ import annotations

import re
from pathlib import Path
from textwrap import dedent
from typing import Any

from pytpc.python_analysis.analysis import analyse_entry
from pytpc.python_analysis.rules_file import load_rules
from pytpc.python_analysis.sources.packages import entry_of
from pytpc.static.link_unit import Comparison, LinkUnit

PRELUDE = "import rospy\nfrom std_msgs.msg import Float64\npub = rospy.Publisher('out', Float64)\n"
_MARK = re.compile(r"#: (.*)$")


def analysed(text: str, folder: Path, **rules: Any) -> LinkUnit:
    """Analyse a script with the text ``PRELUDE + text``; the JSON is checked on the way."""
    script = folder / "node.py"
    script.write_text(PRELUDE + dedent(text))
    unit = analyse_entry(entry_of(script), load_rules(**rules))
    return LinkUnit.from_json(unit.to_json(), script)


def marked(text: str) -> set[tuple[int, str, str, str]]:
    """The comparisons that the marks of a sample expect: (line, parameter, relation, type)."""
    wanted = set()
    for lineno, line in enumerate((PRELUDE + dedent(text)).splitlines(), start=1):
        mark = _MARK.search(line)
        for each in mark[1].split(",") if mark else ():
            parameter, relation, *rest = each.split()
            kind = rest[0] if rest else ("flag" if relation == "flag" else "parameter")
            wanted.add((lineno, parameter, relation, kind))
    return wanted


def found(unit: LinkUnit) -> set[tuple[int, str, str, str]]:
    """The comparisons in the same form."""
    return {(c.lineno, c.source or "", c.relation, c.type) for c in unit.comparisons}


def only(unit: LinkUnit) -> Comparison:
    """The only comparison."""
    (comparison,) = unit.comparisons
    return comparison
