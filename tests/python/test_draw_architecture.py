"""tools/draw-architecture draws what the contracts say, and sees when the drawing is old."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PICTURE = "docs/images/architecture.svg"
CONTRACTS = """
[[tool.importlinter.contracts]]
name = "Data flows one way"
type = "layers"
containers = ["house"]
layers = ["roof", "left | (right)", "cellar"]

[[tool.importlinter.contracts]]
name = "The roof opens no file"
type = "forbidden"
"""


def draw(root: Path, *options: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, ROOT / "tools/draw_architecture.py", "--root", root, *options],
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture()
def house(tmp_path: Path) -> Path:
    (tmp_path / "pyproject.toml").write_text(CONTRACTS)
    for room in ("roof", "left", "cellar"):
        folder = tmp_path / "house" / room
        folder.mkdir(parents=True)
        (folder / "__init__.py").write_text(f'"""The {room} & more. Unseen."""\n')
    return tmp_path


def test_layers_stand_in_order_and_siblings_side_by_side(house: Path):
    assert draw(house).returncode == 0
    drawing = (house / PICTURE).read_text()
    names = re.findall(r'<text x="(\S+)" y="(\d+)" font-size="15".*?>(\w+)<', drawing)
    height = {name: int(y) for _, y, name in names}
    assert height["roof"] < height["left"] == height["right"] < height["cellar"]
    assert float(names[1][0]) < float(names[2][0])
    assert drawing.count("<path") == 2
    assert "The cellar &amp; more<" in drawing
    assert "Unseen" not in drawing
    assert "rooms side by side import nothing of each other." in drawing
    assert "The roof opens no file." in drawing


def test_a_drawing_that_is_old_fails_the_check(house: Path):
    draw(house)
    before = (house / PICTURE).read_bytes()
    assert draw(house, "--check").returncode == 0
    (house / "pyproject.toml").write_text(CONTRACTS.replace('"cellar"', '"cellar", "ground"'))
    done = draw(house, "--check")
    assert done.returncode == 1
    assert done.stderr == (
        f"{PICTURE} is not what the contracts say. Run: tools/draw-architecture\n"
    )
    assert (house / PICTURE).read_bytes() == before


def test_without_contracts_it_says_so(tmp_path: Path):
    (tmp_path / "pyproject.toml").write_text("[project]\nname = 'house'\n")
    done = draw(tmp_path)
    assert done.returncode == 1
    assert "no contract" in done.stderr
