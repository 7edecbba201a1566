"""Which list files CMake can parse: by hand, and against CMake itself."""

import shutil
import subprocess
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from pytpc.workspace.cmake_syntax import SyntaxFault, find_fault, tokens

CMAKE = shutil.which("cmake", path="/usr/bin:/bin")

GOOD = [
    b"",
    b"\xef\xbb\xbfproject(x)\n",
    b"project(x)",
    b"project(x)\r\nadd_library(x\r\n  a.cpp)\r\n",
    b"project (x)\n  add_library\t(x a.cpp)\n",
    b"a(()(b (c)))\n",
    b'a("(" ")" "#" "[[")\n',
    b'a("one\ntwo \\" three" x)\n',
    b'a([[ ) " ]] [=[ ]] ]=])\n',
    b"#[[ a( ]] #[==[ ]] \n( ]==]\na()\n",
    b"# a(\na() # )\n",
    b"a(b # )\n)\n",
    b'a(\\( \\) \\" \\# \\;)\n',
    b'a(-Dx="y z" a"b"c $(MAKEVAR) =x=)\n',
    b"a(b[[c]] [ ] [= x)\n",
    b'a("b"c"d" (e)f)\n',
    b"a(\xff\xfe)\n",
    b"#[=\na(x\ry)\n",
    b"if(A)\nELSEIF(B)\nelse()\n Foreach(x)\n endforeach()\nendif()\n",
    b"endless()\nend()\nif_any()\n",
    b"function(if)\nendfunction()\nmacro(m)\nendmacro()\nwhile(0)\nendwhile()\n",
]

BAD = [
    (b"project(x\nadd_library(y z)\n", 1, 'the "(" of project is never closed'),
    (b"a()\n\nb(c (d)\ne()\n", 3, 'the "(" of b is never closed'),
    (b"a()\nb(c))\n", 2, 'expected a command name, found ")"'),
    (b'a()\nb("c)\nd()\n', 2, "in the arguments of b, found a quoted argument that is never"),
    (b"a()\n#[[ b\nc()\n", 2, "expected a command name, found a bracket that is never closed"),
    (b"a(\n [==[ b ]=]\n)\n", 2, "in the arguments of a, found a bracket that is never closed"),
    (b"a() b()\n", 1, 'expected a new line before "b"'),
    (b"#[[x]] a()\n", 1, 'expected a new line before "a"'),
    (b"a()\nproject\n(x)\n", 2, 'expected "(" after project, found the end of the line'),
    (b"a()\nproject", 2, 'expected "(" after project, found the end of the file'),
    (b"<<<<<<< HEAD\na()\n", 1, 'expected a command name, found an unquoted argument, "<<<<<<<"'),
    (b"a()\n\x00\n", 2, "expected a command name, found a character that has no meaning here"),
    (b"a(b\\\n)\n", 1, "in the arguments of a, found a character that has no meaning here"),
    (b"a([[b]]c)\n", 1, "white space is missing between a bracket argument and a name"),
    (b'a("b"[[c]])\n', 1, "white space is missing between a quoted argument and a bracket"),
    (b"\xff\xfea\0(\0)\0\n\0", 1, "the byte order mark is not that of UTF-8"),
    (b"a()\nif(x)\n", 2, "if() is never closed by endif()"),
    (b"if(x)\nelse()\n", 1, "if() is never closed by endif()"),
    (b"a()\nendif()\n", 2, "endif() without if()"),
    (b"if(x)\nforeach(y)\nendif()\n", 3, "endif() without if(): foreach() of line 2 is still"),
    (b"if(x)\nelse()\nelseif(y)\nendif()\n", 3, "elseif() without an if(), or after its else()"),
    (b"foreach(x)\nelse()\nendforeach()\n", 2, "else() without an if(), or after its else()"),
]

PIECES = [
    *(bytes([byte]) for byte in b'a()"[]=# \t\r\n\\$;.9\x00\xff'),
    *(b"[[", b"]]", b"[=[", b"]=]", b"#[[", b"\r\n", b"$(x)", b'"x y"', b"foo(", b"x)\n"),
    *(b"if(1)\n", b"elseif(1)\n", b"else()\n", b"endif()\n", b"foreach(x)\n", b"endforeach()\n"),
]


def cmake_parses(data: bytes, folder: Path) -> bool:
    """CMake parses a script whole before it runs the first command, so return() runs nothing."""
    script = folder / "script.cmake"
    mark = b"\xef\xbb\xbf" if data.startswith(b"\xef\xbb\xbf") else b""
    script.write_bytes(mark + b"return()\n" + data.removeprefix(mark))
    ran = subprocess.run([str(CMAKE), "-P", script], capture_output=True, check=False)
    return ran.returncode == 0


@pytest.mark.parametrize("data", GOOD)
def test_what_cmake_parses_has_no_fault(data: bytes) -> None:
    assert find_fault(data) is None


@pytest.mark.parametrize(("data", "line", "message"), BAD)
def test_a_fault_has_its_line(data: bytes, line: int, message: str) -> None:
    fault = find_fault(data)
    assert isinstance(fault, SyntaxFault)
    assert fault.line == line
    assert fault.message.startswith(message)
    assert fault.message.isprintable()


def test_a_reason_is_given_where_there_is_one() -> None:
    fault = find_fault(b"endif()\n")
    assert fault == SyntaxFault(1, "endif() without if()")
    fault = find_fault(b"foreach(x)\nendif()\n")
    message = "endif() without if(): foreach() of line 1 is still open"
    assert fault == SyntaxFault(2, message)


@pytest.mark.skipif(CMAKE is None, reason="cmake is not installed")
def test_cmake_agrees_with_the_lists(tmp_path: Path) -> None:
    with_utf16 = b"\xff\xfe"
    for data in GOOD:
        assert cmake_parses(data, tmp_path), data
    for data, _, _ in BAD:
        if not data.startswith(with_utf16):
            assert not cmake_parses(data, tmp_path), data


@pytest.mark.skipif(CMAKE is None, reason="cmake is not installed")
@settings(
    max_examples=120,
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(pieces=st.lists(st.sampled_from(PIECES), max_size=14), in_command=st.booleans())
def test_cmake_agrees_with_any_mixture(
    tmp_path: Path, pieces: list[bytes], in_command: bool
) -> None:
    data = b"".join(pieces)
    if in_command:
        data = b"cmd(" + data + b")\n"
    assert (find_fault(data) is None) == cmake_parses(data, tmp_path)


@settings(database=None)
@given(st.binary(max_size=200) | st.lists(st.sampled_from(PIECES)).map(b"".join))
def test_tokens_are_the_whole_text_with_its_lines(data: bytes) -> None:
    text = data.replace(b"\r\n", b"\n")
    found = list(tokens(data))
    assert b"".join(token.text for token in found) == text
    at = 0
    for token in found:
        assert token.line == text.count(b"\n", 0, at) + 1
        at += len(token.text)
