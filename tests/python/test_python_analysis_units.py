"""Link units of Python: packages, imports, keys, arithmetic, rules, the command."""

import hashlib
import json
import math
import uuid
from pathlib import Path

import pytest
from click.testing import CliRunner
from python_analysis_samples import PRELUDE, analysed, only

from pytpc.base.errors import InputError
from pytpc.cli.main import main
from pytpc.python_analysis.rules_file import load_rules
from pytpc.python_analysis.sources.packages import entries
from pytpc.static.static_info import StaticInfo

MANIFEST = """<package format="2"><name>guard</name><version>0.0.1</version>
<description>d</description><license>BSD</license>
<maintainer email="someone@example.org">x</maintainer></package>"""
SCRIPT = """#!/usr/bin/env python3
import rospy
from guard import limits
from guard.sub.sender import Sender
if __name__ == "__main__":
    rospy.init_node("watch")
    sender = Sender()
    rospy.Subscriber("in", object, lambda m: sender.send(m) if m.data > limits.TOP else None)
"""


def package(folder: Path) -> Path:
    """A package of one node and three modules."""
    (folder / "src/guard/sub").mkdir(parents=True)
    (folder / "scripts").mkdir()
    (folder / "package.xml").write_text(MANIFEST)
    (folder / "scripts/watch.py").write_text(SCRIPT)
    (folder / "src/guard/__init__.py").write_text("")
    (folder / "src/guard/sub/__init__.py").write_text("")
    (folder / "src/guard/limits.py").write_text("import rospy\nTOP = rospy.get_param('top')\n")
    (folder / "src/guard/sub/sender.py").write_text(
        "import rospy\nfrom ..limits import TOP as top\nclass Sender:\n"
        "    def __init__(self):\n        self.pub = rospy.Publisher('out', object)\n"
        "    def send(self, m):\n        if m.data < top:\n            self.pub.publish(m)\n"
    )
    return folder


def run(*words: str) -> tuple[int, str, str]:
    result = CliRunner().invoke(main, ["analyse", *words])
    return result.exit_code, result.stdout, result.stderr


def test_a_package_with_modules(tmp_path: Path) -> None:
    output = tmp_path / "out.json"
    status, _, errors = run(str(package(tmp_path / "guard")), "-o", str(output))
    assert (status, errors) == (0, "")
    (unit,) = StaticInfo.load(output).units
    assert (unit.package, unit.link_unit, unit.tool.analysis) == ("guard", "watch", "python")
    assert unit.source_root == str(tmp_path / "guard")
    assert [(c.file, c.lineno, c.source, c.relation) for c in unit.comparisons] == [
        ("scripts/watch.py", 8, "top", ">"),
        ("src/guard/sub/sender.py", 7, "top", "<"),
    ]
    assert [(r.file, r.lineno) for r in unit.parameters] == [("src/guard/limits.py", 2)]


def test_the_same_twice_and_the_key_by_hand(tmp_path: Path) -> None:
    folder = package(tmp_path / "guard")
    run(str(folder), "-o", str(tmp_path / "a.json"))
    run(str(folder), "-o", str(tmp_path / "b.json"))
    assert (tmp_path / "a.json").read_bytes() == (tmp_path / "b.json").read_bytes()
    first, second = StaticInfo.load(tmp_path / "a.json").units[0].comparisons
    # The namespace of passes/GatherResults.cpp; the lambda stands in the module's body, its
    # comparison begins at column 64 of line 8.
    space = uuid.UUID("6b0f7a52-2c9e-4d61-9a37-8f15c3405ed8")
    column = SCRIPT.splitlines()[7].index("m.data > ") + 1
    name = ["guard", "watch", "scripts/watch.py", "<lambda>", "8", str(column), "top"]
    assert first.key == str(uuid.uuid5(space, "\n".join(name)))
    name = ["guard", "watch", "src/guard/sub/sender.py", "Sender.send", "7", "12", "top"]
    assert second.key == str(uuid.uuid5(space, "\n".join(name)))


def test_the_digests_of_the_sources_are_kept(tmp_path: Path) -> None:
    folder = package(tmp_path / "guard")
    run(str(folder), "-o", str(tmp_path / "a.json"))
    # A comparison, the read of its parameter, and another comparison.
    names = ("scripts/watch.py", "src/guard/limits.py", "src/guard/sub/sender.py")
    files = [folder / name for name in names]
    digests = ((str(file), hashlib.sha256(file.read_bytes()).hexdigest()) for file in files)
    assert StaticInfo.load(tmp_path / "a.json").sources == tuple(digests)


def test_faults_are_one_line_with_the_place(tmp_path: Path) -> None:
    bad = tmp_path / "bad.py"
    bad.write_text("x = 1\ny = (\n")
    status, _, errors = run(str(bad), "-o", str(tmp_path / "out.json"))
    assert status == 1
    assert errors.startswith(f"pytpc: error: {bad}:2: not Python 3: ")
    assert not (tmp_path / "out.json").exists()
    assert run(str(tmp_path / "none"))[0] == 1


def test_a_broken_script_among_others_is_left_out(tmp_path: Path) -> None:
    folder = package(tmp_path / "guard")
    (folder / "scripts/old.py").write_text("print 'Python 2'\n")
    status, _, errors = run(str(folder), "-o", str(tmp_path / "out.json"))
    assert status == 0
    assert "old.py:1: not Python 3" in errors
    assert [unit.link_unit for unit in StaticInfo.load(tmp_path / "out.json").units] == ["watch"]


def test_which_scripts_are_nodes(tmp_path: Path) -> None:
    folder = package(tmp_path / "guard")
    (folder / "setup.py").write_text("if __name__ == '__main__':\n    pass\n")
    (folder / "tests").mkdir()
    (folder / "tests/test_x.py").write_text("if __name__ == '__main__':\n    pass\n")
    (folder / "scripts/bare").write_text("#!/usr/bin/python3\nimport rospy\nrospy.init_node('b')\n")
    assert [entry.name for entry in entries(folder)] == ["bare", "watch"]


SCALED = {
    "math.radians(p)": (math.pi / 180, 0.0),
    "p * 2 + 1": (2.0, 1.0),
    "(3 - p) / 2": (-0.5, 1.5),
    "float(p) - 0.5": (1.0, -0.5),
}
COMPUTED = {
    "p * p": ("x^2", ("pow", "x", 2.0)),
    "p ** 2": ("x^2", ("pow", "x", 2.0)),
    "int(p)": ("trunc(x)", ("trunc", "x")),
    "p // 2": ("floor(0.5 * x)", ("floor", ("*", 0.5, "x"))),
    "1.0 / p": ("1 / x", ("/", 1.0, "x")),
    "max(p, 0.5)": ("max(x, 0.5)", ("max", "x", 0.5)),
    "-abs(p)": ("-abs(x)", ("*", -1.0, ("abs", "x"))),
    "math.sqrt(p) + 1": ("sqrt(x) + 1", ("+", ("sqrt", "x"), 1.0)),
}
BODY = """import math
p = rospy.get_param('~p')
def cb(m):
    if m.data > {}:
        pub.publish(m)
rospy.Subscriber('in', Float64, cb)
"""


@pytest.mark.parametrize("text", SCALED)
def test_scaled(text: str, tmp_path: Path) -> None:
    how = only(analysed(BODY.format(text), tmp_path)).transform
    assert how is not None
    assert (how.kind, how.scale, how.offset) == (
        "affine",
        *(pytest.approx(x) for x in SCALED[text]),
    )


@pytest.mark.parametrize("text", COMPUTED)
def test_computed(text: str, tmp_path: Path) -> None:
    unit = analysed(BODY.format(text), tmp_path)
    # `max` compares by itself, too.
    how = next(each for each in unit.comparisons if each.type == "derived").transform
    assert how is not None
    assert (how.kind, how.text, how.tree) == ("expression", *COMPUTED[text])


# The last three have a number in them that is no double, and no JSON.
LOST = [
    "p * m.data", "unknown(p)", "max(p, m.data, key=abs)",
    "p * 1e300 * 1e300", "p // 1e-320", "p << 2000",
]  # fmt: skip


@pytest.mark.parametrize("text", LOST)
def test_lost_is_said(text: str, tmp_path: Path) -> None:
    unit = analysed("from x import unknown\n" + BODY.format(text), tmp_path)
    assert unit.comparisons == ()
    assert unit.counts.lost_values == 1
    (spot,) = [each for each in unit.blind_spots if each.kind == "lost_value"]
    # Three lines of the prelude, one import, then the fourth line of the body.
    assert (spot.parameter, spot.lineno) == ("~p", 8)


def test_own_rules(tmp_path: Path) -> None:
    rules = tmp_path / "rules.json"
    table = {
        "reads": [{"function": "mine.read", "name": 1}],
        "makes": [{"function": "mine.open", "class": "mine.Bus"}],
        "exposing": [{"function": "mine.Bus.send"}],
    }
    rules.write_text(json.dumps(table))
    text = (
        "import mine\nbus = mine.open()\ntop = mine.read(0, 'top')\ndef cb(m):\n"
        "    if m.data > top:\n        bus.send(m)\nrospy.Subscriber('in', Float64, cb)\n"
    )
    assert analysed(text, tmp_path).comparisons == ()
    assert only(analysed(text, tmp_path, own=rules)).source == "top"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("{", "Expecting property name"),
        ("[]", "/: .* is not of type 'object'"),
        ('{"reads": [{"name": 0}]}', "/reads/0"),
        ('{"exposing": [{"function": "a", "odd": 1}]}', "/exposing/0"),
        ('{"odd": []}', "/: .*'odd' was unexpected"),
        ('{"reads": [{"function": "a", "name": -1}]}', "/reads/0/name"),
        ('{"reads": [{"function": "a b"}]}', "/reads/0/function"),
        ('{"exposing": [{"function": "a", "profiles": ["mine"]}]}', "/exposing/0/profiles/0"),
        ('{"comparisons": [{"function": "a", "relation": "~"}]}', "/comparisons/0/relation"),
        ('{"values": [{"scale": 2}]}', "/values/0"),
        ('{"topics": [{"function": "a"}]}', "/topics/0"),
    ],
)
def test_faults_in_rules(text: str, said: str, tmp_path: Path) -> None:
    rules = tmp_path / "rules.json"
    rules.write_text(text)
    with pytest.raises(InputError, match=said):
        load_rules("default", rules)


def test_the_built_in_rules_obey_the_schema() -> None:
    # Reading checks them; each table of the schema is in use.
    rules = load_rules()
    assert rules.reads["rospy.get_param"].name.place == 0
    assert rules.comparisons["operator.gt"].relation == ">"


def test_deep_expressions_fail_alone(tmp_path: Path) -> None:
    deep = "+".join(["1"] * 700)
    script = tmp_path / "deep.py"
    script.write_text(f"{PRELUDE}x = {deep}\nif __name__ == '__main__':\n    pass\n")
    (tmp_path / "good.py").write_text(f"{PRELUDE}if __name__ == '__main__':\n    pass\n")
    assert run(str(tmp_path), "-o", str(tmp_path / "out.json"))[0] == 0
    units = StaticInfo.load(tmp_path / "out.json").units
    assert {unit.link_unit: unit.status for unit in units} == {"deep": "failed", "good": "ok"}


def test_a_folder_whose_scripts_are_all_broken(tmp_path: Path) -> None:
    for name in ("one.py", "two.py"):
        (tmp_path / name).write_text("#!/usr/bin/env python3\nimport rospy\nprint 1\n")
    status, _, errors = run(str(tmp_path), "-o", str(tmp_path / "out.json"))
    assert status == 1
    assert errors.strip() == (
        f"pytpc: error: {tmp_path}/one.py:3: not Python 3: it looks like Python 2 (print without"
        " parentheses) and needs Python 3 (and 1 other script that cannot be analysed)"
    )
