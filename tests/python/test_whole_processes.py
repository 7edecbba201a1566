"""Processes whose libraries need one another, are opened, or are too large; no ROS is needed."""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from packages import add_package
from test_process_parts import compiled

from pytpc.base.errors import MissingToolError
from pytpc.base.paths import plugin, prefix
from pytpc.build.reconcile import Recorded
from pytpc.processes.analysis import Analysed, Budget, analyse_processes
from pytpc.processes.corrections import Corrections
from pytpc.processes.process import Process, Processes, Unit
from pytpc.processes.processes import Search
from pytpc.workspace.colcon import Bases

RPATH = "-Wl,-rpath,$ORIGIN"


def found_in(workspace: Path, folder: Path) -> Processes:
    """The processes of the programs and libraries of a folder, as those of a built package."""
    add_package(workspace / "src/arm")
    bases = Bases.of(workspace)
    build = bases.build / "arm"
    (build / "tpc").mkdir(parents=True)
    (build / "CMakeCache.txt").touch()
    bases.install.mkdir()
    (bases.install / "setup.bash").touch()
    files = [path for path in sorted(folder.iterdir()) if os.access(path, os.X_OK)]
    lines = [
        f"arm\t{path.name}\t{path}\t{build / 'tpc' / path.name}.json\t\n"
        for path in files
        if "Poco" not in path.name
    ]
    (build / "tpc/targets.tsv").write_text("".join(lines))
    return Search.begin(workspace, bases, ()).found({}, Corrections())


def names(units: tuple[Unit, ...]) -> list[str]:
    return [unit.name for unit in units]


def test_libraries_that_need_one_another_are_in_a_process_once(tmp_path):
    folder = tmp_path / "lib"
    folder.mkdir()
    compiled(folder, "libone.so", "int one() { return 1; }")
    compiled(folder, "libtwo.so", "int two() { return 1; }", "-lone", RPATH)
    compiled(folder, "libone.so", "int one() { return 1; }", "-ltwo", RPATH)
    compiled(folder, "drive", "int main() {}", "-lone", RPATH)
    found = found_in(tmp_path / "ws", folder)
    assert found.faults == (
        "libraries need one another in a circle: libone.so -> libtwo.so -> libone.so",
    )
    assert [(one.name, names(one.units)) for one in found.found] == [
        ("arm/drive", ["drive", "libone.so", "libtwo.so"])
    ]


@pytest.mark.parametrize("for_all", [False, True])
def test_a_library_that_is_opened_comes_after_those_that_are_needed(tmp_path, for_all):
    folder = tmp_path / "lib"
    folder.mkdir()
    compiled(folder, "libdeep.so", "int deep() { return 1; }")
    compiled(folder, "libnear.so", "int near() { return 1; }")
    compiled(folder, "libplug.so", "int plug() { return 1; }", "-ldeep", "-lnear", RPATH)
    compiled(folder, "libPocoFoundation.so", "int poco() { return 1; }")
    main = 'const char *name() { return "libplug.so"; } int main() { return name()[0]; }'
    poco = ["-lPocoFoundation"] if for_all else []
    compiled(folder, "drive", main, "-lnear", *poco, RPATH)
    (process,) = found_in(tmp_path / "ws", folder).found
    everything = ["drive", "libnear.so", "libplug.so", "libdeep.so"]
    assert names(process.units) == everything
    needed, opened = everything[:2], ["libplug.so", "libdeep.so", "libnear.so"]
    assert list(map(names, process.scopes)) == ([everything] if for_all else [needed, opened])
    assert process.named_scopes[0][0] == "arm/drive"


def file(path: Path, kind: str, *, lazy: bool = False) -> dict[str, Any]:
    """An object in the manifest of a link."""
    return {"path": str(path), "kind": kind, "whole_archive": False, "lazy": lazy}


def analysed(
    tmp_path: Path, texts: dict[str, str], more: Sequence[dict[str, Any]] = ()
) -> Analysed:
    """The analysis of a process of units with this code in LLVM's language.

    The first unit has the objects ``more``, too.
    """
    try:
        plugin()
    except MissingToolError as error:
        pytest.skip(f"the C++ half is not installed: {error}")
    if not (prefix() / "bin/tpc-merge").is_file():
        pytest.skip("the C++ half is not installed")
    units = []
    for name, text in texts.items():
        code = tmp_path / f"{name}.o"
        command = ["llvm-as-19", "-o", code]
        subprocess.run(command, input=text, text=True, check=True)
        unit = Unit("arm", name, code, Recorded("arm", name, code, tmp_path / f"{name}.json", ""))
        objects = [file(code, "bitcode"), *([] if units else more)]
        options = {"profile": "default", "rules": [], "excluded": [], "constants": False}
        manifest = {"schema": 1, "source_root": str(tmp_path)}
        unit.manifest.write_text(json.dumps({**manifest, "objects": objects, "options": options}))
        units.append(unit)
    process = Process("arm/drive", "arm/drive", None, tuple(units))
    (found,) = analyse_processes([process], tmp_path, Budget(600))
    return found


# main calls f0, which calls f1, and so on.
@pytest.mark.parametrize(("count", "is_large"), [(20, False), (100_000, True)])
def test_a_process_of_too_many_functions_is_said_and_has_no_plan(tmp_path, count, is_large):
    chain = [f"define void @f{n}() {{\n call void @f{n + 1}()\n ret void\n}}" for n in range(count)]
    chain[-1] = f"define void @f{count - 1}() {{\n ret void\n}}"
    main = "declare void @f0()\ndefine i32 @main() {\n call void @f0()\n ret i32 0\n}\n"
    found = analysed(tmp_path, {"drive": main, "libfar.so": "\n".join([*chain, ""])})
    assert found.left_out == ()
    if is_large:
        assert found.failure == "too large to be analysed as a whole: 100,001 functions"
        assert found.plan is None
    else:
        assert found.failure is None
        assert found.plan is not None


# The object without bitcode needs the member `far`; the other member is not needed.
def test_an_object_without_bitcode_is_said_and_the_rest_is_analysed(tmp_path):
    native = tmp_path / "native.o"
    for path, text in ((native, "void far(); void near() { far(); }"), (tmp_path / "spare.o", "")):
        command = ["c++", "-x", "c++", "-", "-c", "-o", path]
        subprocess.run(command, input=text, text=True, check=True)
    main = "declare void @_Z4nearv()\ndefine i32 @main() {\n call void @_Z4nearv()\n ret i32 0\n}\n"
    far = tmp_path / "far.o"
    code = "define void @_Z3farv() {\n ret void\n}\n"
    subprocess.run(["llvm-as-19", "-o", far], input=code, text=True, check=True)
    spare = file(tmp_path / "spare.o", "native", lazy=True)
    more = [file(native, "native"), file(far, "bitcode", lazy=True), spare]
    other = "define void @other() {\n ret void\n}\n"
    found = analysed(tmp_path, {"drive": main, "libother.so": other}, more)
    assert found.left_out == (f"{native}: has no bitcode",)
    assert found.plan is not None
    assert found.functions["arm/drive"] == {"main", "_Z3farv"}
