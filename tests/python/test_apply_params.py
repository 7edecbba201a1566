"""`pytpc apply` on params files of ROS 2: the line that counts changes, and nothing else."""

from __future__ import annotations

from pathlib import Path

import pytest

from pytpc.base.errors import InputError
from pytpc.values.known import Known, Read
from pytpc.values.new_value import Refused
from pytpc.values.target import plan_yaml

FILE = """\
# limits
/**:
  ros__parameters:
    use_sim_time: false  # clock
    rate: 10
robot1:
  guard:
    ros__parameters:
      speed_limit: 4.0   # m/s
      name: 'front left'
      limits:
        min_coverage: 0.058
        deep: {er: [1.0, 2.5]}
      on: yes
      word: fast
  other: {ros__parameters: {rate: 5}}
"""


@pytest.fixture
def path(tmp_path: Path) -> Path:
    (tmp_path / "params.yaml").write_text(FILE)
    return tmp_path / "params.yaml"


@pytest.mark.parametrize(
    ("parameter", "given", "before", "after"),
    [
        ("speed_limit", "5", "speed_limit: 4.0 ", "speed_limit: 5.0 "),
        ("/robot1/guard/speed_limit", "5.25", "speed_limit: 4.0 ", "speed_limit: 5.25 "),
        ("guard/speed_limit", "1e3", "speed_limit: 4.0 ", "speed_limit: 1000.0 "),
        ("speed_limit", "1e-9", "speed_limit: 4.0 ", "speed_limit: 1.0e-09 "),
        ("speed_limit", "inf", "speed_limit: 4.0 ", "speed_limit: .inf "),
        ("limits.min_coverage", "0.03", "0.058", "0.03"),
        ("min_coverage", "1", "0.058", "1.0"),
        ("/robot1/guard/ros__parameters/limits/min_coverage", "1", "0.058", "1.0"),
        ("limits.deep.er", "[1, 3]", "[1.0, 2.5]", "[1.0, 3.0]"),
        ("name", "back", "'front left'", "'back'"),
        ("name", "5", "'front left'", "'5'"),
        ("word", "slow", "word: fast", "word: slow"),
        # rcl reads these words without quotes as a bool, a number and infinity.
        ("word", "y", "word: fast", "word: 'y'"),
        ("word", "1e3", "word: fast", "word: '1e3'"),
        ("word", "inf", "word: fast", "word: 'inf'"),
        ("on", "false", "on: yes", "on: no"),
        ("/**/rate", "12", "rate: 10", "rate: 12"),
        ("/robot1/guard/rate", "12", "rate: 10", "rate: 12"),
        ("/robot1/other/rate", "6", "rate: 5", "rate: 6"),
        ("other/rate", "6", "rate: 5", "rate: 6"),
    ],
)
def test_one_value_changes(path: Path, parameter: str, given: str, before: str, after: str) -> None:
    assert FILE.count(before) == 1
    assert plan_yaml(path, parameter, given).after.decode() == FILE.replace(before, after)


@pytest.mark.parametrize(
    ("parameter", "given", "line", "why"),
    [
        ("/**/rate", "4.5", 5, "the parameter is a whole number and '4.5' is not"),
        ("on", "2", 14, "the parameter is true or false and '2' is not"),
        ("/**/rate", "9223372036854775808", 5, "more than 64 bits"),
        ("deep.er", "[1]", 13, "the list has 2 values, but 1 were given"),
        ("rate", "1", None, "several values end with rate: /**/rate, /robot1/other/rate"),
        ("sped_limit", "1", None, "did you mean /robot1/guard/speed_limit?"),
        ("/robot2/guard/speed_limit", "1", None, "is not in the file"),
    ],
)
def test_refused(path: Path, parameter: str, given: str, line: int | None, why: str) -> None:
    with pytest.raises(InputError) as refused:
        plan_yaml(path, parameter, given)
    assert why in str(refused.value)
    assert refused.value.line == line


def test_an_entry_for_all_nodes_is_warned_about(path: Path) -> None:
    notes = plan_yaml(path, "/**/rate", "12").notes
    assert notes == (
        "/** sets it for every node that loads the file; of those that the file names, 1:"
        " /robot1/guard",
        "/robot1/other has a value of its own in line 16, which stays",
    )


def test_a_later_value_of_another_type_does_not_count(tmp_path: Path) -> None:
    path = tmp_path / "params.yaml"
    # A node gets 4: rcl keeps the int that the entry has already.
    path.write_text("/a:\n  ros__parameters:\n    x: 4\n    x: 4.5\n")
    change = plan_yaml(path, "x", "5")
    assert change.after.decode() == "/a:\n  ros__parameters:\n    x: 5\n    x: 4.5\n"
    assert change.notes == (
        "line 4 sets it to a value of another type, which rcl does not let replace it",
    )


@pytest.mark.parametrize("newline", ["\n", "\r\n"])
@pytest.mark.parametrize("start", ["", "\ufeff"])
def test_line_ends_and_byte_order_mark_stay(tmp_path: Path, newline: str, start: str) -> None:
    path = tmp_path / "params.yaml"
    text = start + FILE.replace("\n", newline)
    path.write_bytes(text.encode())
    assert plan_yaml(path, "speed_limit", "5").after == text.replace(": 4.0", ": 5.0").encode()


@pytest.mark.parametrize(
    ("parameter", "after", "added"),
    [
        ("/robot1/guard/extra", "      word: fast\n", "      extra: 3\n"),
        (
            "/robot1/guard/limits.max",
            "        deep: {er: [1.0, 2.5]}\n",
            "        max: 3\n",
        ),
        ("/a/b/limits.max", FILE, "/a/b:\n  ros__parameters:\n    limits.max: 3\n"),
    ],
)
def test_a_missing_key_is_added_on_demand(
    path: Path, parameter: str, after: str, added: str
) -> None:
    with pytest.raises(InputError, match="is not in the file"):
        plan_yaml(path, parameter, "3")
    change = plan_yaml(path, parameter, "3", add=True)
    assert change.after.decode() == FILE.replace(after, after + added)


def test_nothing_is_added_where_that_is_not_plain(path: Path) -> None:
    with pytest.raises(InputError, match="not one a line"):
        plan_yaml(path, "/robot1/other/extra", "3", add=True)


@pytest.mark.parametrize(
    ("text", "line", "why"),
    [
        ("    a: [1, 2.0]\n", 3, "values of the types int and double"),
        ("    a:\n    b: 1\n", 3, "no value"),
        ("    a: &x 1\n    b: *x\n", 4, "does not read aliases"),
        ("    a: [{b: 1}]\n", 3, "does not read maps in lists"),
        ("    a: {b: 1\n", 4, "not YAML"),
        ("  b: 5\n", 2, "a value that is not below ros__parameters"),
    ],
)
def test_what_rcl_refuses_is_one_line_with_the_place(
    tmp_path: Path, text: str, line: int, why: str
) -> None:
    path = tmp_path / "params.yaml"
    path.write_text(f"/**:\n  ros__parameters:\n{text}")
    with pytest.raises(InputError) as refused:
        plan_yaml(path, "b", "2")
    assert (refused.value.line, why in str(refused.value)) == (line, True), refused.value


def test_the_declared_type_counts(tmp_path: Path) -> None:
    path = tmp_path / "params.yaml"
    path.write_text("/**:\n  ros__parameters:\n    limit: 4\n")
    # A node that declares a double ends at its start if the file has the int 4.
    known = Known((Read("limit", "/ws/guard.py", "double", 6),))
    with pytest.raises(Refused) as refused:
        known.check_type(["/robot1/guard/limit"], 5)
    assert str(refused.value) == (
        "/ws/guard.py:6 declares limit as double, so the node would refuse the int 5; give 5.0 with"
        " --force"
    )
    known.check_type(["/robot1/guard/limit"], 5.0)
    known.check_type(["/robot1/guard/other"], 5)
    forced = plan_yaml(path, "limit", "5.0", force=True)
    assert forced.after.decode() == "/**:\n  ros__parameters:\n    limit: 5.0\n"
