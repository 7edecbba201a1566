"""The product and the evaluation as wheels: installed elsewhere, they need no repository."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples/recorded_mission"
RESULTS = ("events.parquet", "marks.json", "run.json", "static.json")


def build_wheel(project: Path, package: str, folder: Path) -> Path:
    """The wheel of a copy of ``project``: setuptools leaves its traces beside the sources."""
    copy = folder / f"{package}-source"
    copy.mkdir()
    for name in ("pyproject.toml", "README.md", "VERSION"):
        if (project / name).is_file():
            shutil.copy(project / name, copy)
    shutil.copytree(project / package, copy / package, ignore=shutil.ignore_patterns("__pycache__"))
    command = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-index"]
    command += ["--no-build-isolation", "--disable-pip-version-check", "-w", str(folder), str(copy)]
    subprocess.run(command, check=True, timeout=300)
    (wheel,) = folder.glob(f"{package}-*.whl")
    return wheel


def install(wheel: Path, folder: Path) -> None:
    """A wheel of pure Python is installed by unpacking it."""
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder)


@pytest.fixture(scope="module")
def wheels(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    folder = tmp_path_factory.mktemp("wheels")
    return (
        build_wheel(ROOT, "pytpc", folder),
        build_wheel(ROOT / "evaluation", "pytpc_evaluation", folder),
    )


@pytest.fixture(scope="module")
def product(wheels: tuple[Path, Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("product")
    install(wheels[0], folder)
    return folder


@pytest.fixture(scope="module")
def libraries(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """What pytpc depends on, without the checkout that is installed for editing beside it."""
    found = []
    for number, path in enumerate(path for path in sys.path if path.endswith("-packages")):
        folder = tmp_path_factory.mktemp(f"libraries{number}")
        for entry in Path(path).iterdir():
            if "pytpc" not in entry.name:
                (folder / entry.name).symlink_to(entry)
        found.append(str(folder))
    return found


@pytest.fixture
def mission(tmp_path: Path) -> Path:
    """The example's mission, without the sources that are beside it in the repository."""
    folder = tmp_path / "mission"
    folder.mkdir()
    for name in RESULTS:
        shutil.copy(EXAMPLE / name, folder)
    return folder


@pytest.fixture(scope="module")
def run(libraries: list[str]):
    """``pytpc`` from /, with what is in a folder and the libraries that it depends on."""
    kept = {name: os.environ[name] for name in ("HOME", "LANG", "PATH") if name in os.environ}

    def runs(site: Path, *arguments: object) -> subprocess.CompletedProcess[str]:
        path = os.pathsep.join([str(site), *libraries])
        return subprocess.run(
            [sys.executable, "-S", "-m", "pytpc", *map(str, arguments)],
            env={**kept, "PYTHONPATH": path, "COLUMNS": "200"},
            cwd="/",
            capture_output=True,
            text=True,
            check=False,
            timeout=120,
        )

    return runs


def files_of(folder: Path) -> set[str]:
    return {
        str(path.relative_to(folder.parent))
        for path in folder.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }


def test_a_wheel_has_every_file_of_its_package(wheels):
    for wheel, folder in zip(
        wheels, (ROOT / "pytpc", ROOT / "evaluation/pytpc_evaluation"), strict=True
    ):
        with zipfile.ZipFile(wheel) as archive:
            names = {name for name in archive.namelist() if ".dist-info/" not in name}
        assert names == files_of(folder)


def test_both_wheels_have_the_version_of_the_project(wheels):
    version = (ROOT / "VERSION").read_text().strip()
    assert [wheel.name.split("-")[1] for wheel in wheels] == [version, version]


def test_the_package_is_that_of_the_wheel(product):
    code = "import pytpc, sys; print(pytpc.__file__); print('pytpc_evaluation' in sys.modules)"
    done = subprocess.run(
        [sys.executable, "-S", "-c", code],
        env={"PYTHONPATH": str(product)},
        cwd="/",
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.split() == [str(product / "pytpc/__init__.py"), "False"]


def test_a_mission_is_diagnosed_without_the_repository(run, product, mission, tmp_path):
    static = mission / "static.json"
    listed = run(product, "list", static)
    assert (listed.returncode, "~min_coverage_limit" in listed.stdout) == (0, True), listed.stderr
    ranked = run(product, "rank", mission, "--static", static)
    assert (ranked.returncode, "~min_coverage_limit" in ranked.stdout) == (0, True), ranked.stderr
    page = tmp_path / "page.html"
    reported = run(product, "report", mission, "--static", static, "-o", page)
    assert reported.returncode == 0, reported.stderr
    assert "~min_coverage_limit" in page.read_text()


def test_python_nodes_are_analysed_without_the_repository(run, product, tmp_path):
    node, found = tmp_path / "node.py", tmp_path / "static.json"
    shutil.copy(ROOT / "examples/python_nodes/nodes/cmp_operators.py", node)
    done = run(product, "analyse", node, "-o", found)
    assert done.returncode == 0, done.stderr
    assert done.stdout.endswith(f"6 comparisons in 1 link unit: {found}\n")


def test_it_says_where_the_compilers_half_comes_from(run, product):
    doctor = run(product, "doctor", "--json")
    assert doctor.returncode == 1
    assert "-m pip install --force-reinstall --no-deps WHEEL, with the WHEEL" in doctor.stdout
    wanted = run(product, "toolchain", "cmake")
    assert wanted.returncode == 1
    assert wanted.stderr.count("\n") == 1
    assert "with the WHEEL that `make package` writes in a checkout of TPC" in wanted.stderr


def test_the_evaluation_adds_its_commands(run, wheels, product, tmp_path):
    helped = run(product, "--help").stdout
    assert "  rank " in helped
    for command in ("stats", "study", "survey"):
        assert f"  {command} " not in helped
        refused = run(product, command, "x")
        assert refused.returncode == 1
        assert refused.stderr == (
            f"pytpc: error: `{command}` is in the package pytpc-evaluation; in a checkout of TPC:"
            " pip install ./evaluation\n"
        )
    for wheel in wheels:
        install(wheel, tmp_path / "both")
    both = run(tmp_path / "both", "--help").stdout
    for command in ("stats", "study", "survey"):
        assert f"  {command} " in both
        assert run(tmp_path / "both", command, "--help").returncode == 0
