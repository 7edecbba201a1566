"""The flags of the build, from what CMake leaves."""

import json
from pathlib import Path
from typing import Any

import pytest
from file_api import reply, target
from static_units import unit

from pytpc.conditions.compile_flags import flags_for, meaningful
from pytpc.static.link_unit import LinkUnit

ROOT = "/ws/src/face"
GROUP: dict[str, Any] = {
    "language": "CXX",
    "compileCommandFragments": [
        {"fragment": "-O2 -g -DNDEBUG -Wall -Werror"},
        {"fragment": "-std=gnu++17"},
    ],
    "defines": [{"define": 'NAME="a b"'}],
    "includes": [
        {"path": "/ws/src/face/include"},
        {"path": "/usr/include/eigen3", "isSystem": True},
    ],
}


def link_unit(folder: Path | None, name: str = "detector") -> LinkUnit:
    data = unit(link_unit=name, source_root=ROOT)
    if folder is not None:
        data["build_folder"] = str(folder)
    return LinkUnit.from_json(data, Path("x.json"))


def with_sources(name: str, *sources: str, **group: Any) -> dict[str, Any]:
    return {
        **target(name, "EXECUTABLE"),
        "compileGroups": [{**GROUP, **group}],
        "sources": [{"path": path, "compileGroupIndex": 0} for path in sources],
    }


def answer(folder: Path, *targets: dict[str, Any]) -> None:
    reply(folder, list(targets))
    model = folder / ".cmake/api/v1/reply/codemodel-v2-1.json"
    data = json.loads(model.read_text(encoding="utf-8"))
    data["paths"] = {"source": ROOT, "build": str(folder)}
    model.write_text(json.dumps(data), encoding="utf-8")


def test_a_source_has_the_flags_of_its_group(tmp_path: Path) -> None:
    answer(tmp_path, with_sources("detector", "src/a.cpp"), with_sources("x"))
    flags = flags_for(f"{ROOT}/src/a.cpp", link_unit(tmp_path))
    assert flags.of_build
    assert flags.arguments == (
        *("-x", "c++", "-DNDEBUG", "-std=gnu++17", '-DNAME="a b"'),
        *("-I", "/ws/src/face/include", "-isystem", "/usr/include/eigen3"),
    )


def test_the_units_own_target_comes_first(tmp_path: Path) -> None:
    answer(
        tmp_path,
        with_sources("a_fault", "src/a.cpp", defines=[{"define": "FAULT"}]),
        with_sources("detector", "src/a.cpp", defines=[]),
        with_sources("part", "src/part.cpp", defines=[{"define": "PART"}]),
    )
    assert "-DFAULT" not in flags_for(f"{ROOT}/src/a.cpp", link_unit(tmp_path)).arguments
    assert "-DFAULT" in flags_for(f"{ROOT}/src/a.cpp", link_unit(tmp_path, "a_fault")).arguments
    # A static library of the package that was linked into the unit.
    assert "-DPART" in flags_for(f"{ROOT}/src/part.cpp", link_unit(tmp_path)).arguments


def test_a_header_has_the_flags_of_the_unit(tmp_path: Path) -> None:
    answer(tmp_path, with_sources("detector", "src/a.cpp"), with_sources("x"))
    flags = flags_for("/ws/src/common/include/common/limits.h", link_unit(tmp_path))
    assert flags.of_build
    assert "-std=gnu++17" in flags.arguments


def test_compile_commands_are_the_second_choice(tmp_path: Path) -> None:
    commands = [
        {"directory": ROOT, "file": "src/a.cpp", "command": "clang++ -DA='1 2' -c src/a.cpp"},
        {"directory": ROOT, "file": "src/b.cpp", "arguments": ["clang++", "-DB", "-o", "b.o"]},
    ]
    (tmp_path / "compile_commands.json").write_text(json.dumps(commands), encoding="utf-8")
    assert flags_for(f"{ROOT}/src/a.cpp", link_unit(tmp_path)).arguments == ("-x", "c++", "-DA=1 2")
    assert flags_for(f"{ROOT}/src/b.cpp", link_unit(tmp_path)).arguments == ("-x", "c++", "-DB")
    assert flags_for(f"{ROOT}/src/c.h", link_unit(tmp_path)).arguments == ("-x", "c++", "-DA=1 2")


@pytest.mark.parametrize("broken", ["", "[3]", '{"objects": [{"kind": "codemodel"}]}', "[]"])
def test_answers_that_cannot_be_read_cost_the_flags_alone(tmp_path: Path, broken: str) -> None:
    folder = tmp_path / ".cmake/api/v1/reply"
    folder.mkdir(parents=True)
    (folder / "index-1.json").write_text(broken, encoding="utf-8")
    (tmp_path / "compile_commands.json").write_text(broken, encoding="utf-8")
    flags = flags_for(f"{ROOT}/src/a.c", link_unit(tmp_path))
    assert not flags.of_build
    assert flags.arguments[:2] == ("-x", "c")
    assert f"{ROOT}/include" in flags.arguments
    assert flags_for(f"{ROOT}/src/a.c", link_unit(None)) == flags


def test_what_is_kept_of_a_command_line() -> None:
    kept = "-DA -D B -I/i -isystem /s -std=c++17 -fopenmp -pthread -include /pch.hxx"
    lost = "-O3 -g -Wall -Werror -flto=full -fpass-plugin=/x.so -fuse-ld=lld -o a.o -c a.cpp -MD"
    assert meaningful(f"clang++ {lost} {kept}".split()) == kept.split()
    # As CMake writes a precompiled header for clang.
    pch = "-Xclang -include-pch -Xclang /p.pch -Xclang -include -Xclang /p.hxx"
    assert meaningful(pch.split()) == ["-include", "/p.hxx"]
    assert meaningful(["-I"]) == []
