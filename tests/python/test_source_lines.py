"""Lines by language. The counts stand beside the lines that they are of."""

import os
from pathlib import Path

from pytpc_evaluation.survey.source_lines import LineCount, count_lines, source_files

CPP = """// a comment
#include <a.h>

/* a comment
   of two lines */
int main() {  // code, and a comment
  return '\\n';
}
"""
PYTHON = '''"""A docstring.

Of three lines.
"""
x = """a text
of two lines"""  # a comment

# another
'''


def write(path: Path, text: str | bytes) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(text.encode() if isinstance(text, str) else text)


def test_code_comments_and_blanks(tmp_path: Path) -> None:
    write(tmp_path / "src/a.cpp", CPP)
    write(tmp_path / "a.py", PYTHON)
    write(tmp_path / "CMakeLists.txt", "# about\nproject(a)\n")
    counts = count_lines(tmp_path)
    assert counts.languages == {
        # #include, main, return, the bracket; three comments; one blank.
        "C++": LineCount(1, 4, 3, 1),
        # The text's two lines; the docstring's three and "# another"; its blank line and the other.
        "Python": LineCount(1, 2, 4, 2),
        "CMake": LineCount(1, 1, 1, 0),
    }
    assert counts.left_out == {}


def test_what_counts_as_which_language(tmp_path: Path) -> None:
    for name in ("a.cc", "b.cxx", "c.c", "d.C"):
        write(tmp_path / name, "int x;\n")
    for name in ("a.h", "b.hpp", "c.hh", "d.ipp", "e.inl"):
        write(tmp_path / name, "int x;\n\n")
    write(tmp_path / "scripts/node", "#!/usr/bin/env python3\nx = 1\n")
    write(tmp_path / "cfg/Node.cfg", "#!/usr/bin/env python\nx = 1\n")
    counts = count_lines(tmp_path)
    assert counts.of("C++") == LineCount(4, 4)
    assert counts.of("header") == LineCount(5, 5, 0, 5)
    # The first line of a script is a comment to Python.
    assert counts.of("Python") == LineCount(2, 2, 2)
    assert counts.of("Java") == LineCount()


def test_endings_of_lines_and_bytes_of_any_kind(tmp_path: Path) -> None:
    write(tmp_path / "crlf.cpp", b"int x;\r\n\r\n// end")
    write(tmp_path / "latin.h", b"// gr\xfc\xdfe\nint x;\n")
    write(tmp_path / "bom.py", b"\xef\xbb\xbfx = 1\n")
    write(tmp_path / "empty.py", b"")
    write(tmp_path / "blank.h", b"\n \n")
    counts = count_lines(tmp_path)
    assert counts.of("C++") == LineCount(1, 1, 1, 1)
    assert counts.of("header") == LineCount(2, 1, 1, 2)
    assert counts.of("Python") == LineCount(2, 1)


def test_what_nobody_wrote_is_left_out_and_counted(tmp_path: Path) -> None:
    write(tmp_path / "made.h", "// This file was generated automatically.\nint x;\n")
    write(tmp_path / "msg.cpp", "/* DO NOT EDIT */\n")
    write(tmp_path / "picture.cpp", b"\x89PNG\0\0")
    write(tmp_path / "notes.unheard", "text\n")
    write(tmp_path / "mesh.xml", "<a/>\n" * 300_000)
    (tmp_path / "nowhere.py").symlink_to("gone.py")
    counts = count_lines(tmp_path)
    assert counts.languages == {}
    assert counts.left_out == {"binary": 1, "generated": 2, "large": 1, "unknown": 1}


def test_products_and_hidden_folders_are_no_sources(tmp_path: Path) -> None:
    for folder in ("build", "install/x", "devel", "log", ".git", "__pycache__", "out"):
        write(tmp_path / folder / "a.cpp", "int x;\n")
    (tmp_path / "out/CMakeCache.txt").touch()
    write(tmp_path / ".hidden.cpp", "int x;\n")
    write(tmp_path / "src/a.cpp", "int x;\n")
    # A package may have folders of such names, and such a name itself.
    write(tmp_path / "src/arm/package.xml", "<package/>\n")
    write(tmp_path / "src/arm/src/log/a.cpp", "int x;\n")
    write(tmp_path / "src/arm/build/a.cpp", "int x;\n")
    (tmp_path / "src/arm/build/CMakeCache.txt").touch()
    write(tmp_path / "src/arm/install/a.cpp", "int x;\n")
    (tmp_path / "src/arm/install/.colcon_install_layout").touch()
    write(tmp_path / "src/build/package.xml", "<package/>\n")
    names = [str(path.relative_to(tmp_path)) for path in source_files(tmp_path)]
    assert names == [
        "src/a.cpp",
        "src/arm/package.xml",
        "src/arm/src/log/a.cpp",
        "src/build/package.xml",
    ]


def test_links_are_followed_once(tmp_path: Path) -> None:
    tree = tmp_path / "tree"
    write(tree / "a.cpp", "int x;\n")
    write(tmp_path / "elsewhere/b.cpp", "int x;\n")
    (tree / "again.cpp").symlink_to("a.cpp")
    (tree / "other").symlink_to("../elsewhere")
    (tree / "third").symlink_to("../elsewhere")
    (tree / "circle").symlink_to(".")
    assert count_lines(tree).of("C++") == LineCount(2, 2)


def test_each_file_is_announced(tmp_path: Path) -> None:
    write(tmp_path / "b.cpp", "int x;\n")
    write(tmp_path / "a.cpp", "int x;\n")
    seen: list[str] = []
    count_lines(tmp_path, lambda path: seen.append(os.path.relpath(path, tmp_path)))
    assert seen == ["a.cpp", "b.cpp"]
