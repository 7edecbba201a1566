"""Programs that report because of the environment: scripts of entry points, and no others."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from pytpc.ingest.reading import read
from pytpc.python_runtime.listed import names_script, program_of, read_table

ROOT = Path(__file__).parents[2]
RUN = str(ROOT / "pytpc/python_runtime/run.py")
MODULE = """\
import sys
def main():
    limit = 2
    if len(sys.argv) > limit:
        print("many")
"""
# What setuptools and pip write when a package is installed, but for how the function is found.
BY_SETUPTOOLS = """\
#!/usr/bin/python3
# EASY-INSTALL-ENTRY-SCRIPT: 'talk==0.1.0','console_scripts','talker_node'
import sys
from importlib.metadata import distribution

if __name__ == '__main__':
    points = distribution('talk').entry_points
    sys.exit([one for one in points if one.name == 'talker_node'][0].load()())
"""
BY_PIP = """\
#!/usr/bin/python3
import sys
from talk.talker import main
if __name__ == '__main__':
    sys.exit(main())
"""


def unit(root: Path, name: str, script: str) -> dict:
    comparison = {
        "key": f"of {script}",
        "relation": ">",
        "file": "talk/talker.py",
        "lineno": 4,
        "column": 8,
        "name": "limit",
        "operand": "right",
        "source_code": "if len(sys.argv) > limit:",
    }
    found = {"link_unit": name, "package": "talk", "script": script, "source_root": str(root)}
    return {**found, "tool": {"analysis": "python"}, "comparisons": [comparison]}


@pytest.fixture
def static(tmp_path) -> Path:
    """Two scripts share the module; one is the module itself. The package is installed."""
    root = tmp_path / "src/talk"
    for folder in (root / "talk", tmp_path / "site/talk"):
        folder.mkdir(parents=True)
        (folder / "__init__.py").write_text("")
        (folder / "talker.py").write_text(MODULE)
    info = tmp_path / "site/talk-0.1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: talk\nVersion: 0.1.0\n")
    points = "[console_scripts]\ntalker_node = talk.talker:main\nother = talk.other:main\n"
    (info / "entry_points.txt").write_text(points)
    units = [unit(root, "tool", "scripts/tool.py"), unit(root, "talker", "talk/talker.py")]
    path = tmp_path / "static.json"
    path.write_text(json.dumps({"schema": 1, "units": units}))
    return path


def script(folder: Path, text: str, name: str = "talker_node") -> Path:
    path = folder / "lib/talk" / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


def run(static: Path, *command: str | Path, cwd: Path | None = None, **more: str) -> str:
    """The output; the environment is that of `pytpc env`."""
    on_path = ROOT / "pytpc/python_runtime/on_path"
    ours = {
        "PYTHONPATH": f"{on_path}{os.pathsep}{static.parent / 'site'}",
        "TPC_PYTHON": "1",
        "TPC_STATIC": str(static),
        "TPC_SINK": "file",
        "TPC_FOLDER": str(static.parent / "tpc"),
        "TPC_FILE_RESERVE": "0",
    }
    done = subprocess.run(
        list(map(str, command)),
        env={**os.environ, **ours, **more},
        cwd=cwd,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=True,
        timeout=60,
    )
    return done.stdout


def reported(static: Path) -> list[tuple[str, float, float]]:
    files = sorted((static.parent / "tpc").glob("*.tpc"))
    if not files:
        return []
    events = read(files).events
    keys = [events.keys[code] for code in events.key]
    return list(zip(keys, events.cmp.tolist(), events.thresh.tolist(), strict=True))


@pytest.mark.parametrize("text", [BY_SETUPTOOLS, BY_PIP], ids=["setuptools", "pip"])
def test_the_module_of_an_entry_point_reports(static, tmp_path, text):
    path = script(tmp_path, text)
    assert run(static, sys.executable, path, "a", "b") == "many\n"
    # By the key of the unit that is the module, and not of another one that imports it.
    assert reported(static) == [("of talk/talker.py", 3.0, 2.0)]


def test_what_a_script_runs(static, tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(tmp_path / "site"))
    for text in (BY_SETUPTOOLS, BY_PIP):
        program = program_of(str(script(tmp_path, text)))
        assert program == ("talker_node", "talk.talker")
        assert program.files == ("/talk/talker.py", "/talk/talker/__init__.py")
    # An entry point that its package does not declare, a package that is not there.
    for old, new in (("talker_node", "gone"), ("talk==", "gone==")):
        assert program_of(str(script(tmp_path, BY_SETUPTOOLS.replace(old, new)))).module is None
    # Any program may import a function, and end with sys.exit; only short ones are looked into.
    assert program_of(str(script(tmp_path, MODULE, "talker.py"))) == ("talker", None)
    assert program_of(str(script(tmp_path, BY_PIP + "#" * 4096))).module is None
    assert program_of(str(tmp_path / "none.py")) == ("none", None)


def test_scripts_of_other_packages_entry_points_are_none_of_ours(static, tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(tmp_path / "site"))
    other = BY_SETUPTOOLS.replace("talker_node", "other")
    assert not names_script([str(static)], str(script(tmp_path, other, "other")))
    named = script(tmp_path, BY_PIP.replace("talk.talker", "chat.talker"), "chat")
    assert not names_script([str(static)], str(named))
    # Of a script that has the name of one that was analysed it counts.
    assert names_script([str(static)], str(script(tmp_path, "import talk\n", "tool.py")))


def keys_of(static: Path, path: Path) -> set[str]:
    files = [
        file for named in read_table([str(static)], str(path)).by_name.values() for file in named
    ]
    return {one.key for file in files for one in file.comparisons}


def test_an_entry_point_has_the_keys_of_its_unit(static, tmp_path):
    path = script(tmp_path, BY_PIP)
    assert keys_of(static, path) == {"of talk/talker.py"}
    # Another entry point begins in the same module, at another function.
    document = json.loads(static.read_text())
    second = unit(tmp_path / "src/talk", "talker_node", "talk/talker.py")
    second["comparisons"][0]["key"] = "of talker_node"
    document["units"].append(second)
    static.write_text(json.dumps(document))
    assert keys_of(static, path) == {"of talker_node"}
    # Only a module that it imports has comparisons: it is a node all the same.
    for one in document["units"]:
        one["comparisons"][0]["file"] = "talk/limits.py"
    static.write_text(json.dumps({**document, "units": document["units"][1:2]}))
    assert names_script([str(static)], str(path))
    # Without the unit of its own, those that share the module.
    document["units"] = [unit(tmp_path / "src/talk", "tool", "scripts/tool.py")]
    static.write_text(json.dumps(document))
    assert keys_of(static, path) == {"of scripts/tool.py"}


@pytest.mark.parametrize(
    ("name", "imported"),
    [
        ("roslaunch", False),
        ("alker", False),
        ("tool", True),
        # Installed under another name, as a link to it.
        ("link", True),
    ],
)
def test_programs_without_comparisons_import_nothing_of_ours(static, tmp_path, name, imported):
    text = "import sys\nprint('pytpc.python_runtime.listed' in sys.modules)\n"
    path = script(tmp_path, text, "tool.py" if name == "link" else name)
    if name == "link":
        path.with_name(name).symlink_to(path)
        path = path.with_name(name)
    assert run(static, sys.executable, path) == f"{imported}\n"


def test_a_static_file_that_is_gone_is_said_and_no_program_ends(static, tmp_path):
    static.unlink()
    path = script(tmp_path, "print('done')\n", "tool.py")
    said = run(static, sys.executable, path).splitlines()
    assert said[0].startswith(f"tpc: {static}: cannot be read")
    assert said[1:] == ["done"]


@pytest.mark.parametrize("where", ["above the script", "above its link", "above this folder"])
def test_the_workspace_around_a_script_is_found(static, tmp_path, where):
    """Without --static and TPC_STATIC; it is printed with --verbose only."""
    built = tmp_path / "ws/.tpc/static.json"
    built.parent.mkdir(parents=True)
    static.rename(built)
    real = script(tmp_path / "ws/devel", BY_PIP) if where == "above its link" else None
    place = tmp_path / ("ws/install" if where == "above the script" else "elsewhere")
    path = script(place, BY_PIP)
    if real is not None:
        path.unlink()
        path.symlink_to(real)
    here = tmp_path / "ws/devel" if where == "above this folder" else tmp_path
    here.mkdir(exist_ok=True, parents=True)
    off = {"TPC_STATIC": "", "TPC_PYTHON": ""}
    said = run(static, sys.executable, RUN, path, "a", "b", cwd=here, **off)
    assert said == "many\n"
    assert reported(static) == [("of talk/talker.py", 3.0, 2.0)]
    said = run(static, sys.executable, RUN, "--verbose", path, "a", "b", cwd=here, **off)
    assert said.splitlines()[0] == f"tpc: the static information is {built}"


def test_a_workspace_that_is_found_broken_ends_no_program(static, tmp_path):
    built = tmp_path / ".tpc/static.json"
    built.parent.mkdir()
    built.write_text("{")
    off = {"TPC_STATIC": "", "TPC_PYTHON": ""}
    said = run(static, sys.executable, RUN, script(tmp_path, BY_PIP), "a", "b", cwd=tmp_path, **off)
    assert said.splitlines()[0].startswith(f"tpc: {built}:1: not JSON")
    assert said.splitlines()[-1] == "many"
    assert reported(static) == []


def test_a_node_that_is_called_like_the_runner(static, tmp_path):
    """`pytpc run` after `pytpc env`: the runner must not be mistaken for the node."""
    document = json.loads(static.read_text())
    document["units"] = [unit(tmp_path / "src/talk", "run", "nodes/run.py")]
    static.write_text(json.dumps(document))
    node = script(tmp_path, "import os\nfrom talk.talker import main\nmain()\n", "run.py")
    node.write_text(node.read_text() + "print('TPC_PYTHON_STARTED' in os.environ)\n")
    assert run(static, sys.executable, RUN, node, "a", "b") == "many\nFalse\n"
    assert reported(static) == [("of nodes/run.py", 3.0, 2.0)]
