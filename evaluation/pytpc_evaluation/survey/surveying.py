"""A survey from the first tree to the last: what is still valid is taken, the rest is measured."""

from __future__ import annotations

import fcntl
import hashlib
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from pytpc.base.atomic import write_atomic
from pytpc.base.checked_json import dump_json, parse_json
from pytpc.base.errors import InputError, WorkspaceError
from pytpc.base.paths import cmake_file, defer_plugin, log_library, plugin, prefix, project_root
from pytpc.build.python_units import PythonUnits, analyse_scripts, analysis_files, scripts_at
from pytpc.python_analysis.rules_file import load_rules
from pytpc.workspace.colcon import Bases
from pytpc_evaluation.survey.measured_build import BuildWay, Measured, measure, read_tree, underlaid
from pytpc_evaluation.survey.source_lines import count_lines, source_files
from pytpc_evaluation.survey.trees import (
    RESULT_VERSION,
    Tree,
    TreeResult,
    build_order,
    found_in,
    needed_trees,
)

PLAIN, TPC = "plain", "tpc"


@dataclass(frozen=True, slots=True)
class Options:
    """What a survey is asked for.

    ``underlay`` are set-up scripts that every build sources first, ``cmake_args`` arguments for
    each package's CMake; ``plain`` whether each tree is built without TPC, too; ``rerun`` whether
    results that are there are measured again.
    """

    output: Path
    jobs: int
    underlay: tuple[Path, ...] = ()
    cmake_args: tuple[str, ...] = ()
    plain: bool = True
    rerun: bool = False


@dataclass(frozen=True, slots=True)
class SurveyProgress:
    """What is being done: the tree, its number among ``total``, and what; or a line of colcon's.

    ``far`` says how far it is, where that is known.
    """

    tree: str
    number: int
    total: int
    what: str
    line: str = ""
    far: str = ""


def survey(
    folders: Sequence[Path], options: Options, on_step: Callable[[SurveyProgress], None]
) -> list[TreeResult]:
    """Survey source trees; the result of each is on the disk as soon as it is there.

    Results are ``<output>/results/<tree>.json``, builds ``<output>/builds/<tree>/``.

    Args:
        folders: the trees; one that is given twice is surveyed once.
        options: see there.
        on_step: called with what is done now, and with each line that colcon writes.

    Returns:
        The results in the order in which the trees were given.

    Raises:
        WorkspaceError: a folder is no tree, the output folder is in one, or another survey writes
            there.
        MissingToolError: something that builds need is not here.
        TpcError: the output folder cannot be written.
    """
    trees = _named(list(dict.fromkeys(folder.resolve() for folder in folders)))
    output = options.output.resolve()
    for tree in trees:
        if output.is_relative_to(tree.path):
            raise WorkspaceError(f"is in the tree {tree.path}; choose another folder", output)
    with _alone(output):
        return _survey(trees, options, on_step)


@contextmanager
def _alone(output: Path) -> Iterator[None]:
    """Nobody else's survey writes into the same folder meanwhile; a killed one is no hindrance."""
    try:
        output.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(output / ".lock", os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
    except OSError as error:
        raise WorkspaceError(f"cannot be written: {error.strerror}", output) from error
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield
    except BlockingIOError as error:
        raise WorkspaceError("another survey is running here", output) from error
    finally:
        os.close(descriptor)


def _survey(
    trees: Sequence[Tree], options: Options, on_step: Callable[[SurveyProgress], None]
) -> list[TreeResult]:
    tools = _digest_of_tpc()
    needed = needed_trees(trees)
    order = build_order(trees)
    results: dict[str, TreeResult] = {}
    for number, tree in enumerate(order, start=1):
        say = _Say(on_step, tree.name, number, len(order))
        below = needed[str(tree.path)]
        before = [_builds(other, options) for other in order if str(other.path) in below]
        keys = [results[path].key for path in below]
        say("reading sources")
        key = _key(tree, options, tools, keys)
        result = None if options.rerun else _known(tree, options, key)
        if result is None:
            # Its builds go first: what is interrupted now must not pass for what was there.
            _result_file(tree, options).unlink(missing_ok=True)
            result = _measure_both(tree, options, key=key, before=before, say=say)
            write_atomic(_result_file(tree, options), dump_json(result.to_json()))
        else:
            say("already known")
        results[str(tree.path)] = result
    return [results[str(tree.path)] for tree in trees]


@dataclass(frozen=True, slots=True)
class _Say:
    on_step: Callable[[SurveyProgress], None]
    tree: str
    number: int
    total: int

    def __call__(self, what: str, line: str = "", *, far: str = "") -> None:
        self.on_step(SurveyProgress(self.tree, self.number, self.total, what, line, far))


def _named(folders: Sequence[Path]) -> list[Tree]:
    """The trees, each with a name of its own: its folder, with as much above as is needed."""
    names: list[str] = []
    for folder in folders:
        others = [other for other in folders if other != folder]
        depth = next(
            (
                depth
                for depth in range(1, len(folder.parts))
                if not any(other.parts[-depth:] == folder.parts[-depth:] for other in others)
            ),
            len(folder.parts),
        )
        names.append("/".join(folder.parts[-depth:]))
    return [read_tree(folder, name) for folder, name in zip(folders, names, strict=True)]


def _measure_both(
    tree: Tree,
    options: Options,
    *,
    key: str,
    before: Sequence[Path],
    say: _Say,
) -> TreeResult:
    """Build a tree both ways; every second one begins with TPC: neither has the advantage."""
    ways = [PLAIN, TPC] if options.plain else [TPC]
    if say.number % 2 == 0:
        ways.reverse()
    say("counting lines")
    lines = count_lines(tree.path)
    measured: dict[str, Measured] = {}
    for way in ways:
        what = "building with TPC" if way == TPC else "building without TPC"
        say(what)
        below = [path / way / "install" / "local_setup.bash" for path in before]
        environment = underlaid(
            [*options.underlay, *(setup for setup in below if setup.is_file())], options.jobs
        )
        measured[way] = measure(
            tree,
            Bases(_builds(tree, options) / way),
            BuildWay(environment, way == TPC, options.jobs, options.cmake_args),
            partial(say, what),
        )
    with_tpc = measured[TPC]
    nodes = _python(tree, say)
    unread = (f"{one.package}/{one.link_unit}: {one.reason}" for one in nodes.left_out)
    return TreeResult(
        name=tree.name,
        path=str(tree.path),
        key=key,
        packages=len(tree.packages) + len(tree.unreadable),
        first=ways[0],
        plain=measured[PLAIN].build if PLAIN in measured else None,
        tpc=with_tpc.build,
        found=found_in(
            (*with_tpc.units, *nodes.units),
            tree.path,
            with_tpc.without,
            (*with_tpc.unreadable, *unread),
        ),
        lines=lines,
    )


def _python(tree: Tree, say: _Say) -> PythonUnits:
    """The scripts of a tree, analysed when the builds are measured: it is no part of their time."""
    say("analysing Python")

    def advance(done: int, total: int) -> None:
        say("analysing Python", far=f"{done:,} of {total:,} scripts")

    rules = load_rules()
    return analyse_scripts(scripts_at(tree.path, rules), rules, advance)


def _known(tree: Tree, options: Options, key: str) -> TreeResult | None:
    """The result of an earlier run where it still holds, and its builds are there for others."""
    path = _result_file(tree, options)
    if not path.is_file():
        return None
    try:
        result = TreeResult.from_json(parse_json(path), path)
    except InputError:
        # Of another version, or not ours: measured again and written over.
        return None
    ways = (PLAIN, TPC) if options.plain else (TPC,)
    there = all((_builds(tree, options) / way).is_dir() for way in ways) or not tree.packages
    return result if result.key == key and there else None


def _key(tree: Tree, options: Options, tools: str, before: Sequence[str]) -> str:
    """What a result depends on, as one text: sources, TPC, what is below it, what was asked for."""
    said = [
        str(RESULT_VERSION),
        str(tree.path),
        _digest_of_files(list(source_files(tree.path)), tree.path),
        tools,
        *(str(setup.absolute()) for setup in options.underlay),
        *options.cmake_args,
        str(options.plain),
        *before,
    ]
    return hashlib.sha256("\0".join(said).encode("utf-8", "surrogateescape")).hexdigest()


def _digest_of_tpc() -> str:
    """Stands for the installed half (passes, log library, tpc.cmake, rules) and the analysis."""
    files = [log_library(), plugin(), defer_plugin(), cmake_file()]
    root = prefix()
    for part in ("lib/tpc", "share/tpc"):
        files += [path for path in (root / part).rglob("*") if path.is_file()]
    own = _digest_of_files(analysis_files(), project_root())
    return f"{_digest_of_files(sorted(set(files)), root)} {own}"


def _digest_of_files(files: Sequence[Path], root: Path) -> str:
    digest = hashlib.sha256()
    for path in files:
        name = str(path.relative_to(root)).encode("utf-8", "surrogateescape")
        try:
            content = hashlib.sha256(path.read_bytes()).digest()
        except OSError:
            content = b"unreadable"
        digest.update(len(name).to_bytes(8, "big") + name + content)
    return digest.hexdigest()


def _place(tree: Tree) -> str:
    return f"{tree.path.name}-{hashlib.sha256(str(tree.path).encode()).hexdigest()[:8]}"


def _result_file(tree: Tree, options: Options) -> Path:
    return options.output / "results" / f"{_place(tree)}.json"


def _builds(tree: Tree, options: Options) -> Path:
    return options.output.absolute() / "builds" / _place(tree)
