"""Check Markdown pages: line length, links, spelling, and the commands that they name.

``check_docs.py [FILE...]`` prints ``FILE:LINE: fault`` for each fault and exits with 1 if there is
one. Without FILE it checks every page that git knows, and the pages that sources cite. The rules:

- No line is longer than 120 characters, and no row of a table than 160: longer rows become a list
  or a section. Exempt: lines of code, a line that is a single word, such as an address, and rows of
  docs/study.md, which ``pytpc study report`` writes: they are figures, each with its interval.
- A relative link leads to a file that exists, and its anchor to a heading on that page.
- codespell finds nothing (``[tool.codespell]`` in pyproject.toml).
- Each ``pytpc`` command and option, ``python -m pytpc.MODULE`` and ``make`` target in code
  exists. The command tree of click is asked, so that hidden commands and plugins count, too.
  Exempt: CHANGELOG.md, which names what was.
- A page below docs/ that a source cites exists, and so does its heading.
"""

from __future__ import annotations

import importlib.util
import re
import shlex
import subprocess
import sys
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path
from pkgutil import resolve_name
from typing import NamedTuple

import click
import tomllib
from markdown_it import MarkdownIt
from markdown_it.token import Token

ROOT = Path(__file__).resolve().parents[1]
WIDEST = 120
WIDEST_ROW = 160
WRITTEN_BY_A_PROGRAM = ROOT / "docs/study.md"
SOURCES = ["*.py", "*.cpp", "*.h", "*.json", "*.j2", "cmake", "tools", ":!tests/python"]
CITATION = re.compile(r"(?<![\w/.-])(docs/[\w/-]+\.md)(?:#([\w-]+))?")
SHELLS = {"", "sh", "bash", "console"}
MARKDOWN = MarkdownIt("commonmark").enable("table")


class Fault(NamedTuple):
    """Something to mend on a page; lines count from 1."""

    page: Path
    line: int
    text: str


class Code(NamedTuple):
    """A command line on a page, or words in backticks."""

    line: int
    text: str


class Page:
    """One Markdown file, parsed once."""

    def __init__(self, path: Path) -> None:
        """Read and parse ``path``."""
        self.path = path
        self.lines = path.read_text(encoding="utf-8").splitlines()
        self.tokens = MARKDOWN.parse("\n".join(self.lines))

    def line_of(self, token: Token, text: str) -> int:
        """Return the line of the block ``token`` that holds ``text``, else its first line."""
        begin, end = token.map or (0, 1)
        for number in range(begin, min(end, len(self.lines))):
            if text in self.lines[number]:
                return number + 1
        return begin + 1

    def line_numbers(self, *kinds: str) -> set[int]:
        """Return the numbers, from 1, of the lines in blocks of these kinds."""
        return {
            number + 1
            for token in self.tokens
            if token.type in kinds and token.map
            for number in range(*token.map)
        }

    def anchors(self) -> set[str]:
        """Return the anchors of the headings, as GitHub makes them."""
        seen: dict[str, int] = {}
        found = set()
        for before, token in zip(self.tokens, self.tokens[1:], strict=False):
            if before.type != "heading_open":
                continue
            text = "".join(child.content for child in token.children or [])
            slug = re.sub(r"[^\w\- ]", "", text.lower()).replace(" ", "-")
            count = seen.get(slug, 0)
            seen[slug] = count + 1
            found.add(f"{slug}-{count}" if count else slug)
        return found

    def code(self) -> Iterator[Code]:
        """Yield the words in backticks and the command lines of shell blocks."""
        for token in self.tokens:
            if token.type == "inline":
                for child in token.children or []:
                    if child.type == "code_inline":
                        yield Code(self.line_of(token, child.content), child.content)
            elif token.type in {"fence", "code_block"}:
                begin = (token.map or (0, 0))[0] + (token.type == "fence")
                yield from _commands(token.content, token.info.strip(), begin + 1)


def _commands(block: str, language: str, first: int) -> Iterator[Code]:
    """Yield the command lines of a block; a backslash at the end joins two lines."""
    if language not in SHELLS:
        return
    lines = block.splitlines()
    prompted = any(line.lstrip().startswith("$ ") for line in lines)
    joined, begin = "", first
    for number, raw in enumerate(lines, first):
        line = raw.strip()
        if not joined:
            begin = number
            if prompted and not line.startswith("$ "):
                continue
        joined += line.removeprefix("$ ").removesuffix("\\") + " "
        if not line.endswith("\\"):
            yield Code(begin, joined.strip())
            joined = ""


def long_lines(page: Page) -> Iterator[Fault]:
    """Yield the lines and the rows of tables that are too long."""
    code = page.line_numbers("fence", "code_block")
    rows = page.line_numbers("table_open")
    written = page.path.resolve() == WRITTEN_BY_A_PROGRAM
    for number, line in enumerate(page.lines, 1):
        if number in code or len(line.split()) <= 1 or (written and number in rows):
            continue
        widest, what = (WIDEST_ROW, "row of ") if number in rows else (WIDEST, "")
        if len(line) > widest:
            yield Fault(page.path, number, f"{what}{len(line)} characters, at most {widest}")


def dead_links(page: Page) -> Iterator[Fault]:
    """Yield the relative links that lead to no file or to no heading."""
    for token in page.tokens:
        for child in token.children or []:
            target = str(child.attrs.get("href") or child.attrs.get("src") or "")
            if not target or re.match(r"[a-z][a-z+.-]*:", target):
                continue
            name, _, anchor = target.partition("#")
            file = page.path.parent / name if name else page.path
            line = page.line_of(token, target)
            if not file.exists():
                yield Fault(page.path, line, f"link to {name}: no such file")
            elif anchor and file.suffix == ".md" and anchor not in _anchors(file.resolve()):
                yield Fault(page.path, line, f"link to {target}: no such heading")


@cache
def _anchors(path: Path) -> set[str]:
    return Page(path).anchors()


def missing_commands(page: Page) -> Iterator[Fault]:
    """Yield the commands, options, modules and make targets that do not exist."""
    if page.path.name == "CHANGELOG.md":
        return
    for code in page.code():
        for words in simple_commands(code.text):
            for fault in faults_of(words):
                yield Fault(page.path, code.line, fault)


def simple_commands(text: str) -> Iterator[list[str]]:
    """Yield the words of each command of a line, those inside of ``$(...)`` by themselves."""
    for inner in re.findall(r"\$\(([^()]*)\)", text):
        yield from simple_commands(inner)
    lexer = shlex.shlex(re.sub(r"\$\([^()]*\)", "X", text), posix=True, punctuation_chars=";|&")
    lexer.whitespace_split = True
    words: list[str] = []
    try:
        for word in lexer:
            if set(word) <= set(";|&"):
                yield words
                words = []
            else:
                words.append(word)
    except ValueError:  # a quotation mark without its other half: no command line
        return
    yield words


def faults_of(words: list[str]) -> Iterator[str]:
    """Yield what is wrong with one command."""
    while words and re.fullmatch(r"\w+=.*|time|nice|exec|sudo|env", words[0]):
        words = words[1:]
    if not words:
        return
    program, *rest = words
    name = Path(program).name
    if name.startswith("python") and rest[:1] == ["-m"] and len(rest) > 1:
        module, rest = rest[1], rest[2:]
        if module != "pytpc":
            if module.startswith("pytpc.") and not _module_exists(module):
                yield f"there is no module {module}"
            return
        name = "pytpc"
    if name == "pytpc":
        yield from _command_faults(rest)
    elif name == "make":
        for target in rest:
            if re.fullmatch(r"[a-z][\w-]*", target) and target not in _make_targets():
                yield f"the Makefile has no target {target}"


def _module_exists(name: str) -> bool:
    try:
        return importlib.util.find_spec(name) is not None
    except ModuleNotFoundError:
        return False


@cache
def _make_targets() -> set[str]:
    return set(re.findall(r"^([\w-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))


@cache
def _main() -> click.Command:
    """Return the command that the script ``pytpc`` is."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    command = resolve_name(project["scripts"]["pytpc"])
    assert isinstance(command, click.Command)
    return command


def _command_faults(words: list[str]) -> Iterator[str]:
    """Yield the words of a ``pytpc`` line that are no command or option of it."""
    command = _main()
    context = click.Context(command, info_name="pytpc", **command.context_settings)
    values = 0
    for word in words:
        if values:
            values -= 1
        elif word == "--":
            return
        elif option := re.match(r"--[a-z][a-z-]*|-[A-Za-z]", word):
            found = _option(context, option[0])
            if found is None:
                yield f"{context.command_path} has no option {option[0]}"
            elif word == option[0] and not (found.is_flag or found.count):
                values = found.nargs
        elif isinstance(context.command, click.Group):
            if not re.fullmatch(r"[a-z][a-z-]*", word):
                return  # COMMAND and the like stand for any
            inner = context.command.get_command(context, word)
            if inner is None:
                yield f"{context.command_path} has no command {word}"
                return
            context = click.Context(inner, context, word, **inner.context_settings)


def _option(context: click.Context, name: str) -> click.Option | None:
    for option in context.command.get_params(context):
        if isinstance(option, click.Option) and name in (*option.opts, *option.secondary_opts):
            return option
    return None


def dead_citations(names: Iterable[str]) -> Iterator[Fault]:
    """Yield the pages that sources cite and that do not exist; ``names`` are relative to ROOT."""
    for name in names:
        text = (ROOT / name).read_text(encoding="utf-8", errors="replace")
        for number, line in enumerate(text.splitlines(), 1):
            for page, anchor in CITATION.findall(line):
                if not (ROOT / page).exists() and not _is_ignored(page):
                    yield Fault(Path(name), number, f"{page}: no such page")
                elif anchor and (ROOT / page).exists() and anchor not in _anchors(ROOT / page):
                    yield Fault(Path(name), number, f"{page}#{anchor}: no such heading")


def _is_ignored(page: str) -> bool:
    """Whether git ignores the page: a program writes it."""
    words = ["git", "check-ignore", "--quiet", page]
    return subprocess.run(words, cwd=ROOT, check=False).returncode == 0


def _tracked(*patterns: str) -> list[str]:
    """Return the files that git knows, relative to ROOT; links and what is deleted are left out."""
    words = ["git", "ls-files", "-z", *patterns]
    names = subprocess.check_output(words, cwd=ROOT, text=True).split("\0")
    return [name for name in names if (ROOT / name).is_file() and not (ROOT / name).is_symlink()]


def misspelled(pages: Iterable[Path]) -> Iterator[Fault]:
    """Yield what codespell finds."""
    command = [sys.executable, "-m", "codespell_lib", "--toml", str(ROOT / "pyproject.toml")]
    done = subprocess.run([*command, *map(str, pages)], capture_output=True, text=True, check=False)
    for line in done.stdout.splitlines():
        page, number, text = line.split(":", 2)
        yield Fault(Path(page), int(number), text.strip())
    if done.returncode and not done.stdout:
        sys.exit(f"check-docs: codespell: {done.stderr.strip()}")


def check(paths: list[Path]) -> list[Fault]:
    """Return all faults of these pages, in order of page and line."""
    found = list(misspelled(paths))
    for path in paths:
        page = Page(path)
        found += [*long_lines(page), *dead_links(page), *missing_commands(page)]
    return sorted(found)


def main() -> None:
    """Check the pages of the command line, else all that git knows."""
    sys.path.insert(0, str(ROOT))
    paths = [Path(word) for word in sys.argv[1:]]
    found = check(paths or [Path(name) for name in _tracked("*.md")])
    if not paths:
        found += dead_citations(_tracked(*SOURCES))
    for fault in found:
        print(f"{fault.page}:{fault.line}: {fault.text}")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
