"""Draw the rooms of ``pytpc`` and who may import whom, from import-linter's contracts.

``draw_architecture.py [--check] [--root FOLDER]`` reads the contracts in FOLDER/pyproject.toml and
writes FOLDER/docs/images/architecture.svg. With --check it writes nothing and exits with 1 where
the file is not what it would write. The words in a box are the first sentence of the docstring.
The same input gives the same bytes.
"""

from __future__ import annotations

import argparse
import ast
import re
import sys
import textwrap
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import NamedTuple

import tomllib

PICTURE = Path("docs/images/architecture.svg")
WIDTH, EDGE, GAP = 960, 24, 14
TITLE, TEXT = 15, 12.5
LINE = 17
ARROW = 20
BESIDE = 165
PLAIN = 'fill="#333333"'
BOLD = 'font-weight="bold" fill="#1f3a5f"'
CHARACTER = 6.1
"""Mean width of a character in pixels; boxes are 10 % wider."""

HEADER = """<svg xmlns="http://www.w3.org/2000/svg"
  viewBox="0 0 {width} {height}" width="{width}" height="{height}"
  font-family="Helvetica, Arial, sans-serif" role="img" aria-label="{label}">
<!-- Made by tools/draw-architecture from the contracts in pyproject.toml. Do not edit. -->
<rect width="{width}" height="{height}" rx="8" fill="#ffffff"/>
"""


class Room(NamedTuple):
    """A package of pytpc, and the first sentence of its docstring."""

    name: str
    purpose: str


class Contracts(NamedTuple):
    """The layers, from the one that may import all others down; other contracts in words."""

    layers: Sequence[Sequence[Room]]
    rules: Sequence[str]


def read(root: Path) -> Contracts:
    """Read the contracts of ``root``; exit with an error if there is no layers contract."""
    project = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = project.get("tool", {}).get("importlinter", {}).get("contracts", [])
    found = [contract for contract in contracts if contract["type"] == "layers"]
    if not found:
        sys.exit("draw-architecture: pyproject.toml has no contract of import-linter with layers")
    layers = [
        [_room(root, _package(name, found[0])) for name in re.split(r"\s*[|:]\s*", layer)]
        for layer in found[0]["layers"]
    ]
    rule = "A room imports only from rooms below it"
    if any("|" in layer for layer in found[0]["layers"]):
        rule += "; rooms side by side import nothing of each other"
    return Contracts(layers, [rule, *(one["name"] for one in contracts if one is not found[0])])


def _package(layer: str, contract: Mapping[str, Sequence[str]]) -> str:
    """Return the full name of a layer; one in parentheses may be missing."""
    name = layer.strip("() ")
    container = (contract.get("containers") or [""])[0]
    return f"{container}.{name}" if container else name


def _room(root: Path, package: str) -> Room:
    path = root / package.replace(".", "/")
    path = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
    text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) if path.exists() else None
    first = " ".join((text or "").split("\n\n")[0].split()).replace("``", "")
    return Room(package.rpartition(".")[2], re.split(r"(?<=\.) ", first)[0].removesuffix("."))


def draw(contracts: Contracts) -> str:
    """Return the drawing."""
    shapes: list[str] = []
    top = EDGE
    for number, layer in enumerate(contracts.layers):
        if number:
            shapes.append(_arrow(top - ARROW))
        width = (WIDTH - 2 * EDGE - GAP * (len(layer) - 1)) / len(layer)
        # If a layer has one room, the purpose is beside the name of the room, not below it.
        beside = len(layer) == 1
        room_for_text = width - (BESIDE if beside else 0) - 24
        words = [
            textwrap.wrap(room.purpose, int(room_for_text / CHARACTER / 1.1)) for room in layer
        ]
        height = (16 if beside else 34) + LINE * max(1, *map(len, words))
        for place, (room, lines) in enumerate(zip(layer, words, strict=True)):
            left = EDGE + place * (width + GAP) + 12
            shapes.append(_box(left - 12, top, width, height))
            shapes.append(_text(left, top + 22, TITLE, room.name, BOLD))
            text = (left + BESIDE, top + 22) if beside else (left, top + 41)
            for line, part in enumerate(lines):
                shapes.append(_text(text[0], text[1] + LINE * line, TEXT, part, PLAIN))
        top += height + ARROW
    for number, rule in enumerate(contracts.rules):
        shapes.append(_text(EDGE, top + LINE * number, TEXT, f"{rule}.", PLAIN))
    height = top + EDGE + LINE * (len(contracts.rules) - 1)
    label = "The rooms of pytpc: each imports only from rooms below it"
    head = HEADER.format(width=WIDTH, height=height, label=label)
    return head + "".join(f"{shape}\n" for shape in shapes) + "</svg>\n"


def _box(left: float, top: int, width: float, height: int) -> str:
    return (
        f'<rect x="{left:g}" y="{top}" width="{width:g}" height="{height}" rx="6" '
        f'fill="#eef3fa" stroke="#5b7aa6"/>'
    )


def _arrow(top: int) -> str:
    """Draw a short arrow from one layer to the next one."""
    middle, end = WIDTH // 2, top + ARROW - 3
    return (
        f'<path d="M{middle} {top + 3}V{end}m-5 -6l5 6l5 -6" fill="none" '
        f'stroke="#5b7aa6" stroke-width="1.5"/>'
    )


def _text(left: float, top: int, size: float, text: str, style: str) -> str:
    return f'<text x="{left:g}" y="{top}" font-size="{size:g}" {style}>{escape(text)}</text>'


def main() -> None:
    """Write the drawing, or compare it with the existing file."""
    parser = argparse.ArgumentParser(description="Draw the architecture from its contracts.")
    parser.add_argument(
        "--check", action="store_true", help="Only check whether the file is up to date."
    )
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parents[1])
    given = parser.parse_args()
    path = given.root / PICTURE
    drawing = draw(read(given.root))
    if not given.check:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(drawing, encoding="utf-8")
    elif not path.exists() or path.read_text(encoding="utf-8") != drawing:
        sys.exit(f"{PICTURE} is not what the contracts say. Run: tools/draw-architecture")


if __name__ == "__main__":
    main()
