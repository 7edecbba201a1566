"""What is said of a TPC in words."""

from pathlib import Path
from typing import Any

import pytest
from static_units import KEYS, comparison, unit

from pytpc.conditions.lookup import Answer
from pytpc.conditions.tpc_details import ExposedDetails, details, in_words, shown_default
from pytpc.static.link_unit import LinkUnit, Transform
from pytpc.static.static_info import StaticInfo


@pytest.mark.parametrize(
    ("transform", "words"),
    [
        (Transform("affine", 0.5, 3.0), "0.5 times the parameter, plus 3"),
        (Transform("affine", 1.0, -0.15), "the parameter, minus 0.15"),
        (Transform("affine", -1.0, 0.0), "the negative of the parameter"),
        (
            Transform("affine", 0.017453292519943295, 0.0),
            "0.017453292519943295 times the parameter",
        ),
        (Transform("expression", None, None, "x^2 + 1"), "x^2 + 1, where x is the parameter"),
    ],
)
def test_arithmetic_in_words(transform: Transform, words: str) -> None:
    assert in_words(transform) == words


@pytest.mark.parametrize(
    ("default", "shown"),
    [
        (None, "none in the source"),
        (True, "true"),
        (1, "1"),
        (0.25, "0.25"),
        # 0.2f, as the analysis finds it.
        (0.20000000298023224, "0.2"),
        ("left", '"left"'),
    ],
)
def test_defaults_as_they_are_written(default: Any, shown: str) -> None:
    assert shown_default(default) == shown


def test_a_default_in_python_is_as_python_has_it() -> None:
    assert shown_default(True, python=True) == "True"
    data = unit(comparisons=[comparison(default=False)])
    data["tool"] = {**data["tool"], "analysis": "python"}
    static = StaticInfo.of([LinkUnit.from_json(data, Path("x"))])
    assert details(static, static.tpcs[0], Answer(None)).shown_defaults == ("False",)


def test_what_the_units_say_differently_is_all_there() -> None:
    read = [{"file": "src/detector.cpp", "lineno": 12}, {"file": "src/main.cpp", "lineno": 3}]
    at = {"file": "src/main.cpp", "lineno": 9}
    static = StaticInfo.of(
        LinkUnit.from_json(data, Path("x.json"))
        for data in (
            unit(comparisons=[comparison(distance=5, default=1)]),
            unit(
                link_unit="other",
                comparisons=[
                    comparison(
                        key=KEYS[1],
                        default=True,
                        param_reads=read,
                        exposed_at=at,
                        publishes=[at],
                        topic=None,
                    )
                ],
            ),
        )
    )
    (tpc,) = static.tpcs
    found = details(static, tpc, Answer(None, "gone"))
    assert found.nearest.key == KEYS[1]
    # 1 and true are two defaults, though Python takes them for equal.
    assert [str(each) for each in found.defaults] == ["True", "1"]
    assert found.reads == ("src/detector.cpp:12", "src/main.cpp:3")
    assert found.exposed == (
        ExposedDetails("src/main.cpp:9", None),
        ExposedDetails("src/detector.cpp:41", "capture"),
    )
    assert found.source_text == "if (coverage > min_coverage_limit_)"
