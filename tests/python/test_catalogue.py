"""The page with all TPCs."""

import base64
import hashlib
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
from static_units import KEYS, comparison, failed_unit, step, unit

from pytpc.conditions.cpp_conditions import Condition, Macro
from pytpc.conditions.lookup import Answer
from pytpc.conditions.tpc_details import details
from pytpc.present.page.catalogue import render
from pytpc.static.link_unit import LinkUnit
from pytpc.static.static_info import StaticInfo

NASTY = '</script><img src=x onerror="alert(1)">&amp;'


class Page(HTMLParser):
    """Tags, their attributes and the text below each."""

    VOID = frozenset({"meta", "input", "br", "img", "link"})

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.texts: dict[str, list[str]] = {}
        self._open: list[str] = []
        self.feed(text)
        assert self._open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in self.VOID:
            self._open.append(tag)
            self.texts.setdefault(tag, []).append("")

    def handle_endtag(self, tag: str) -> None:
        assert self._open.pop() == tag

    def handle_data(self, data: str) -> None:
        for tag in self._open:
            self.texts[tag][-1] += data

    def count(self, tag: str, kind: str = "") -> int:
        return sum(1 for name, attributes in self.tags
                   if name == tag and (not kind or attributes.get("class") == kind))  # fmt: skip


def page_of(*units: dict[str, Any], answers: dict[str, Answer] | None = None) -> str:
    static = StaticInfo.of(LinkUnit.from_json(data, Path("x.json")) for data in units)
    known = answers or {}
    found = [
        details(static, tpc, known.get(tpc.key, Answer(None, "the file is gone")))
        for tpc in static.tpcs
    ]
    return render(static, found, "All <i>of</i> them")


TWO_PACKAGES = (
    unit(comparisons=[comparison(), comparison(key=KEYS[1], lineno=50, source="other")]),
    unit(package="arm", source_root="/ws/src/arm", comparisons=[comparison(key=KEYS[2])]),
    failed_unit(),
)


def test_by_package_and_file() -> None:
    page = Page(page_of(*TWO_PACKAGES))
    assert page.texts["h1"] == ["All <i>of</i> them"]
    assert [" ".join(text.split()) for text in page.texts["h2"]] == ["arm 1", "face 2"]
    assert page.texts["h3"] == ["src/detector.cpp", "src/detector.cpp"]
    assert page.count("details", "tpc") == 3
    assert page.count("details", "way-of") == 3
    assert page.texts["p"].count(
        "face/broken was not analysed and reports nothing: the instrumented module does not verify"
    ) == 1  # fmt: skip


def test_it_asks_the_network_for_nothing_and_runs_no_script_but_its_own() -> None:
    text = page_of(*TWO_PACKAGES)
    page = Page(text)
    assert page.count("script") == 1
    assert page.count("link") == page.count("img") == 0
    assert not any({"src", "href"} & attributes.keys() for _, attributes in page.tags)
    assert re.findall(r"https?://", text) == []
    (policy,) = (
        attributes["content"] or ""
        for tag, attributes in page.tags
        if attributes.get("http-equiv") == "Content-Security-Policy"
    )
    # The policy names the script by what it is, so that another one does not run.
    digest = hashlib.sha256(page.texts["script"][0].encode()).digest()
    assert f"script-src 'sha256-{base64.b64encode(digest).decode()}'" in policy
    assert "default-src 'none'" in policy


def test_without_its_script_all_is_there_and_the_filter_is_not() -> None:
    page = Page(page_of(*TWO_PACKAGES))
    hidden = [attributes for _, attributes in page.tags if "hidden" in attributes]
    assert [attributes["id"] for attributes in hidden] == ["controls"]


def test_whatever_comes_from_the_sources_is_escaped() -> None:
    found = comparison(
        source=NASTY, source_code=NASTY, topic=NASTY, name=NASTY, default=NASTY, function=NASTY,
        path=[step("compare", 40, NASTY, source_code=NASTY, file=NASTY)],
    )  # fmt: skip
    macro = Macro(NASTY, NASTY, 1, NASTY)
    condition = Condition("if", NASTY, 40, 1, 40, 9, macro)
    data = unit(package=NASTY, comparisons=[found], source_root=f"/{NASTY}")
    for answers in ({}, {KEYS[0]: Answer(condition, NASTY)}):
        page = Page(page_of(data, failed_unit(failure=NASTY), answers=answers))
        assert page.count("script") == 1
        assert page.count("img") == 0
        (summary,) = (text for text in page.texts["summary"] if "line 40" in text)
        assert NASTY in summary


@pytest.fixture
def source(tmp_path: Path) -> Path:
    (tmp_path / "src").mkdir()
    lines = ["{", "  before();", "  if (a >", "\t  b) c();", "  behind();", "}", "far();"]
    (tmp_path / "src/detector.cpp").write_text("\r\n".join(lines), encoding="utf-8")
    return tmp_path


def test_what_cannot_be_seen_is_a_sign_and_turns_no_text_around() -> None:
    page = page_of(
        unit(comparisons=[comparison(source="a\u202eb\x1b\0", source_code="\tif\u2066;")])
    )
    assert Page(page).texts["span"].count("a\ufffdb\ufffd\ufffd") == 1
    assert "\tif\ufffd;" in page
    assert not set("\u202e\u2066\x1b\0").intersection(page)


def test_the_condition_is_marked_in_its_lines(source: Path) -> None:
    found = comparison(lineno=3, column=9, source_code="if (a >")
    condition = Condition("if", "a >\r\n\t  b", 3, 7, 4, 5)
    text = page_of(
        unit(source_root=str(source), comparisons=[found]), answers={KEYS[0]: Answer(condition)}
    )
    page = Page(text)
    # Two lines before and after; what is marked begins behind the indentation.
    assert page.texts["mark"] == ["a >", "b"]
    (code,) = page.texts["pre"]
    assert [line[1:] for line in code.splitlines()] == [
        "{", "  before();", "  if (a >", "\t  b) c();", "  behind();", "}",
    ]  # fmt: skip


def test_without_the_condition_it_is_the_line_and_why() -> None:
    page = Page(page_of(unit()))
    assert page.texts["mark"] == ["if (coverage > min_coverage_limit_)"]
    assert "only the line is known: the file is gone" in page.texts["p"]


def test_the_same_static_information_makes_the_same_bytes() -> None:
    assert page_of(*TWO_PACKAGES) == page_of(*reversed(TWO_PACKAGES))


def test_the_filter_looks_into_names_topics_keys_and_text() -> None:
    page = Page(page_of(unit()))
    (words,) = (a["data-words"] for _, a in page.tags if "data-words" in a)
    assert words is not None
    for word in (
        "min_coverage_limit",
        "capture",
        KEYS[0],
        "coverage >",
        "face/detector",
        "onimage",
    ):
        assert word in words


def test_nothing_found_is_said() -> None:
    assert "No comparisons." in page_of(unit(comparisons=[]))
