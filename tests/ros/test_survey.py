"""A survey with real builds: a tree with a broken package, and one that stands on it."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from test_build_workspace import CMAKELISTS, MANIFEST, NODE

WITH_TINY = CMAKELISTS.replace("roscpp std_msgs)", "roscpp std_msgs tiny)", 1)


def add(tree: Path, name: str, needs: str = "", node: str = NODE, lists: str = CMAKELISTS) -> None:
    package = tree / name
    (package / "src").mkdir(parents=True)
    more = f"<depend>{needs}</depend></package>" if needs else "</package>"
    manifest = MANIFEST.replace("tiny", name).replace("</package>", more)
    (package / "package.xml").write_text(manifest, encoding="utf-8")
    own = lists.replace("project(tiny)", f"project({name})").replace("tiny_node", f"{name}_node")
    (package / "CMakeLists.txt").write_text(own, encoding="utf-8")
    (package / "src/node.cpp").write_text(node, encoding="utf-8")


def command(output: Path, *arguments: str | Path) -> list[str]:
    words = [sys.executable, "-m", "pytpc", "survey", "--jobs", "2", "-o", output, *arguments]
    return [str(word) for word in words]


def surveyed(output: Path, *arguments: str | Path) -> list[Any]:
    ran = subprocess.run(
        command(output, "--json", *arguments), capture_output=True, text=True, check=True
    )
    data = json.loads(ran.stdout)
    assert isinstance(data, list)
    return data


def result_files(output: Path) -> dict[str, int]:
    folder = output / "results"
    found = folder.iterdir() if folder.is_dir() else ()
    return {path.name.rpartition("-")[0]: path.stat().st_mtime_ns for path in found}


def test_two_trees_interrupted_and_resumed(tmp_path: Path) -> None:
    lower, upper, output = tmp_path / "lower tree", tmp_path / "upper", tmp_path / "out put"
    add(lower, "tiny")
    add(lower, "bad", node=NODE.replace("limit_) {", "limits_) {"))
    add(lower, "after", needs="bad")
    # CMake finds the package tiny only where the first tree's install is.
    add(upper, "user", needs="tiny", lists=WITH_TINY)
    with subprocess.Popen(command(output, upper, lower), stderr=subprocess.DEVNULL) as survey:
        end = time.monotonic() + 240
        builds = output / "builds"
        while not list(builds.glob("upper-*/*/log/*/user")) and time.monotonic() < end:
            assert survey.poll() is None
            time.sleep(0.05)
        survey.send_signal(signal.SIGINT)
        assert survey.wait(timeout=60) == 130
    first = result_files(output)
    assert list(first) == ["lower tree"]
    assert not left_running(output)

    user, tiny = surveyed(output, upper, lower)
    assert result_files(output)["lower tree"] == first["lower tree"]
    assert (tiny["name"], tiny["packages"]) == ("lower tree", 3)
    for way in ("plain", "tpc"):
        reasons = {fault["package"]: fault["reason"] for fault in tiny[way]["not_built"]}
        assert list(reasons) == ["after", "bad"]
        assert "use of undeclared identifier 'limits_'" in reasons["bad"]
        assert reasons["after"].startswith("skipped")
    for tree in (user, tiny):
        # One comparison, on line 10, with one parameter; NODE has 26 lines, all of code.
        assert tree["found"]["comparisons"] == 1
        assert (tree["found"]["parameters"], tree["found"]["files"]) == (1, 1)
        assert tree["found"]["without"] == tree["found"]["failed"] == []
        assert tree["found"]["python"] == 0
        for way in ("plain", "tpc"):
            times = tree[way]
            assert 0 < times["compile"] < times["processor"]
        assert tree["processor_factor"] > 0
    assert user["tpc"]["not_built"] == []
    assert user["lines"]["languages"]["C++"] == {
        "files": 1,
        "code": 26,
        "comment": 0,
        "blank": 0,
    }
    assert sorted(path.name for path in lower.iterdir()) == ["after", "bad", "tiny"]
    assert "| lower tree |" in (output / "survey.md").read_text(encoding="utf-8")


def test_the_plain_build_is_plain_and_a_cmake_project_is_surveyed(tmp_path: Path) -> None:
    tree, output = tmp_path / "counter", tmp_path / "out"
    tree.mkdir()
    (tree / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.10)\nproject(counter C CXX)\n"
        "add_library(sum STATIC sum.c)\nadd_executable(count count.cpp)\n"
        "target_link_libraries(count sum)\ninstall(TARGETS count DESTINATION bin)\n",
        encoding="utf-8",
    )
    (tree / "sum.c").write_text("int sum(int a) { return a + 1; }\n", encoding="utf-8")
    (tree / "count.cpp").write_text(
        'extern "C" int sum(int);\nint main() { return sum(-1); }\n', encoding="utf-8"
    )
    (counter,) = surveyed(output, tree, "--cmake-arg", "-DCOUNTED_BY=survey")
    assert (counter["found"]["units"], counter["tpc"]["not_built"]) == (1, [])
    assert counter["lines"]["languages"]["C++"]["files"] == 2
    (folder,) = (output / "builds").iterdir()
    for way in ("plain", "tpc"):
        built = folder / way / "build/counter"
        assert subprocess.run([built / "count"], check=False).returncode == 0
        # Two compilers and one linker (ar is none), each with user and system time.
        noted = (folder / way / "launch/seconds").read_text("ascii").split()
        assert len(noted) == 2 * 3
        (obj,) = built.glob("CMakeFiles/count.dir/*.o")
        assert obj.read_bytes().startswith(b"\x7fELF") == (way == "plain")
        cache = (built / "CMakeCache.txt").read_text("utf-8")
        assert ("tpc.cmake" in cache) == (way == "tpc")
        assert "COUNTED_BY:UNINITIALIZED=survey" in cache


def test_packages_that_need_each_other_are_said_to_be_the_reason(tmp_path: Path) -> None:
    ring, output = tmp_path / "ring", tmp_path / "out"
    add(ring, "one", needs="two")
    add(ring, "two", needs="one")
    (tree,) = surveyed(output, ring)
    assert tree["processor_factor"] is None
    reasons = {fault["package"]: fault["reason"] for fault in tree["tpc"]["not_built"]}
    assert list(reasons) == ["one", "two"]
    assert "topological" in reasons["one"]


def left_running(output: Path) -> list[str]:
    """Command lines of processes that work in the output folder."""
    found: list[str] = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            line = (folder / "cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace")
        except OSError:
            continue
        if str(output / "builds") in line and int(folder.name) != os.getpid():
            found.append(line)
    return found
