"""What a person types for each tool, as words and as text for a shell."""

import json
import shlex
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from packages import install_prefix

from pytpc.cli.main import main
from pytpc.workspace.toolchain import Choices, Way, shell_line, shown, steps

PREFIX = Path("/opt/it's tpc")
CMAKE_FILE = "/opt/it's tpc/share/tpc/cmake/tpc.cmake"


@pytest.mark.parametrize("way", list(Way))
def test_a_shell_reads_the_words_that_are_meant(way: Way) -> None:
    found = steps(way, PREFIX, Choices(Path("/r/my rules.json"), "thesis", True))
    lines = [line for line in shown(way, found).splitlines() if not line.startswith("#")]
    assert [tuple(shlex.split(line)) for line in lines] == [step.command for step in found]
    text = " ".join(word for step in found for word in step.command)
    for chosen in ("TPC_RULES=/r/my rules.json", "TPC_PROFILE=thesis", "TPC_CONSTANTS=ON"):
        assert text.count(chosen) == 1


@pytest.mark.parametrize("way", [Way.CATKIN_MAKE, Way.CATKIN_TOOLS, Way.CMAKE])
def test_cmake_gets_the_toolchain_and_nothing_that_was_not_chosen(way: Way) -> None:
    words = [word for step in steps(way, PREFIX, Choices()) for word in step.command]
    assert words.count(f"-DCMAKE_TOOLCHAIN_FILE={CMAKE_FILE}") == 1
    assert not any("TPC_" in word for word in words)


def test_the_mixin_is_named_by_an_address() -> None:
    (add, update, build, _) = steps(Way.COLCON, PREFIX, Choices())
    # A space and an apostrophe, as RFC 3986 writes them.
    address = "file:///opt/it%27s%20tpc/share/tpc/colcon/index.yaml"
    assert add.command == ("colcon", "mixin", "add", "tpc", address)
    assert (add.once, update.once, build.once) == (True, True, False)
    assert build.command == ("colcon", "build", "--mixin", "tpc")


def test_of_an_assignment_only_the_value_is_quoted() -> None:
    assert shell_line(["export", "CC=/a b/cc"]) == "export CC='/a b/cc'"
    assert shell_line(["cmake", "-DX=a b", "plain"]) == "cmake '-DX=a b' plain"


@pytest.fixture
def prefix(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("TPC_PREFIX", str(tmp_path / "prefix"))
    return install_prefix(tmp_path / "prefix")


def run(*arguments: str) -> Result:
    return CliRunner().invoke(main, ["toolchain", *arguments])


def test_all_tools_are_told_unless_one_is_named(prefix: Path) -> None:
    everything = run()
    assert everything.exit_code == 0
    assert everything.stdout.count("\n\n#") == 4
    one = run("cmake")
    assert one.stdout in everything.stdout
    assert one.stdout.splitlines()[2].startswith("cmake -S . -B build_tpc -DCMAKE_TOOLCHAIN_FILE=")


def test_json_has_the_words_unquoted(prefix: Path, tmp_path: Path) -> None:
    data = json.loads(run("cmake", "--json", "--constants").stdout)
    assert [entry["tool"] for entry in data] == ["cmake"]
    first = data[0]["steps"][0]
    assert first["purpose"] == "configures"
    assert first["command"][5] == f"-DCMAKE_TOOLCHAIN_FILE={prefix}"
    assert first["command"][-1] == "-DTPC_CONSTANTS=ON"


def test_what_cannot_work_is_said_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, prefix: Path
) -> None:
    rules = tmp_path / "rules.json"
    rules.write_text('{"reads": 1}', encoding="utf-8")
    broken = run("cmake", "--rules", str(rules))
    assert (broken.exit_code, broken.stdout) == (1, "")
    assert broken.stderr.startswith(f"pytpc: error: {rules}: ")
    prefix.unlink()
    absent = run("cmake")
    assert (absent.exit_code, absent.stdout) == (1, "")
    assert "make setup" in absent.stderr
