"""Settings of Sphinx for the docs as a site; tools/build-site calls it.

The pages are plain Markdown, as GitHub shows them. What Sphinx wants beyond that is derived here:
the navigation is made of the lists of docs/README.md, so that a new page is listed in one place.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

from sphinx.application import Sphinx
from sphinx.util.typing import ExtensionMetadata

ROOT = Path(__file__).resolve().parents[2]
INDEX = "docs/README"
LINK = re.compile(r"\]\(([^)#:\s]+)\.md(?:#[\w-]*)?\)")


def pages() -> list[str]:
    """Return the Markdown files that git knows or would add, relative to ROOT."""
    words = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard", "*.md"]
    names = subprocess.check_output(words, cwd=ROOT, text=True).split("\0")
    return sorted(name for name in set(names) if name and (ROOT / name).is_file())


project = "TPC"
version = release = (ROOT / "VERSION").read_text(encoding="utf-8").strip()
extensions = ["myst_parser"]
root_doc = "README"
include_patterns = pages()
smartquotes = False

# What GitHub does not know is text here, too: a line that begins with "%", a word in braces.
myst_disable_syntax = [
    "colon_fence",
    "myst_block_break",
    "myst_line_comment",
    "myst_role",
    "myst_target",
]
myst_heading_anchors = 6
highlight_language = "none"
# A block of JSON with "..." in it is still JSON to its reader.
suppress_warnings = ["misc.highlighting_failure"]

html_theme = "sphinx_book_theme"
html_title = "TPC"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_use_index = False
html_copy_source = False
html_show_copyright = False
html_show_sphinx = False
html_theme_options = {
    "home_page_in_toc": True,
    "navbar_start": [],
    "navbar_center": [],
    "navbar_end": [],
    "navbar_persistent": [],
    "show_navbar_depth": 1,
    "show_toc_level": 2,
    "use_download_button": False,
    "use_fullscreen_button": False,
}


def sections() -> dict[str, list[str]]:
    """Return the pages below each heading of docs/README.md, in its order, each page once."""
    _, *parts = re.split(r"^## ", (ROOT / f"{INDEX}.md").read_text("utf-8"), flags=re.MULTILINE)
    found: dict[str, list[str]] = {}
    seen: set[str] = set()
    for part in parts:
        title, _, body = part.partition("\n")
        names = [f"docs/{name}" for name in dict.fromkeys(LINK.findall(body))]
        found[title.strip()] = [name for name in names if name not in seen]
        seen.update(names)
    return found


def below(*folders: str) -> list[str]:
    """Return the pages in these folders."""
    return [
        name.removesuffix(".md")
        for folder in folders
        for name in include_patterns
        if name.startswith(f"{folder}/")
    ]


def navigation() -> str:
    """Return the tables of contents for the end of the front page, in MyST's words."""
    listed = sections()
    study = ["docs/study", *below("docs/study")]
    contents = {
        "": [INDEX],
        "Tutorial": below("docs/tutorial"),
        **{title: [name for name in names if name not in study] for title, names in listed.items()},
        "The study": study,
        "Develop": ["CONTRIBUTING", "CHANGELOG", *below("evaluation", "tests")],
        "Examples": below("examples"),
    }
    text = ""
    for title, names in contents.items():
        caption = f":caption: {title}\n" if title else ""
        lines = "".join(f"/{name}\n" for name in names)
        text += f"\n```{{toctree}}\n:hidden:\n{caption}\n{lines}```\n"
    return text


def add_navigation(app: Sphinx, name: str, source: list[str]) -> None:
    """Append the tables of contents to the front page."""
    if name == root_doc:
        app.env.note_dependency(ROOT / f"{INDEX}.md")
        source[0] += navigation()


def add_index(app: Sphinx, error: Exception | None) -> None:
    """Make the front page the one that a server shows for the folder."""
    if error is None and app.builder.format == "html":
        shutil.copyfile(app.outdir / f"{root_doc}.html", app.outdir / "index.html")


def setup(app: Sphinx) -> ExtensionMetadata:
    """Say when each of these is called."""
    app.connect("source-read", add_navigation)
    app.connect("build-finished", add_index)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
