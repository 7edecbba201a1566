from __future__ import annotations

import numpy as np
import pyarrow as pa
import pytest
from fleet_samples import Flight, digest, table

from pytpc.base.errors import InputError
from pytpc.diagnosis.fleet.rows import COLUMNS, Rows, without_robot
from pytpc.diagnosis.fleet.settings import Settings


def values(*rows):
    names = ("mission", "robot", "name", "time_ns", "value", "number")
    kinds = (pa.string(), pa.string(), pa.string(), pa.int64(), pa.string(), pa.float64())
    schema = pa.schema(list(zip(names, kinds, strict=True)))
    return pa.Table.from_pylist([dict(zip(names, row, strict=True)) for row in rows], schema=schema)


def known(settings):
    """The values of each parameter by mission number."""
    found = {}
    for code, name in enumerate(settings.parameters):
        own = settings.entries(code)
        texts = [settings.setting(code, one).text for one in settings.value[own].tolist()]
        found[name] = dict(zip(settings.mission[own].tolist(), texts, strict=True))
    return found


def test_missions_are_in_the_order_of_their_time():
    late, early = Flight("a", day=3), Flight("b", day=2, verdict="bad")
    rows = Rows.of(table([digest(late, 1), digest(late, 0), digest(early, 0)]))
    assert rows.missions == ("b", "a")
    assert rows.bad.tolist() == [True, False]
    assert [(one.parameter, one.place) for one in rows.series] == [
        ("/nav/p0", "src/nav.cpp:10"),
        ("/nav/p1", "src/nav.cpp:11"),
    ]
    assert rows.mission.tolist() == [0, 1, 1]
    assert rows.which.tolist() == [0, 0, 1]


def test_two_robots_may_have_a_mission_of_one_name():
    rows = Rows.of(table([digest(Flight("m", "r1")), digest(Flight("m", "r2", verdict="bad"))]))
    assert rows.places == {("r1", "m"): 0, ("r2", "m"): 1}
    assert rows.bad.tolist() == [False, True]


def test_a_comparison_of_two_robots_is_one_without_their_namespaces():
    one = digest(Flight("m1", "r-1"), node="/r_1/nav", parameter="/r_1/nav/p0")
    other = digest(Flight("m2", "r2"), node="/r2/nav", parameter="/r2/nav/p0")
    rows = Rows.of(table([one, other]))
    assert [(one.node, one.parameter) for one in rows.series] == [("/nav", "/nav/p0")]


def test_only_a_whole_namespace_is_the_robots():
    assert without_robot("/r2/a", "r2") == "/a"
    assert without_robot("/r22/a", "r2") == "/r22/a"
    assert without_robot("/a/r2/b", "r2") == "/a/r2/b"


# The third mission has object 5 alone: by its name it is the first one of it.
def test_instances_of_one_name_are_counted_in_each_mission():
    base = digest(Flight("x"))["key"]
    rows = [
        digest(Flight("m1", day=1), key=f"{base}#1", turns=1),
        digest(Flight("m1", day=1), key=f"{base}#2", turns=2),
        digest(Flight("m2", day=2), key=f"{base}#4", turns=4),
        digest(Flight("m2", day=2), key=f"{base}#3", turns=3),
        digest(Flight("m3", day=3), key=f"{base}#5", turns=5),
    ]
    found = Rows.of(table(rows))
    assert [(one.key, one.number) for one in found.series] == [(base, 0), (base, 1)]
    assert found.which.tolist() == [0, 0, 0, 1, 1]
    assert found.turns.tolist() == [1, 3, 5, 2, 4]


# The robot is called as a namespace that only one of its drivers has.
def test_nodes_with_one_name_without_the_robots_namespace_are_two():
    rows = [
        digest(Flight("m", "robot"), node=node, parameter="~limit", turns=turns)
        for node, turns in (("/robot/driver", 7), ("/driver", 3))
    ]
    found = Rows.of(table(rows))
    assert [(one.node, one.number) for one in found.series] == [("/driver", 0), ("/driver", 1)]
    assert found.turns.tolist() == [3, 7]


# 12 turns in 30 s are 24 a minute. The median margin has the sign of the usual result.
def test_measures_of_a_row():
    rows = Rows.of(table([digest(Flight("m"), turns=12, seconds=30.0, true_share=0.4)]))
    assert rows.turn_rate.tolist() == [24.0]
    assert rows.signed_median.tolist() == [-0.2]
    assert Rows.of(table([digest(Flight("m"), seconds=0.0)])).turn_rate.tolist() == [0.0]


def test_what_was_ever_true_or_false():
    always = digest(Flight("m"), 0, turns=0)
    never = digest(Flight("m"), 1, turns=0, true_share=0.0, result_first=False, result_last=False)
    shortly = digest(Flight("m"), 2, turns=2, true_share=1.0)
    rows = Rows.of(table([always, never, shortly]))
    assert rows.was_true.tolist() == [True, False, True]
    assert rows.was_false.tolist() == [False, True, True]


def test_partitions_and_dictionaries_are_read_like_text():
    plain = table([digest(Flight("1"), 0), digest(Flight("2"), 1)])
    encoded = plain
    for name in ("key", "node", "robot", "verdict"):
        place = encoded.column_names.index(name)
        encoded = encoded.set_column(place, name, encoded.column(name).dictionary_encode())
    place = encoded.column_names.index("mission")
    encoded = encoded.set_column(place, "mission", encoded.column("mission").cast(pa.int64()))
    assert Rows.of(encoded).series == Rows.of(plain).series
    assert Rows.of(encoded).missions == ("1", "2")


def test_an_empty_table_has_no_missions():
    rows = Rows.of(table([]))
    assert (len(rows), rows.missions, rows.series) == (0, (), ())


@pytest.mark.parametrize("name", COLUMNS)
def test_a_missing_column_is_named(name):
    with pytest.raises(InputError, match=f"no column {name}"):
        Rows.of(table([digest(Flight("m"))]).drop_columns([name]))


def test_a_broken_table_is_refused():
    with pytest.raises(InputError, match="two rows of one comparison"):
        Rows.of(table([digest(Flight("m")), digest(Flight("m"))]))
    with pytest.raises(InputError, match="more than one verdict"):
        Rows.of(table([digest(Flight("m"), 0), digest(Flight("m", verdict="bad"), 1)]))
    with pytest.raises(InputError, match="1 missing values"):
        Rows.of(table([digest(Flight("m"), turns=None)]))
    rows = table([digest(Flight("m"))])
    place = rows.column_names.index("seconds")
    with pytest.raises(InputError, match="seconds is string, not numbers"):
        Rows.of(rows.set_column(place, "seconds", pa.array(["long"])))


def test_thresholds_are_the_values_where_nothing_else_is_known():
    rows = Rows.of(
        table(
            [
                digest(Flight("m1", day=1), 0, 0.30000001192092896),
                digest(Flight("m2", day=2), 0, 0.3),
                digest(Flight("m1", day=1), 1, 1.0, kind="flag", relation="flag"),
                digest(Flight("m2", day=2), 1, 7.0, kind="flag", relation="flag", thresholds=3),
                # 57.29 degrees are 1 radian: the derived threshold counts only by itself.
                digest(Flight("m1", day=1), 2, 1.0, parameter="/nav/p0", kind="derived"),
                digest(Flight("m1", day=1), 3, 2.5, kind="derived"),
            ]
        )
    )
    settings = Settings.of(rows)
    assert known(settings) == {
        "/nav/p0": {0: "0.3", 1: "0.3"},
        "/nav/p1": {0: "true"},
        "/nav/p3": {0: "2.5"},
    }
    assert np.unique(settings.value[settings.entries(0)]).size == 1


def test_recorded_parameters_come_before_thresholds():
    rows = Rows.of(
        table(
            [
                digest(Flight("m1", "r2", day=1), 0, 0.4),
                digest(Flight("m2", "r2", day=2), 0, 0.4),
                digest(Flight("m1", "r2", day=1), 1, parameter="~limit", node="/r2/nav"),
            ]
        )
    )
    recorded = values(
        ("m1", "r2", "/r2/nav/p0", None, "0.5", 0.5),
        ("m1", "r2", "/r2/nav/limit", None, "3", 3.0),
        ("m1", "r2", "/r2/gain", None, "[1, 2]", None),
        ("m1", "r2", "/r2/use", None, "true", None),
        ("m1", "r1", "/gain", None, "9", 9.0),
        ("m9", "r2", "/gain", None, "9", 9.0),
    )
    assert known(Settings.of(rows, recorded)) == {
        "/nav/p0": {0: "0.5", 1: "0.4"},
        "~limit": {0: "3"},
        "/gain": {0: "[1, 2]"},
        "/use": {0: "true"},
    }


def test_a_value_that_changed_in_a_mission_is_one_of_its_own():
    rows = Rows.of(table([digest(Flight("m1"), 0, 0.5)]))
    recorded = values(
        ("m1", "r1", "/nav/p0", 20, "0.2", 0.2),
        ("m1", "r1", "/nav/p0", None, "0.5", 0.5),
        ("m1", "r1", "/nav/p0", 10, "0.8", 0.8),
    )
    settings = Settings.of(rows, recorded)
    assert known(settings) == {"/nav/p0": {0: "0.5, 0.8, 0.2"}}
    assert settings.setting(0, int(settings.value[0])).number is None


def test_a_value_that_is_no_number_does_not_stop_the_rest():
    rows = Rows.of(table([digest(Flight("m1"), 0, 0.5)]))
    recorded = values(
        ("m1", "r1", "/a", None, "1e999", None),
        ("m1", "r1", "/b", None, "{broken", None),
        ("m1", "r1", "/c", None, "[" * 100_000, None),
        ("m1", "r1", "/d", None, "1" + "0" * 400, None),
        ("m1", "r1", "/e", None, '"\\u001b[31m"', None),
    )
    found = known(Settings.of(rows, recorded))
    assert found["/b"] == {0: "{broken"}
    assert len(found["/c"][0]) == 43
    assert found["/e"] == {0: "\N{REPLACEMENT CHARACTER}[31m"}
    assert {"/a", "/d"} <= found.keys()
