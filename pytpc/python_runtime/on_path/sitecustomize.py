"""Makes Python nodes report: this folder on PYTHONPATH, TPC_PYTHON=1, and TPC_STATIC.

It starts a script of the static information again with pytpc/python_runtime/run.py, in the same
process and with the same options of the interpreter; every other program runs as before. It also
runs another sitecustomize that it hides.

Every Python program in such an environment runs this, among them roslaunch and rosparam. It
recognises programs without comparisons before it imports or parses anything.
"""

import os
import sys

# Scripts of entry points, whose names are not in the static information, are smaller.
_ENTRY_BYTES = 4096


def _hidden() -> None:
    """Run the sitecustomize that Python would have found without this folder."""
    from importlib.machinery import PathFinder  # noqa: PLC0415

    here = os.path.dirname(os.path.abspath(__file__))
    others = [path for path in sys.path if os.path.abspath(path or ".") != here]
    spec = PathFinder.find_spec("sitecustomize", others)
    if spec is not None and spec.loader is not None:
        # Like importlib.util.module_from_spec, whose import takes longer than all of this.
        module = type(sys)("sitecustomize")
        module.__spec__, module.__loader__ = spec, spec.loader
        module.__file__ = spec.origin
        sys.modules["sitecustomize"] = module
        spec.loader.exec_module(module)


def _script() -> str:
    """The script that this process should run with reports; empty if there is none."""
    is_on = os.environ.get("TPC_PYTHON", "") not in ("", "0")
    if not is_on or os.environ.get("TPC_PYTHON_STARTED") == str(os.getpid()):
        return ""
    script = sys.argv[0] if getattr(sys, "argv", None) else ""
    if script in ("", "-c", "-m", "-") or sys.version_info < (3, 8):
        return ""
    return script if os.path.isfile(script) else ""


def _may_be_named(script: str, paths: "list[str]") -> bool:
    """Whether the static information contains the script's name, or has to be parsed."""
    try:
        with open(script, "rb") as stream:
            head = stream.read(_ENTRY_BYTES + 1)
        if len(head) <= _ENTRY_BYTES and b"sys.exit(" in head:
            return True
        names = {os.path.basename(path) for path in (script, os.path.realpath(script))}
        if any(map(os.path.isdir, paths)) or not all(map(str.isascii, names)):
            return True
        for path in paths:
            with open(path, "rb") as stream:
                text = stream.read()
            if any(_is_in(text, name.encode()) for name in names):
                return True
    except OSError:
        # The code that reads the file reports the error.
        return True
    return False


def _is_in(text: bytes, name: bytes) -> bool:
    """Whether a JSON string is this name, or ends with a slash and it (with or without .py)."""
    stem = name[:-3] if name.endswith(b".py") else name
    place = text.find(stem)
    while place > 0:
        end = place + len(stem)
        if text[place - 1] in b'"/' and text.startswith((b'"', b'.py"'), end):
            return True
        place = text.find(stem, end)
    return False


def _start(script: str, paths: "list[str]") -> None:
    """Start the script again, if the static information names it."""
    room = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    root = os.path.dirname(os.path.dirname(room))
    run = os.path.join(room, "run.py")
    if os.path.realpath(script) == os.path.realpath(run):
        return
    sys.path.insert(0, root)
    try:
        from pytpc.python_runtime.errors import HookError  # noqa: PLC0415
        from pytpc.python_runtime.listed import names_script  # noqa: PLC0415
    finally:
        sys.path.remove(root)
    try:
        if not names_script(paths, script):
            return
    except HookError as error:
        sys.stderr.write(f"tpc: {error}; nothing is reported\n")
        return
    from subprocess import _args_from_interpreter_flags  # type: ignore[attr-defined]  # noqa: PLC0415

    os.environ["TPC_PYTHON_STARTED"] = str(os.getpid())
    flags = _args_from_interpreter_flags()
    os.execv(sys.executable, [sys.executable, *flags, run, "--", script, *sys.argv[1:]])


def _begin() -> None:
    script = _script()
    paths = [path for path in os.environ.get("TPC_STATIC", "").split(os.pathsep) if path]
    if script and _may_be_named(script, paths):
        _start(script, paths)


_hidden()
_begin()
