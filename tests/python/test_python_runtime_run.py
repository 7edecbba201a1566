"""Programs that run with reports: scripts, modules, relays, copies, whole environments."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from pytpc.cli.main import main
from pytpc.ingest.reading import read
from pytpc.python_runtime.listed import names_script, read_table
from pytpc.ros.node_start import command_of, interpreter_of

ROOT = Path(__file__).parents[2]
RUNNER = str(ROOT / "pytpc/python_runtime/run.py")
RELAY = Path("/usr/share/catkin/cmake/templates/script.py.in")

SCRIPT = """\
#!/usr/bin/env python3
\"\"\"A node.\"\"\"
import sys
from pkg import helper
limit = 3
print(sys.argv, __name__, __doc__, sys.path[0], sys.modules["__main__"].limit)
if len(sys.argv) > limit:
    print("many")
print(helper.high(limit))
"""
HELPER = """\
import inspect
def high(x):
    return x > 1
source = inspect.getsource(high)
"""


def comparison(key: str, file: str, lineno: int, column: int, source_code: str) -> dict:
    return {
        "key": key,
        "relation": ">",
        "file": file,
        "lineno": lineno,
        "column": column,
        "name": None,
        "operand": "right",
        "source_code": source_code,
    }


def unit(root: Path, name: str, *comparisons: dict) -> dict:
    return {"link_unit": name, "source_root": str(root), "comparisons": list(comparisons)}


@pytest.fixture
def package(tmp_path) -> Path:
    """A package with a script and a module, and ``static.json`` beside it."""
    root = tmp_path / "src/pkg"
    (root / "nodes").mkdir(parents=True)
    (root / "src/pkg").mkdir(parents=True)
    (root / "nodes/node.py").write_text(SCRIPT)
    (root / "src/pkg/__init__.py").write_text("")
    (root / "src/pkg/helper.py").write_text(HELPER)
    in_node = comparison("node", "nodes/node.py", 7, 4, "if len(sys.argv) > limit:")
    in_helper = ("src/pkg/helper.py", 3, 12, "return x > 1")
    units = [
        unit(root, "node", in_node, comparison("helper of node", *in_helper)),
        unit(root, "other", comparison("helper of other", *in_helper)),
    ]
    (tmp_path / "static.json").write_text(json.dumps({"schema": 1, "units": units}))
    return root


def environment(package: Path, **more: str) -> dict[str, str]:
    folder = package.parents[1]
    ours = {
        "TPC_SINK": "file",
        "TPC_FOLDER": str(folder / "tpc"),
        "TPC_FILE_RESERVE": "0",
        "TPC_STATIC": str(folder / "static.json"),
        "PYTHONPATH": str(package / "src"),
    }
    return {**os.environ, **ours, **more}


def run(
    package: Path, *command: str | Path, cwd: Path | None = None, **more: str
) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [str(word) for word in command],
        env=environment(package, **more),
        cwd=cwd,
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )


def reported(package: Path) -> list[tuple[str, float, float]]:
    files = sorted((package.parents[1] / "tpc").glob("*.tpc"))
    if not files:
        return []
    events = read(files).events
    keys = [events.keys[code] for code in events.key]
    return list(zip(keys, events.cmp.tolist(), events.thresh.tolist(), strict=True))


BOTH = [("node", 2.0, 3.0), ("helper of node", 3.0, 1.0)]


@pytest.mark.usefixtures("python")
def test_a_script_and_its_module(package):
    node = package / "nodes/node.py"
    plain = run(package, sys.executable, node, "a")
    done = run(package, sys.executable, RUNNER, node, "a")
    assert (done.returncode, done.stdout, done.stderr) == (0, plain.stdout, "")
    # Of the module that two programs share, the key of the one that runs.
    assert reported(package) == BOTH
    # Nothing of ours is in the cache: without the hook the module is as it was.
    assert run(package, sys.executable, node, "a").stdout == plain.stdout
    assert len(reported(package)) == 2


@pytest.mark.usefixtures("python")
def test_as_a_module(package):
    path = f"{package / 'src'}{os.pathsep}{ROOT}"
    command = (sys.executable, "-m", "pytpc.python_runtime", package / "nodes/node.py", "a")
    done = run(package, *command, PYTHONPATH=path)
    assert (done.returncode, done.stderr) == (0, "")
    assert reported(package) == BOTH


@pytest.mark.usefixtures("python")
def test_an_error_shows_the_program_alone(package):
    node = package / "nodes/node.py"
    node.write_text(SCRIPT + "def f(x):\n    return x > limit\nf(None)\n")
    plain = run(package, sys.executable, node, "a")
    done = run(package, sys.executable, RUNNER, node, "a")
    assert "TypeError" in plain.stderr
    assert (done.returncode, done.stderr) == (1, plain.stderr)


@pytest.mark.usefixtures("python")
@pytest.mark.parametrize(
    ("line", "status"),
    [
        ("sys.exit(3)", 3),
        ("sys.exit('bye')", 1),
        ("raise KeyboardInterrupt", -2),
        ("sys.excepthook = lambda *a: print('mine', a[0].__name__); 1/0", 1),
        ("import atexit; atexit.register(print, 'at exit'); 1/0", 1),
        ("import threading; threading.Thread(target=lambda: print('thread')).start()", 0),
        ("import pickle\nclass C: pass\nprint(pickle.loads(pickle.dumps(C())).__class__)", 0),
    ],
)
def test_it_ends_as_it_would(package, line, status):
    node = package / "nodes/node.py"
    node.write_text(SCRIPT + line + "\n")
    plain = run(package, sys.executable, node, "a")
    done = run(package, sys.executable, RUNNER, node, "a")
    assert plain.returncode == status
    assert (done.returncode, done.stdout, done.stderr) == (status, plain.stdout, plain.stderr)
    assert reported(package) == BOTH


@pytest.mark.usefixtures("python")
def test_an_installed_copy_is_told_by_its_text(package, tmp_path):
    installed = tmp_path / "install/lib/pkg/node.py"
    installed.parent.mkdir(parents=True)
    installed.write_text(SCRIPT.replace("/usr/bin/env python3", "/usr/bin/python3"))
    assert run(package, sys.executable, RUNNER, installed, "a").stderr == ""
    assert reported(package) == BOTH


def test_another_file_of_the_same_name_is_none(package, tmp_path):
    other = tmp_path / "node.py"
    other.write_text("\n" * 6 + "if 1 > 2: pass\n")
    assert run(package, sys.executable, RUNNER, other).stderr == ""
    assert reported(package) == []


@pytest.mark.usefixtures("python")
def test_a_changed_file_is_said(package):
    node = package / "nodes/node.py"
    node.write_text(SCRIPT.replace("import sys\n", "import os, sys\nimport re\n"))
    done = run(package, sys.executable, RUNNER, node, "a")
    said = "does not report: it has changed since it was analysed; run pytpc analyse again"
    assert done.stderr == f"tpc: {node} {said}\n"
    assert [key for key, *_ in reported(package)] == ["helper of node"]


@pytest.mark.skipif(not RELAY.exists(), reason="catkin is not installed")
@pytest.mark.usefixtures("python")
def test_a_relay_of_catkin(package, tmp_path):
    relay = tmp_path / "devel/lib/pkg/node.py"
    relay.parent.mkdir(parents=True)
    text = RELAY.read_text().replace("@PYTHON_SCRIPT@", str(package / "nodes/node.py"))
    relay.write_text(text.replace("@PYTHON_EXECUTABLE@", "/usr/bin/python3"))
    # catkin's template has no line that keeps `limit` in `__main__`.
    node = package / "nodes/node.py"
    node.write_text(SCRIPT.replace(', sys.modules["__main__"].limit', ", limit"))
    plain = run(package, sys.executable, relay, "a")
    done = run(package, sys.executable, RUNNER, relay, "a")
    assert plain.returncode == 0
    assert (done.stdout, done.stderr) == (plain.stdout, plain.stderr)
    assert reported(package) == BOTH


def keys_of(script: Path, *units: dict) -> list[str]:
    """The keys that apply where ``script`` runs, from static information with these units."""
    static = Path(units[0]["source_root"]) / "units.json"
    static.write_text(json.dumps({"schema": 1, "units": list(units)}))
    table = read_table([str(static)], str(script))
    files = [file for named in table.by_name.values() for file in named]
    return sorted(one.key for file in files for one in file.comparisons)


PYTHON, CPP = {"tool": {"analysis": "python"}}, {"tool": {"llvm": "19"}}


def test_a_script_is_told_by_its_file_whatever_its_unit_is_called(tmp_path):
    def of(key: str, name: str, script: str, **more: object) -> dict:
        found = comparison(key, "src/lib.py", 1, 1, "x")
        return {**unit(tmp_path, name, found), **PYTHON, "script": script, **more}

    (tmp_path / "scripts").mkdir()
    own = tmp_path / "scripts/mission.py"
    own.touch()
    (tmp_path / "link").symlink_to(own)
    cpp = {**unit(tmp_path, "mission", comparison("C++", "src/mission.cpp", 1, 1, "x")), **CPP}
    units = [
        cpp,
        of("own", "scripts/mission.py", "scripts/mission.py", package="one"),
        of("other", "mission", "nodes/mission.py", package="two"),
        of("third", "third", "scripts/third.py", package="one"),
    ]
    assert keys_of(own, *units) == ["own"]
    assert keys_of(tmp_path / "link", *units) == ["own"]
    # Installed: by its name, and its package, which its folder is called after.
    assert keys_of(tmp_path / "install/lib/two/mission.py", *units) == ["other"]
    assert keys_of(tmp_path / "install/lib/two/mission", *units) == ["other"]
    assert keys_of(tmp_path / "copy/mission.py", *units) == ["other", "own"]
    assert keys_of(tmp_path / "copy/unknown.py", *units) == ["other", "own", "third"]
    static = [str(tmp_path / "units.json")]
    assert names_script(static, str(tmp_path / "link"))
    assert names_script(static, "copy/mission.py")
    assert not names_script(static, "copy/unknown.py")


@pytest.mark.usefixtures("python")
def test_a_workspace_that_was_built_is_one_source(package, tmp_path):
    (tmp_path / ".tpc").mkdir()
    (tmp_path / "static.json").rename(tmp_path / ".tpc/static.json")
    # What lies about in the workspace is not asked.
    (tmp_path / "broken.json").write_text("{")
    node = package / "nodes/node.py"
    done = run(package, sys.executable, RUNNER, "--static", tmp_path, node, "a", TPC_STATIC="")
    assert (done.returncode, done.stderr) == (0, "")
    assert reported(package) == BOTH


@pytest.mark.skipif(not RELAY.exists(), reason="catkin is not installed")
@pytest.mark.usefixtures("python")
def test_a_package_of_a_devel_space(package, tmp_path):
    init = package / "src/pkg/__init__.py"
    init.write_text("limit = 5\nis_high = limit > 4\n")
    static = json.loads((tmp_path / "static.json").read_text())
    found = comparison("init", "src/pkg/__init__.py", 2, 11, "is_high = limit > 4")
    static["units"][0]["comparisons"].append(found)
    (tmp_path / "static.json").write_text(json.dumps(static))
    devel = tmp_path / "devel/lib/python3/dist-packages"
    (devel / "pkg").mkdir(parents=True)
    template = RELAY.with_name("__init__.py.in").read_text()
    text = template.replace("@PACKAGE_PYTHONPATH@", str(package / "src"))
    (devel / "pkg/__init__.py").write_text(text)
    words = (sys.executable, RUNNER, package / "nodes/node.py", "a")
    done = run(package, *words, PYTHONPATH=str(devel))
    assert (done.returncode, done.stderr) == (0, "")
    assert reported(package) == [("init", 5.0, 4.0), *BOTH]


@pytest.mark.usefixtures("python")
def test_by_the_environment_alone(package):
    folder = f"{ROOT / 'pytpc/python_runtime/on_path'}{os.pathsep}{package / 'src'}"
    node = package / "nodes/node.py"
    plain = run(package, sys.executable, node, "a")
    done = run(package, sys.executable, node, "a", PYTHONPATH=folder, TPC_PYTHON="1")
    assert (done.returncode, done.stdout, done.stderr) == (0, plain.stdout, "")
    assert reported(package) == BOTH


@pytest.mark.usefixtures("python")
def test_the_environment_leaves_other_programs_alone(package, tmp_path):
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere/sitecustomize.py").write_text("print('theirs')\n")
    other = tmp_path / "other_program.py"
    other.write_text("import sys\nprint(sys.argv, 'pytpc' in sys.modules)\n")
    folder = f"{ROOT / 'pytpc/python_runtime/on_path'}{os.pathsep}{tmp_path / 'elsewhere'}"
    done = run(package, sys.executable, other, PYTHONPATH=folder)
    # Another sitecustomize is run, too; without TPC_PYTHON nothing of ours is imported.
    assert done.stdout == f"theirs\n['{other}'] False\n"


@pytest.mark.usefixtures("python")
def test_errors_are_one_line(package, tmp_path):
    for words, said in [
        ((), "no script given"),
        (("--statik", "x"), "no such option"),
        ((str(tmp_path / "none.py"),), "none.py: cannot be run: No such file"),
        (("--static", str(tmp_path / "none.json"), "x.py"), "none.json: cannot be read"),
        (("--static", str(package / "nodes"), "x.py"), "no static information below"),
        (("--static", str(package / "nodes/node.py"), "x.py"), "not JSON"),
    ]:
        done = run(package, sys.executable, RUNNER, *words)
        assert done.returncode == 1
        assert done.stderr.startswith("pytpc: error: ")
        assert said in done.stderr
        assert len(done.stderr.splitlines()) == 1


def test_pytpc_run_takes_the_interpreter_of_the_script(package, tmp_path):
    node = package / "nodes/node.py"
    assert interpreter_of(node) == [shutil.which("python3")]
    assert command_of(node, ["a", "--b"], [Path("s.json")]) == [
        shutil.which("python3"), RUNNER, "--static", "s.json", "--", str(node), "a", "--b",
    ]  # fmt: skip
    # What is no Python is run as it is.
    program = tmp_path / "program"
    program.write_text("#!/bin/sh\necho $1\n")
    program.chmod(0o755)
    assert command_of(program, ["x"], []) == [str(program), "x"]
    done = run(package, sys.executable, "-m", "pytpc", "run", program, "-x", cwd=ROOT)
    assert (done.returncode, done.stdout) == (0, "-x\n")
    node.write_text('#!/usr/bin/python3 -u "\n')
    assert interpreter_of(node) == ["/usr/bin/python3", "-u", '"']
    node.write_text("#!/usr/bin/python2.7\n")
    done = CliRunner().invoke(main, ["run", str(node)])
    assert done.exit_code == 1
    assert "python2.7 is not installed" in done.output


@pytest.mark.usefixtures("python")
def test_verbose_says_what_reported_and_what_did_not(package):
    node = package / "nodes/node.py"
    text = "class Odd:\n    def __gt__(self, other): return self\nkept = helper.high(Odd())\n"
    node.write_text(SCRIPT + text)
    done = run(package, sys.executable, RUNNER, "--verbose", node, "a")
    said = done.stderr.splitlines()
    assert said[:3] == [
        f"tpc: {node}: 1 comparison reported, 0 not found",
        f"tpc: {package / 'src/pkg/helper.py'}: 1 comparison reported, 0 not found",
        "tpc: 1 outcome not reported: testing the truth could run code of the program",
    ]
    assert said[3].startswith("tpc: reports are in ")
    assert len(said) == 4


@pytest.mark.usefixtures("python")
def test_modules_loaded_twice_and_reloaded(package):
    node = package / "nodes/node.py"
    text = "import importlib\nimportlib.reload(helper)\nhelper.high(0)\nprint(helper.source)\n"
    node.write_text(SCRIPT + text)
    done = run(package, sys.executable, RUNNER, node, "a")
    assert (done.returncode, done.stderr) == (0, "")
    assert "def high(x):\n    return x > 1\n" in done.stdout
    assert reported(package) == [*BOTH, ("helper of node", 0.0, 1.0)]


@pytest.mark.parametrize("options", [[], ["-I"], ["-O", "-W", "error"], ["-X", "dev", "-u"]])
def test_the_interpreters_options(tmp_path, options):
    # The path, the words and the flags are those of the script by itself.
    script = tmp_path / "node.py"
    script.write_text(
        "import sys\nlimit = 3\nprint(sys.path, sys.argv, sys.flags, sys.orig_argv)\n"
        "assert limit > 5, 'not with -O'\n"
    )
    static = tmp_path / "static.json"
    place = comparison("a", "node.py", 4, 8, "assert limit > 5, 'not with -O'")
    static.write_text(json.dumps({"schema": 1, "units": [unit(tmp_path, "node", place)]}))
    hooks = [[], [RUNNER, "--static", static], ["-m", "pytpc.python_runtime", "--static", static]]
    path = {"PYTHONPATH": str(ROOT)}
    plain, by_path, by_name = (
        subprocess.run(
            [sys.executable, *options, *hook, str(script), "a"],
            env={**os.environ, "TPC_SINK": "off", **path},
            capture_output=True,
            text=True,
            check=False,
            timeout=60,
        )
        for hook in hooks
    )
    assert (by_path.returncode, by_path.stdout) == (plain.returncode, plain.stdout)
    # Isolated, there is no PYTHONPATH, and so no such module.
    if options != ["-I"]:
        assert (by_name.returncode, by_name.stdout) == (plain.returncode, plain.stdout)
