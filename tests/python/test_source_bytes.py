"""Source files in other encodings than UTF-8, as columns count their bytes."""

from pathlib import Path

import pytest
from static_units import comparison, unit

from pytpc.base.source_bytes import source_bytes
from pytpc.present.page.source import source_lines
from pytpc.static.link_unit import LinkUnit
from pytpc.static.static_info import StaticInfo

UMLAUT = "höhe = 1\n"


@pytest.mark.parametrize(
    ("raw", "expected"),
    [
        (b"# -*- coding: latin-1 -*-\nh\xf6he = 1\n", "# -*- coding: latin-1 -*-\n" + UMLAUT),
        (b"#!/usr/bin/python3\n# vim: set fileencoding=cp1252 :\n\x80\n",
         "#!/usr/bin/python3\n# vim: set fileencoding=cp1252 :\n\u20ac\n"),
        (b"\xef\xbb\xbf" + UMLAUT.encode(), UMLAUT),
        (UMLAUT.encode(), UMLAUT),
    ],
    ids=["latin-1", "second line", "byte order mark", "utf-8"],
)  # fmt: skip
def test_what_a_file_declares(tmp_path: Path, raw: bytes, expected: str) -> None:
    file = tmp_path / "node.py"
    file.write_bytes(raw)
    assert source_bytes(file).decode() == expected


@pytest.mark.parametrize("raw", [b"h\xf6he\n", b"# coding: klingon\n", b"# coding: ascii\n\xf6"])
def test_what_cannot_be_decoded_stays(tmp_path: Path, raw: bytes) -> None:
    file = tmp_path / "node.cpp"
    file.write_bytes(raw)
    assert source_bytes(file) == raw


def test_a_report_shows_such_a_line(tmp_path: Path) -> None:
    (tmp_path / "node.py").write_bytes(b"# coding: latin-1\nif h\xf6he > limit:\n    pass\n")
    found = comparison(file="node.py", lineno=2, source_code="if höhe > limit:")
    static = StaticInfo.of(
        [LinkUnit.from_json(unit(source_root=str(tmp_path), comparisons=[found]), Path("x.json"))]
    )
    lines, note = source_lines(static, static.comparisons[found["key"]])
    assert note == ""
    assert [line.text for line in lines][:2] == ["# coding: latin-1", "if höhe > limit:"]
