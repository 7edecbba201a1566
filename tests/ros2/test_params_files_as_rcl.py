"""Params files are read as rcl reads them: the same values and winners, and the same refusals.

The nodes are real ones of rclpy, in one process. The files are written by hand, one for each form,
and drawn at random.
"""

from __future__ import annotations

import json
import random
import subprocess
from pathlib import Path

from patience import PATIENCE_S
from pytpc.values.rcl_params import ParamsError, ParamsStore
from ros2_graph import PYTHON, ros2_env

PROGRAM = Path(__file__).with_name("read_params.py")
NODES = [["/", "guard"], ["/robot1", "guard"], ["/robot1/arm", "guard"], ["/robot2", "other"]]

# Each group of texts is one command line, with one `--params-file` for each.
BY_HAND: list[list[str]] = [
    ["/**:\n  ros__parameters:\n    a: 4.0\n"],
    ["/*:\n  ros__parameters:\n    a: 4\n"],
    ["/*/guard:\n  ros__parameters:\n    a: 1e3\n"],
    ["/**/guard:\n  ros__parameters:\n    a: .inf\n"],
    ["/robot1/*:\n  ros__parameters:\n    a: -.inf\n"],
    ["/robot1/**:\n  ros__parameters:\n    a: .nan\n"],
    ["guard:\n  ros__parameters:\n    a: 'x'\n"],
    ["/guard:\n  ros__parameters:\n    a: x y\n"],
    ["/robot1/guard:\n  ros__parameters:\n    a: true\n"],
    ["robot1/guard:\n  ros__parameters:\n    a: yes\n"],
    [
        "robot1:\n  guard:\n    ros__parameters:\n      a: 1\n  arm:\n    guard:\n"
        "      ros__parameters:\n        a: 2\nguard:\n  ros__parameters:\n    a: 3\n"
    ],
    ["/robot1:\n  guard:\n    ros__parameters: {a: 1}\n  ros__parameters: {a: 2}\n"],
    ["/**:\n  guard:\n    ros__parameters:\n      a: 5\n"],
    ["ns:\n  sub/guard:\n    ros__parameters: {a: 1}\n  other:\n    ros__parameters: {a: 2}\n"],
    ["robot1:\n  arm/guard:\n    ros__parameters: {a: 1}\n  guard:\n    ros__parameters: {a: 2}\n"],
    # Dots and nesting are the same name.
    ["/**:\n  ros__parameters:\n    limits.min: 1.0\n    limits:\n      min: 2.0\n"],
    [
        "/**:\n  ros__parameters:\n    limits:\n      min: 2.0\n      deep:\n        er: 1\n"
        "      max: 3.0\n    limits.min: 1.0\n    other: 7\n"
    ],
    [
        "/**:\n  ros__parameters:\n    limits: {min: 1}\n",
        "/**:\n  ros__parameters:\n    limits.min: 2\n",
    ],
    [
        "/**:\n  ros__parameters:\n    limits.min: 1\n",
        "/**:\n  ros__parameters:\n    limits: {min: 2}\n",
        "/**:\n  ros__parameters:\n    limits.min: 3\n",
    ],
    ["/**:\n  ros__parameters:\n    a.b: {c.d: 1}\n    a: {b.c: {d: 2}}\n"],
    # Of several, the later one; but entries stand in the order of their first mention.
    ["/**:\n  ros__parameters:\n    a: 1\n/guard:\n  ros__parameters:\n    a: 2\n"],
    ["/guard:\n  ros__parameters:\n    a: 2\n/**:\n  ros__parameters:\n    a: 1\n"],
    [
        "/**:\n  ros__parameters:\n    a: 1\n/guard:\n  ros__parameters:\n    a: 2\n",
        "/**:\n  ros__parameters:\n    a: 3\n",
    ],
    ["/guard:\n  ros__parameters:\n    a: 2\n", "guard:\n  ros__parameters:\n    a: 3\n"],
    [
        "guard:\n  ros__parameters:\n    a: 2\n",
        "/guard:\n  ros__parameters:\n    a: 3\n",
        "guard:\n  ros__parameters:\n    a: 4\n",
    ],
    ["/**:\n  ros__parameters:\n    a: 1\n    a: 2\n"],
    ["/guard:\n  ros__parameters:\n    a: 1\n/guard:\n  ros__parameters:\n    b: 2\n"],
    # A value of another type.
    ["/**:\n  ros__parameters:\n    a: 4\n", "/**:\n  ros__parameters:\n    a: 4.5\n"],
    ["/**:\n  ros__parameters:\n    a: 4.5\n", "/**:\n  ros__parameters:\n    a: 4\n"],
    ["/**:\n  ros__parameters:\n    a: text\n", "/**:\n  ros__parameters:\n    a: [1, 2]\n"],
    ["/**:\n  ros__parameters:\n    a: [1, 2]\n", "/**:\n  ros__parameters:\n    a: [3]\n"],
    ["/**:\n  ros__parameters:\n    a: [1.0]\n    a: [2]\n"],
    ["/**:\n  ros__parameters:\n    l: {a: 4}\n", "/**:\n  ros__parameters:\n    l: {a: 4.5}\n"],
    # Arrays.
    [
        "/**:\n  ros__parameters:\n    a: [true, no]\n    b: [1, 0x2]\n    c: [1.0, .5, 1e3]\n"
        "    d: [x, 'y', \"z\"]\n    e: []\n    f:\n      - 1\n      - 2\n"
    ],
    ["/**:\n  ros__parameters:\n    a: [1, 2.0]\n"],
    ["/**:\n  ros__parameters:\n    a: [1, x]\n"],
    ["/**:\n  ros__parameters:\n    a: [true, 1]\n"],
    ["/**:\n  ros__parameters:\n    a: [on, y]\n    b: [nan, 1.0]\n"],
    # What rcl refuses.
    ["/**:\n  ros__parameters:\n    a:\n"],
    ["/**:\n  ros__parameters:\n"],
    ["/**:\n  a: 1\n"],
    ["/**:\n  a: [1]\n"],
    ["ros__parameters:\n  a: 1\n"],
    ["a: 1\n"],
    ["/**:\n  ros__parameters:\n    a: &x 1\n    b: *x\n"],
    ["/**:\n  ros__parameters:\n    a: &x 1\n"],
    ["/**:\n  ros__parameters:\n    a: {b: 1\n"],
    ["/**:\n  ros__parameters:\n    a: [1\n"],
    ["/**:\n\tros__parameters:\n"],
    ["/ro bot:\n  ros__parameters:\n    a: 1\n"],
    ["/robot1/:\n  ros__parameters:\n    a: 1\n"],
    ["/1guard:\n  ros__parameters:\n    a: 1\n"],
    ["/a//guard:\n  ros__parameters:\n    a: 1\n"],
    ["gu*:\n  ros__parameters:\n    a: 1\n"],
    ["/**:\n  ros__parameters:\n    '': 1\n"],
    ["/**:\n  ros__parameters: 5\n"],
    ["/**:\n  ros__parameters:\n    a: [[1, 2], [3]]\n"],
    # What it takes.
    [""],
    ["# only a comment\n"],
    ["/**:\n  ros__parameters: {}\n"],
    ["/**:\n  ros__parameters:\n    a: ''\n    b: \"\"\n"],
    ["/**:\n  ros__parameters:\n    a: |\n      1\n    b: |-\n      2\n    c: >\n      text\n"],
    ["/**:\n  ros__parameters:\n    a: !!str 5\n    b: !!int 5\n    c: !!float 5\n    d: !x 5\n"],
    ["---\n/**:\n  ros__parameters:\n    a: 1\n---\n/guard:\n  ros__parameters:\n    a: 2\n"],
    ["\ufeff/**:\n  ros__parameters:\n    a: 1\n"],
    ["/**:\r\n  ros__parameters:\r\n    a: 1\r\n"],
]

_SCALAR_TEXT = """0 1 -1 +1 007 010 08 0x1F 0X1f -0x10 0b1 0o7 1_000 9223372036854775807
9223372036854775808 -9223372036854775808 99999999999999999999 4. .5 4.0 -4.5 +.5 1e3 1E3 1e+3
1e-3 1.5e3 1e400 1e-400 1e-310 0e-400 0.0 -0.0 . e3 1e inf -inf Infinity nan NaN nan(1) .nan .NaN
.NAN .Nan +.nan -.nan .inf .Inf +.inf -.INF 0x1p3 0x1.8p1 0x.8 0xg y Y n N yes Yes YES yEs no on
On ON oN off true True TRUE tRue false null ~ Null 2020-01-01 12:30:45 1,5 1/2 a.b a:b deg(90) <<
= 0x 0x1p 1.2.3 --1 +-1 1f 5m é"""


def _scalars() -> str:
    lines = [f"    s{number}: {text}\n" for number, text in enumerate(_SCALAR_TEXT.split())]
    return "/**:\n  ros__parameters:\n" + "".join(lines)


def _drawn(draw: random.Random) -> list[str]:
    """One to three random files about few names, so that they meet."""
    patterns = [
        "/**",
        "/*",
        "/*/guard",
        "guard",
        "/guard",
        "robot1/guard",
        "/robot1/guard",
        "/robot1/*",
        "/robot1/**",
        "/**/guard",
        "/robot1/arm/guard",
        "/robot2/other",
    ]
    values = [
        "1",
        "2",
        "2.5",
        "3.0",
        "true",
        "no",
        "'7'",
        "word",
        "[1, 2]",
        "[1.5]",
        "[a, b]",
        "1e2",
        "[true]",
        "[]",
    ]

    def parameters(depth: int, indent: str) -> str:
        text = ""
        for _ in range(draw.randint(1, 4)):
            name = draw.choice(["a", "b", "a.b", "limits", "limits.a", "b.a"])
            if depth < 3 and draw.random() < 0.3:
                text += f"{indent}{name}:\n{parameters(depth + 1, indent + '  ')}"
            else:
                text += f"{indent}{name}: {draw.choice(values)}\n"
        return text

    def entry(indent: str, depth: int) -> str:
        if depth < 2 and draw.random() < 0.25:
            name = draw.choice(["robot1", "/robot1", "arm", "robot1/arm", "/**"])
            below = "".join(entry(indent + "  ", depth + 1) for _ in range(draw.randint(1, 2)))
            return f"{indent}{name}:\n{below}"
        name = draw.choice(["guard", "other"] if depth else patterns)
        return f"{indent}{name}:\n{indent}  ros__parameters:\n{parameters(0, indent + '    ')}"

    return [
        "".join(entry("", 0) for _ in range(draw.randint(1, 4))) for _ in range(draw.randint(1, 3))
    ]


def _ours(texts: list[str], rules: list[str]) -> list[dict[str, list[str | None]]] | None:
    store = ParamsStore()
    try:
        for text in texts:
            store.load(text.removeprefix("\ufeff"))
        for rule in rules:
            store.set_rule(rule)
    except ParamsError:
        return None
    return [_shown(store, f"{namespace.rstrip('/')}/{name}") for namespace, name in NODES]


def _shown(store: ParamsStore, node: str) -> dict[str, list[str | None]]:
    shown: dict[str, list[str | None]] = {}
    for name, held in store.of_node(node).items():
        value = None if held.slot.holds is None else held.slot.holds.value
        one = value[0] if isinstance(value, list) else value
        kind = {bool: "BOOL", int: "INTEGER", float: "DOUBLE", str: "STRING"}.get(
            type(one), "NOT_SET"
        )
        array = "_ARRAY" if isinstance(value, list) else ""
        shown[name] = [f"{kind}{array}", None if value is None else repr(value)]
    return shown


def test_the_same_values_as_rclpy_gets(domain: dict[str, str], tmp_path: Path) -> None:
    draw = random.Random(7)
    groups = [*BY_HAND, [_scalars()], *(_drawn(draw) for _ in range(150))]
    cases: list[tuple[list[str], list[str]]] = [(group, []) for group in groups]
    one = ["/**:\n  ros__parameters:\n    a: 1\n/guard:\n  ros__parameters:\n    a: 2\n"]
    cases += [
        (one, [rule])
        for rule in (
            "a:=7",
            "guard:a:=7",
            "/guard:a:=8",
            "b:=[1, 2]",
            "b:='x'",
            "b:=1.5",
            "a.b:=on",
            "other:a:=3",
            "b:=[1, x]",
        )
    ]
    asked = []
    for number, (texts, rules) in enumerate(cases):
        words = []
        for index, text in enumerate(texts):
            path = tmp_path / f"{number}_{index}.yaml"
            path.write_bytes(text.encode())
            words += ["--params-file", str(path)]
        asked.append([[*words, *(word for rule in rules for word in ("-p", rule))], NODES])
    ran = subprocess.run(
        [PYTHON, PROGRAM],
        input=json.dumps(asked),
        env=ros2_env(domain),
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )
    assert ran.returncode == 0, ran.stderr
    differing = []
    for (texts, rules), theirs in zip(cases, json.loads(ran.stdout), strict=True):
        refused = all(isinstance(one, str) for one in theirs)
        ours = _ours(texts, rules)
        if ours != (None if refused else theirs):
            differing.append((texts, rules, ours, theirs))
    assert not differing, "\n".join(map(str, differing[:5]))
    assert sum(len(texts) for texts, _ in cases) >= 60
