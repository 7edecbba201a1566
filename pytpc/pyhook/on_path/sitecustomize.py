"""Lets Python nodes report: this folder on PYTHONPATH, TPC_PYTHON=1, and TPC_STATIC.

A script of the static information is started again by pytpc/run.py, in the same process and with
the same options of the interpreter; every other program goes on as it was. Another sitecustomize,
which this one hides, is run as well.
"""

import os
import sys


def _hidden() -> None:
    """Run the sitecustomize that would have been found without this folder."""
    import importlib.machinery  # noqa: PLC0415
    import importlib.util  # noqa: PLC0415

    here = os.path.dirname(os.path.abspath(__file__))
    others = [path for path in sys.path if os.path.abspath(path or ".") != here]
    spec = importlib.machinery.PathFinder.find_spec("sitecustomize", others)
    if spec is not None and spec.loader is not None:
        module = importlib.util.module_from_spec(spec)
        sys.modules["sitecustomize"] = module
        spec.loader.exec_module(module)


def _is_wanted() -> bool:
    """Whether this process is to report, and was not started for it already."""
    is_on = os.environ.get("TPC_PYTHON", "") not in ("", "0")
    return is_on and os.environ.get("TPC_PYTHON_STARTED") != str(os.getpid())


def _start() -> None:
    """Start the script again, where its name is among the static information's."""
    script = sys.argv[0] if getattr(sys, "argv", None) else ""
    if script in ("", "-c", "-m", "-") or not os.path.isfile(script):
        return
    pytpc = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    root = os.path.dirname(pytpc)
    sys.path.insert(0, root)
    try:
        from pytpc.errors import TpcError  # noqa: PLC0415
        from pytpc.pyhook.listed import names_script  # noqa: PLC0415
    finally:
        sys.path.remove(root)
    paths = [path for path in os.environ.get("TPC_STATIC", "").split(os.pathsep) if path]
    try:
        if not names_script(paths, script):
            return
    except TpcError as error:
        sys.stderr.write(f"tpc: {error}; nothing is reported\n")
        return
    from subprocess import _args_from_interpreter_flags  # type: ignore[attr-defined]  # noqa: PLC0415

    os.environ["TPC_PYTHON_STARTED"] = str(os.getpid())
    run = os.path.join(pytpc, "run.py")
    flags = _args_from_interpreter_flags()
    os.execv(sys.executable, [sys.executable, *flags, run, "--", script, *sys.argv[1:]])


_hidden()
if _is_wanted():
    _start()
