"""Asking CMake which targets it links."""

import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest
from file_api import reply, target

from pytpc.base.errors import InputError
from pytpc.workspace.cmake_targets import LinkTarget, ask_for_targets, link_targets


def test_linked_targets_are_told_from_others(tmp_path: Path) -> None:
    (tmp_path / "devel").mkdir()
    (tmp_path / "devel/detector").touch()
    reply(
        tmp_path,
        [
            target("detector", "EXECUTABLE"),
            target("archive", "STATIC_LIBRARY"),
            target("cuda", "EXECUTABLE", "CUDA"),
            {"name": "tests", "type": "UTILITY"},
            {"name": "headers", "type": "INTERFACE_LIBRARY"},
            target("common", "SHARED_LIBRARY", "C"),
            target("a_plugin", "MODULE_LIBRARY"),
        ],
    )
    assert link_targets(tmp_path) == [
        LinkTarget("a_plugin", "inner", tmp_path / "devel/a_plugin", is_library=True),
        LinkTarget("common", "face", tmp_path / "devel/common", is_library=True),
        LinkTarget("detector", "face", tmp_path / "devel/detector"),
    ]
    assert [unit.built for unit in link_targets(tmp_path) or ()] == [False, False, True]


def test_without_an_answer_nothing_is_claimed(tmp_path: Path) -> None:
    assert link_targets(tmp_path) is None
    reply(tmp_path, [], {"objects": [{"kind": "cache", "jsonFile": "x"}]})
    assert link_targets(tmp_path) is None


@pytest.mark.parametrize("index", [{}, {"objects": [{}]}, {"objects": 3}])
def test_an_answer_of_another_shape_is_an_input_error(
    tmp_path: Path, index: dict[str, Any]
) -> None:
    reply(tmp_path, [], index)
    with pytest.raises(InputError, match="not an answer of CMake's file API"):
        link_targets(tmp_path)


@pytest.mark.skipif(shutil.which("cmake") is None, reason="cmake is not installed")
def test_cmake_itself_answers(tmp_path: Path) -> None:
    source, binary = tmp_path / "source", tmp_path / "build"
    source.mkdir()
    (source / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.10)\nproject(tiny C)\n"
        "add_executable(node main.c)\nadd_executable(later EXCLUDE_FROM_ALL main.c)\n"
        "add_library(part STATIC main.c)\nadd_custom_target(doc)\n"
        "add_library(objects OBJECT main.c)\n"
        "add_executable(of_objects $<TARGET_OBJECTS:objects>)\n"
        "add_library(core SHARED ../source/main.c)\ntarget_link_libraries(node core)\n",
        encoding="utf-8",
    )
    (source / "main.c").write_text("int main(void) { return 0; }\n", encoding="utf-8")
    ask_for_targets(binary)
    subprocess.run(["cmake", "-S", source, "-B", binary], check=True, capture_output=True)
    subprocess.run(["cmake", "--build", binary], check=True, capture_output=True)
    main = frozenset({source / "main.c"})
    assert link_targets(binary) == [
        LinkTarget(
            "core", "tiny", binary / "libcore.so", binary / "CMakeFiles/core.dir", True, main
        ),
        LinkTarget(
            "later", "tiny", binary / "later", binary / "CMakeFiles/later.dir", sources=main
        ),
        LinkTarget(
            "node",
            "tiny",
            binary / "node",
            binary / "CMakeFiles/node.dir",
            sources=main,
            needs=frozenset({"core"}),
        ),
        LinkTarget("of_objects", "tiny", binary / "of_objects", needs=frozenset({"objects"})),
    ]
    assert [unit.built for unit in link_targets(binary) or ()] == [True, False, True, True]
    assert (binary / "CMakeFiles/node.dir/main.c.o").is_file()
