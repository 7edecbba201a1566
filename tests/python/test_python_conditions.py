"""The whole condition around a comparison in Python: literal sources, places worked out by hand."""

from pathlib import Path

import pytest

from mixed_workspace import make_mixed
from pytpc.build.python_units import analyse_scripts, scripts_at
from pytpc.conditions import lookup as condition_lookup
from pytpc.conditions.lookup import CHANGED, GONE, NOT_IN_PYTHON, look_up_conditions
from pytpc.conditions.python_conditions import PythonSource
from pytpc.python_analysis.rules_file import load_rules
from pytpc.static.static_info import StaticInfo

# The comparison, which stands between the marks, and the kind and text of the condition.
CASES = {
    "if $a > b$:\n  pass": ("if", "a > b"),
    "if not ($a > b$ and c):\n  pass": ("if", "not (a > b and c)"),
    "if (x\n    or $a > b$  # why\n    or y):\n  pass": ("if", "x\n    or a > b  # why\n    or y"),
    "if x:\n  pass\nelif $flag$:\n  pass": ("if", "flag"),
    "while a < $b < c$ < d:\n  pass": ("while", "a < b < c < d"),
    "assert $a > b$, 'text'": ("assert", "a > b"),
    "z = x if $a > b$ else y": ("conditional expression", "a > b"),
    "z = [c for c in d if $c > b$]": ("if", "c > b"),
    "for i in $range(n)$:\n  pass": ("for", "range(n)"),
    "z = [i for i in $range(n)$]": ("for", "range(n)"),
    "match $mode$:\n  case 1:\n    pass": ("match", "mode"),
    "match m:\n  case L.low | $L.high$:\n    pass": ("case", "L.low | L.high"),
    "match m:\n  case 1 if $a > b$:\n    pass": ("if", "a > b"),
    "over = $a > b$ or c": ("expression", "a > b or c"),
    "f(1, $a > b$)": ("expression", "a > b"),
    "if any($c > b$ for c in d):\n  pass": ("expression", "c > b"),
    "if $self.limits['top'].value$ and x:\n  pass": ("if", "self.limits['top'].value and x"),
    "if (n := $a > b$):\n  pass": ("if", "n := a > b"),
    "z = ($a > b$) & (c > d)": ("expression", "(a > b) & (c > d)"),
    "@d($a > b$)\ndef f(): pass": ("expression", "a > b"),
    "f = lambda m: $m > b$": ("expression", "m > b"),
    "if 'é' and $a > b$:\n  pass": ("if", "'é' and a > b"),
}


def marked(text: str) -> tuple[str, tuple[int, int, int, int]]:
    """The text without the marks, and where they stood."""
    before, within, behind = text.split("$")
    return before + within + behind, (*_behind(before), *_behind(before + within))


def _behind(text: str) -> tuple[int, int]:
    return text.count("\n") + 1, len(text.rpartition("\n")[2].encode()) + 1


@pytest.mark.parametrize("text", CASES)
def test_the_whole_condition(text: str) -> None:
    plain, span = marked(text)
    found = PythonSource(plain.encode()).condition(span)
    assert found is not None
    assert (found.kind, found.text) == CASES[text]
    # Where the end is not known, the begin is enough.
    assert PythonSource(plain.encode()).condition((*span[:2], None, None)) == found
    windows = PythonSource(plain.replace("\n", "\r\n").encode()).condition(span)
    assert windows == found


def test_what_is_no_python_is_said() -> None:
    for data in (b"x = (", b"x = '\0'", b"# coding: none\n", b"\xff"):
        with pytest.raises(ValueError, match="no Python 3"):
            PythonSource(data)


def test_a_file_in_another_encoding() -> None:
    data = "# coding: latin-1\nif 'é' and a > b:\n  pass".encode("latin-1")
    # Columns count bytes in UTF-8, whatever the file is in: é is two.
    found = PythonSource(data).condition((2, 13, 2, 18))
    assert found is not None
    assert (found.text, found.column) == ("'é' and a > b", 4)


def test_a_place_without_a_condition() -> None:
    assert PythonSource(b"x = 1").condition((1, 3, None, None)) is None
    assert PythonSource(b"import x").condition((1, 1, None, None)) is None


def analysed(workspace: Path) -> StaticInfo:
    rules = load_rules()
    return StaticInfo.of(analyse_scripts(scripts_at(workspace, rules), rules).units)


def texts(static: StaticInfo) -> list[tuple[str | None, str]]:
    answers = look_up_conditions(static, static.tpcs)
    found = [answers[tpc.key] for tpc in static.tpcs]
    return [(each.condition and each.condition.text, each.note) for each in found]


def test_conditions_of_a_workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without libclang, which Python does not need."""
    monkeypatch.setattr(condition_lookup, "libclang", lambda: False)
    static = analysed(make_mixed(tmp_path))
    both = "height > top\n            and not ready"
    assert texts(static) == [
        ('self.declare_parameter("bright", 3).value > 2 + len(self.get_name())', ""),
        (both, ""),
        (both, ""),
        ("level < LOW", ""),
    ]
    scripts = tmp_path / "src/mission/scripts"
    text = (scripts / "mission.py").read_text(encoding="utf-8")
    (scripts / "mission.py").write_text(text.replace("height > top", "height < top"), "utf-8")
    (tmp_path / "src/camera/camera/node.py").unlink()
    limits = tmp_path / "src/mission/src/sampling/limits.py"
    limits.write_text(limits.read_text("utf-8") + "x = (\n", "utf-8")
    assert [note for _, note in texts(static)] == [GONE, CHANGED, "", CHANGED]
    quoted = '"""' + "\n" * 7 + 'if (height > top\n            and not ready):\n"""\n'
    (scripts / "mission.py").write_text(quoted, "utf-8")
    assert texts(static)[1:3] == [(None, NOT_IN_PYTHON), (None, NOT_IN_PYTHON)]
