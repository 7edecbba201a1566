"""The docs build into a site: strict, whole, searchable, and without a request to elsewhere."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

ROOT = Path(__file__).parents[2]
# What a browser loads by itself; a link (`a`) is followed by its reader.
LOADED = {"audio", "embed", "iframe", "img", "link", "object", "script", "source", "video"}
PAGES = {
    "README.md": "# Front\n\n[Index](docs/README.md#how-to)\n",
    "CONTRIBUTING.md": "# Contributing\n",
    "CHANGELOG.md": "# Changes\n",
    "docs/README.md": "# Docs\n\n## How to\n\n- [Fly](how-to/fly.md)\n",
    "docs/how-to/fly.md": "# Fly\n\n% of a line\n\nRead {this}`word`, [why](../study.md#why).\n",
    "docs/study.md": "# Study\n\n## Why\n",
}


class Parsed(HTMLParser):
    """The anchors of a page, and its addresses, each with its tag."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.addresses: list[tuple[str, str]] = []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name == "id" and value:
                self.anchors.add(value)
            elif name in {"href", "src", "data", "poster"} and value:
                self.addresses.append((tag, value))


def build(root: Path, folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [root / "tools/build-site", folder],
        capture_output=True,
        text=True,
        check=False,
        timeout=600,
    )


def faults(site: Path) -> list[str]:
    """Addresses that lead nowhere, and those elsewhere that a browser would load by itself."""
    pages = {path: Parsed(path) for path in site.rglob("*.html") if "_static" not in path.parts}
    found = []
    for path, page in pages.items():
        for tag, address in page.addresses:
            url, where = urlsplit(address), path.relative_to(site)
            if url.scheme == "data" or ((url.scheme or url.netloc) and tag not in LOADED):
                continue
            if url.scheme or url.netloc:
                found.append(f"{where}: loads {address}")
                continue
            target = (path.parent / unquote(url.path)).resolve() if url.path else path
            if not target.exists():
                found.append(f"{where}: no {address}")
            elif target in pages and unquote(url.fragment) not in {"", *pages[target].anchors}:
                found.append(f"{where}: no anchor {address}")
    for path in site.rglob("*.css"):
        text = path.read_text(encoding="utf-8")
        for address in re.findall(r"@import\s+[\"']([^\"']+)|url\(\s*[\"']?([^\"')]+)", text):
            if re.match(r"(https?:)?//", "".join(address)):
                found.append(f"{path.name}: loads {''.join(address)}")
    return found


def test_the_docs_are_a_site_that_needs_nothing_from_elsewhere(tmp_path: Path):
    site = tmp_path / "site"
    done = build(ROOT, site)
    assert (done.returncode, done.stderr) == (0, ""), done.stdout
    assert done.stdout.splitlines()[-1] == str(site / "index.html")
    assert faults(site) == []

    # Every page is found by the search, and is in the navigation of the front page.
    words = ["git", "ls-files", "README.md", "CONTRIBUTING.md", "CHANGELOG.md", "docs/*.md"]
    names = subprocess.check_output(words, cwd=ROOT, text=True).split()
    script = (site / "searchindex.js").read_text(encoding="utf-8")
    index = json.loads(script[script.index("{") : script.rindex("}") + 1])
    assert {name.removesuffix(".md") for name in names} <= set(index["docnames"])
    headed, told = index["titleterms"]["margin"], index["terms"]["margin"]
    assert "docs/reference/glossary" in {index["docnames"][at] for at in _each(headed)}
    assert "docs/explanation/limits" in {index["docnames"][at] for at in _each(told)}
    front = {address for _, address in Parsed(site / "index.html").addresses}
    assert {name.replace(".md", ".html") for name in names} - {"README.html"} <= front
    assert (site / "index.html").read_bytes() == (site / "README.html").read_bytes()


def _each(numbers: int | list[int]) -> list[int]:
    """The pages of a word in Sphinx's index; one page stands there without a list."""
    return [numbers] if isinstance(numbers, int) else numbers


@pytest.fixture
def small(tmp_path: Path) -> Path:
    """A tree with few pages and the tools of this one."""
    for name, text in PAGES.items():
        path = tmp_path / "tree" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    root = tmp_path / "tree"
    shutil.copytree(ROOT / "tools/site", root / "tools/site")
    shutil.copy(ROOT / "tools/build-site", root / "tools/build-site")
    shutil.copy(ROOT / "VERSION", root / "VERSION")
    (root / ".gitignore").write_text("/out\n")
    (root / ".venv-docs").symlink_to(ROOT / ".venv-docs")
    subprocess.run(["git", "init", "--quiet", root], check=True)
    return root


def test_a_page_is_read_as_github_reads_it(small: Path):
    done = build(small, small / "out")
    assert (done.returncode, done.stderr) == (0, "")
    text = (small / "out/docs/how-to/fly.html").read_text()
    assert "% of a line" in text
    assert "{this}<code" in text


@pytest.mark.parametrize(
    ("page", "text", "fault"),
    [
        ("docs/how-to/fly.md", "# Fly\n\n[no file](walk.md)\n", "fly.md:3: WARNING: .*walk.md"),
        ("docs/how-to/fly.md", "# Fly\n\n[x](../study.md#how)\n", "fly.md:3: WARNING: .*'how'"),
        ("docs/how-to/walk.md", "# Walk\n", "walk.md: WARNING: .*isn't included in any toctree"),
    ],
    ids=["file", "anchor", "not listed"],
)
def test_what_leads_nowhere_fails_the_build(small: Path, page: str, text: str, fault: str):
    (small / page).write_text(text)
    done = build(small, small / "out")
    assert done.returncode == 1
    assert re.search(fault, done.stderr), done.stderr


def test_without_sphinx_it_says_what_to_type(small: Path):
    (small / ".venv-docs").unlink()
    done = build(small, small / "out")
    assert done.returncode == 1
    assert done.stderr == "build-site: error: Sphinx is not installed; type: tools/setup docs\n"
