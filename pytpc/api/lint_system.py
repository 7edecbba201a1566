"""Names of parameters that code outside of the workspace may read: system libraries and modules."""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path

from pytpc.base.paths import ROS_PREFIXES
from pytpc.base.source_bytes import source_bytes
from pytpc.processes.binaries import Libraries, literals

_READS = re.compile(
    rb"_ZNK?3ros(?:10NodeHandle\w{0,20}(?:[pP]aram)|5param)"
    rb"|_ZNK?6rclcpp\w{0,80}(?:declare_parameter|get_parameter|NodeParametersInterface)"
)
# Their own texts are of all programs, or are no names of parameters.
_ROS_ITSELF = re.compile(r"lib(?:roscpp|rclcpp|rclcpp_components|rclcpp_lifecycle)\.so")
_WORD, _HALF = 8, 4
# What x86-64 has for eight letters (`movabs`) or four (`mov`, to memory or a register) of a name.
_EIGHT = re.compile(rb"[\x48\x49][\xb8-\xbf]([A-Za-z_/~][A-Za-z0-9_/]{7})")
_FOUR = re.compile(rb"(?:\xc7[\x00-\xff]{1,6}?|[\xb8-\xbf])(?=([A-Za-z_/~][A-Za-z0-9_/]{3}))")
_PYTHON_READS = re.compile(rb"\b(?:get_param|declare_parameters?|search_param)\b")
_ROS_ITSELF_IN_PYTHON = frozenset({"rospy", "rclpy", "rosparam"})
_NAME = re.compile(r"[~/]?[A-Za-z][\w./-]*")


def of_libraries(
    libraries: Libraries, first: Iterable[Path], ours: Collection[Path], wanted: Collection[str]
) -> frozenset[str]:
    """Those of the wanted names that a library of the system may read.

    Args:
        libraries: finds them.
        first: the files of a process: its program, and the libraries that it opens.
        ours: files of the workspace, which are analysed; a process has those of its install folder,
            which have the same names.
        wanted: last parts of names.
    """
    found: set[str] = set()
    names = {path.name for path in ours}
    for binary in libraries.all_of(first):
        path = binary.path
        if path.name in names or _ROS_ITSELF.match(path.name) or not _reads_parameters(path):
            continue
        found |= literals(path).intersection(wanted)
        found |= {one for one in wanted if _may_be_in_code(one, path)}
    return frozenset(found)


@lru_cache(maxsize=1024)
def _reads_parameters(path: Path) -> bool:
    """Whether a library calls what reads parameters, by the names of its symbols."""
    return _READS.search(path.read_bytes()) is not None


def _may_be_in_code(name: str, path: Path) -> bool:
    """Whether the code of a library may build a text in place; it has no literal of it then.

    That of one of fewer than four letters is too short to be told from other code.
    """
    if len(name) < _HALF:
        return True
    eights, fours = _in_code(path)
    return name[:_WORD] in eights if len(name) >= _WORD else name[:_HALF] in fours


@lru_cache(maxsize=256)
def _in_code(path: Path) -> tuple[frozenset[str], frozenset[str]]:
    """The texts of eight and of four letters that the code of a library has as numbers."""
    content = path.read_bytes()
    return (
        frozenset(text.decode("ascii") for text in _EIGHT.findall(content)),
        frozenset(text.decode("ascii") for text in _FOUR.findall(content)),
    )


def of_python_modules(
    files: Iterable[str], env: Mapping[str, str], wanted: Collection[str]
) -> frozenset[str]:
    """Those of the wanted names that a Python module of the system may read.

    Args:
        files: the Python files of the workspace that a node consists of.
        env: that of a sourced workspace.
        wanted: last parts of names.
    """
    folders = _module_folders(env.get("PYTHONPATH", ""))
    names = frozenset(name for file in files for name in _imported(Path(file)))
    modules = (path for name in sorted(names) for path in _files_of(name, folders))
    return frozenset[str]().union(*(_texts_of_module(path) for path in modules)) & set(wanted)


@lru_cache(maxsize=4)
def _module_folders(python_path: str) -> tuple[Path, ...]:
    listed = [Path(one) for one in python_path.split(":") if one]
    near = [
        folder
        for prefix in ROS_PREFIXES
        for below in ("lib", "local/lib")
        for folder in prefix.glob(f"{below}/python3*/*-packages")
    ]
    return tuple(dict.fromkeys(folder for folder in (*listed, *near) if folder.is_dir()))


@lru_cache(maxsize=1024)
def _imported(path: Path) -> frozenset[str]:
    """The packages that a file imports, by the first parts of their names."""
    try:
        tree = ast.parse(source_bytes(path))
    except (OSError, SyntaxError, ValueError, RecursionError, MemoryError):
        return frozenset()
    names: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names |= {one.name.partition(".")[0] for one in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            names.add(node.module.partition(".")[0])
    return frozenset(names)


@lru_cache(maxsize=256)
def _files_of(name: str, folders: Sequence[Path]) -> tuple[Path, ...]:
    """The files of a package of the system in which parameters are read."""
    for folder in folders if name not in _ROS_ITSELF_IN_PYTHON else ():
        single, package = folder / f"{name}.py", folder / name
        if single.is_file():
            return tuple(filter(_is_reading, [single]))
        if (package / "__init__.py").is_file():
            return tuple(filter(_is_reading, sorted(package.rglob("*.py"))))
    return ()


def _is_reading(path: Path) -> bool:
    try:
        content = path.read_bytes()
    except OSError:
        return False
    return (b"rospy" in content or b"rclpy" in content) and bool(_PYTHON_READS.search(content))


@lru_cache(maxsize=1024)
def _texts_of_module(path: Path) -> frozenset[str]:
    """The texts of a Python file that may be names of parameters, without their namespaces."""
    try:
        tree = ast.parse(source_bytes(path))
    except (OSError, SyntaxError, ValueError, RecursionError, MemoryError):
        return frozenset()
    texts = (
        node.value
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    )
    return frozenset(text.rpartition("/")[2].lstrip("~") for text in texts if _NAME.fullmatch(text))
