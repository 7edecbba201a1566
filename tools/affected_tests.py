"""Lists the Python tests that a change reaches, nearest first; `make check` runs them.

A file has changed if it differs from the merge base with main, committed or not. grimp reads which
module of the product imports which. This module reads the imports of tests, and the modules and
files that tests name in a string. The distance of a test from a changed module is the shortest
chain of imports. The answer depends only on the files: there is no database, and nothing is run.
"""

from __future__ import annotations

import argparse
import ast
import subprocess
import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import grimp

ROOT = Path(__file__).parents[1]
PACKAGES = ("pytpc", "pytpc_evaluation")
# Tests in tests/ros build workspaces and start graphs, which takes minutes: `make test` runs them.
TEST_FOLDERS = ("tests/python", "tests/runtime")
# Where an `import` in a test looks first (pytest's `pythonpath`, and the test's own folder).
HELPER_FOLDERS = ("tests", "tools")
# C++ that Python tests compile; lit tests the rest.
TESTED_BY = {"runtime_log/": "tests/runtime/test_"}
LONGEST_NAME = 100
MOST = 25
"""This many test files take about a minute on two cores."""


@dataclass(frozen=True, slots=True, order=True)
class Chosen:
    """A test file that a change reaches: by how many imports, and from which changed file."""

    distance: int
    breadth: int
    test: str
    reason: str


@dataclass(frozen=True, slots=True)
class Names:
    """What a Python file refers to: imported modules, the words of its strings, fixtures.

    ``functions`` are those that it defines, ``arguments`` the names of what its functions take: a
    test takes a fixture of a conftest.py by that name.
    """

    modules: frozenset[str]
    strings: frozenset[str]
    functions: frozenset[str]
    arguments: frozenset[str]


def names_in(text: str) -> Names:
    """The imports of a file at any depth, each short string without a blank, its functions."""
    modules: set[str] = set()
    strings: set[str] = set()
    functions: set[str] = set()
    arguments: set[str] = set()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            modules.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            modules.add(node.module)
            modules.update(f"{node.module}.{alias.name}" for alias in node.names)
        elif (
            isinstance(node, ast.Constant)
            and isinstance(node.value, str)
            and len(node.value) < LONGEST_NAME
            and not set(node.value) & set(" \n")
        ):
            strings.add(node.value.strip("/"))
        elif isinstance(node, ast.FunctionDef):
            functions.add(node.name)
            arguments.update(argument.arg for argument in node.args.args)
    return Names(*map(frozenset, (modules, strings, functions, arguments)))


def importers(edges: Mapping[str, set[str]]) -> dict[str, set[str]]:
    """The edges reversed: for each file, the files that refer to it."""
    backwards: dict[str, set[str]] = {}
    for file, targets in edges.items():
        for target in targets:
            backwards.setdefault(target, set()).add(file)
    return backwards


def distances(
    starts: Iterable[str], backwards: Mapping[str, set[str]]
) -> dict[str, tuple[int, str]]:
    """For each reached file, the number of steps and the changed file that reaches it."""
    found = {start: (0, start) for start in sorted(starts)}
    row = list(found)
    while row:
        following = []
        for file in row:
            steps, start = found[file]
            for importer in sorted(backwards.get(file, ())):
                if importer not in found:
                    found[importer] = (steps + 1, start)
                    following.append(importer)
        row = following
    return found


class Tree:
    """The files of a checkout, and which file refers to which."""

    def __init__(self, root: Path, files: Iterable[str], packages: Iterable[str]) -> None:
        """``files`` are relative to ``root``; deleted files are ignored."""
        self.root = root
        self.folders = tuple(f"{top}{name}/" for name in packages for top in ("", "evaluation/"))
        self.files = sorted(file for file in files if (root / file).is_file())
        self.names = {
            file: names_in((root / file).read_text("utf-8"))
            for file in self.files
            if file.endswith(".py") and file.startswith((*self.folders, "tests/", "tools/"))
        }
        self.edges = self._product(packages)
        for file, names in self.names.items():
            if not file.startswith(self.folders):
                self.edges[file] = set(self._helpers(file, names)) | set(self._modules(names))
        self._name_files()

    def _product(self, packages: Iterable[str]) -> dict[str, set[str]]:
        """Which file of the product imports which."""
        present = [name for name in packages if self._package(name) is not None]
        sys.path[:0] = [str(self.root), str(self.root / "evaluation")]
        graph = grimp.build_graph(*present, cache_dir=None)
        del sys.path[:2]
        self.files_of = {module: file for module in graph.modules if (file := self._file(module))}
        edges = {
            file: {
                self.files_of[imported]
                for imported in graph.find_modules_directly_imported_by(module)
                if imported in self.files_of
            }
            for module, file in self.files_of.items()
        }
        # The command line imports its commands by name.
        for module, file in self.files_of.items():
            package = module.rpartition(".")[0]
            for word in self.names[file].strings:
                for named in (word, f"{package}.{word}"):
                    if named in self.files_of and named != module:
                        edges[file].add(self.files_of[named])
        return edges

    def _package(self, name: str) -> str | None:
        found = [p for p in (name, f"evaluation/{name}") if f"{p}/__init__.py" in self.files]
        return found[0] if found else None

    def _file(self, module: str) -> str | None:
        top, _, rest = module.partition(".")
        stem = "/".join(filter(None, [self._package(top) or top, rest.replace(".", "/")]))
        found = [f for f in (f"{stem}.py", f"{stem}/__init__.py") if f in self.names]
        return found[0] if found else None

    def _modules(self, names: Names) -> Iterator[str]:
        """Files of the product that are imported, or named as `-m pytpc.x`."""
        for module in names.modules | names.strings:
            if module in self.files_of:
                yield self.files_of[module]

    def _helpers(self, file: str, names: Names) -> Iterator[str]:
        """Files beside the tests that are imported; a conftest.py by its fixtures."""
        own = file.rpartition("/")[0]
        for module in names.modules:
            for folder in (own, *HELPER_FOLDERS):
                stem = f"{folder}/{module.replace('.', '/')}"
                for found in (f"{stem}.py", f"{stem}/__init__.py"):
                    if found in self.names and found != file:
                        yield found
        for conftest in (f"{own}/conftest.py", "tests/conftest.py"):
            if conftest in self.names and self.names[conftest].functions & names.arguments:
                yield conftest

    def _name_files(self) -> None:
        """Other files are referred to by path, by name, or by a folder that contains them."""
        by_word: dict[str, list[str]] = {}
        for file in self.files:
            if file not in self.names:
                folders = file.split("/")
                paths = {"/".join(folders[:end]) for end in range(2, len(folders) + 1)}
                for word in {folders[-1], *paths}:
                    by_word.setdefault(word, []).append(file)
        for file, names in self.names.items():
            for word in names.strings:
                named = by_word.get(word, [])
                # A name that many files have, or a plain word, may mean anything.
                if "/" in word or ("." in word and len(named) == 1):
                    self.edges.setdefault(file, set()).update(named)
        self._keep_unnamed()

    def _keep_unnamed(self) -> None:
        """The modules of a package use its data files that no module names."""
        named = set().union(*self.edges.values())
        for file in self.files:
            if file in self.names or file in named:
                continue
            folder = Path(file).parent
            while f"{folder}/__init__.py" not in self.names and folder != folder.parent:
                folder = folder.parent
            for user in self.names:
                own = user.startswith(self.folders) and Path(user).parent == folder
                tested = any(
                    file.startswith(source) and user.startswith(tests)
                    for source, tests in TESTED_BY.items()
                )
                if own or tested:
                    self.edges[user].add(file)

    def reached(self, changed: Iterable[str]) -> list[Chosen]:
        """The test files that the changed files reach, nearest and most focused first."""
        backwards = importers(self.edges)
        return sorted(
            Chosen(steps, len(self.edges.get(file, ())), file, start)
            for file, (steps, start) in distances(changed, backwards).items()
            if file.startswith(TEST_FOLDERS) and Path(file).name.startswith("test_")
        )


def git(*words: str) -> list[str]:
    """The lines that git prints."""
    command = ["git", "-c", "core.quotePath=false", *words]
    return subprocess.run(
        command, cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.splitlines()


def merge_base(branch: str | None) -> str:
    """The commit that the branch left main at; main is the remote's if there is one."""
    known = git("for-each-ref", "--format=%(refname:short)", "refs/heads", "refs/remotes")
    names = [branch] if branch else [name for name in ("origin/main", "main") if name in known]
    return git("merge-base", "HEAD", names[0])[0] if names else "HEAD"


def main() -> int:
    """Print the tests on standard output, one per line, and the reasons on standard error."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--base", metavar="BRANCH", help="Compare with BRANCH instead of main.")
    parser.add_argument(
        "--most", type=int, default=MOST, help=f"Print at most MOST files ({MOST})."
    )
    parser.add_argument("--changed", action="store_true", help="Print the changed files instead.")
    given = parser.parse_args()
    base = merge_base(given.base)
    changed = {*git("diff", "--name-only", base), *git("ls-files", "-o", "--exclude-standard")}
    if given.changed:
        print(*sorted(changed), sep="\n")
        return 0
    tree = Tree(ROOT, git("ls-files", "-co", "--exclude-standard"), PACKAGES)
    reached = tree.reached(changed)
    chosen = reached[: given.most]
    print(f"{len(changed)} files differ from {base[:9]}", file=sys.stderr, end="; ")
    print(f"they reach {len(reached)} test files", file=sys.stderr, end="")
    if len(chosen) < len(reached):
        print(f"; the {len(chosen)} nearest run, `make test` runs all", file=sys.stderr, end="")
    print(file=sys.stderr)
    for one in chosen:
        print(one.test)
        away = {0: "changed", 1: f"uses {one.reason}"}
        why = away.get(one.distance, f"{one.distance} imports from {one.reason}")
        print(f"  {one.test}: {why}", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
