"""The passes and the independent check (tests/oracle) agree on random programs."""

import pytest

from tests.oracle import run
from tests.oracle.checker import Rules
from tests.oracle.control import EXIT, ControlDependence
from tests.oracle.generator import Program, program, text
from tests.oracle.ir import parse
from tests.oracle.memory import Memory
from tests.oracle.memory import Program as Known

# More of them: python -m tests.oracle.run
SEEDS = range(1000, 1100)
# Of programs with more kinds of code.
EXTENDED = range(1, 21)
# Seeds that differ, and how. One that agrees again must be taken out.
KNOWN: dict[int, str] = {}

needs_passes = pytest.mark.skipif(not run.PLUGIN.exists(), reason="the passes are not built")


@needs_passes
@pytest.mark.parametrize(("seeds", "extended"), [(SEEDS, False), (EXTENDED, True)])
def test_the_passes_find_what_the_definition_says(tmp_path, seeds, extended):
    differing = {}
    for batch in run.batches(seeds, extended):
        answers = run.compare([program(s, f"p{s}", extended) for s in batch], tmp_path)
        for seed, answer in zip(batch, answers, strict=True):
            if difference := answer.difference():
                differing[seed] = difference
    assert differing.keys() == KNOWN.keys() & set(seeds), differing


def test_a_difference_of_distance_is_one():
    one = {(3, 7, "limit", "parameter", ">"): 1}
    other = {(3, 7, "limit", "parameter", ">"): 2}
    assert run.Answers(one, one).difference() == []
    assert len(run.Answers(one, other).difference()) == 1
    assert len(run.Answers({}, one).difference()) == 1


def test_of_two_operands_the_passes_may_report_the_threshold_alone():
    threshold = {(3, 7, "limit", "parameter", ">"): 1}
    both = threshold | {(3, 7, "upper", "parameter", "<"): 1}
    assert run.Answers(threshold, both).difference() == []
    assert len(run.Answers(both, threshold).difference()) == 1
    assert len(run.Answers({}, both).difference()) == 2


def test_of_two_ways_to_a_place_the_passes_name_one():
    ways = {(3, 7, "limit", t, ">"): 1 for t in ("parameter", "derived")}
    one = {(3, 7, "limit", "derived", ">"): 1}
    assert run.Answers(one, ways).difference() == []
    assert len(run.Answers(ways, one).difference()) == 1


def test_a_flag_may_stand_for_what_it_also_is_by_arithmetic():
    flag = {(3, 2, "limit", "flag", "flag"): 1}
    both = flag | {(3, 7, "limit", "derived", "!="): 1}
    assert run.Answers(flag, both).difference() == []
    assert len(run.Answers({}, both).difference()) == 2
    far = flag | {(3, 7, "limit", "derived", "!="): 2}
    assert len(run.Answers(flag, far).difference()) == 1
    other = flag | {(3, 7, "limit", "derived", ">"): 1}
    assert len(run.Answers(flag, other).difference()) == 1


def test_a_program_is_the_same_again():
    assert program(7, "p").text() == program(7, "p").text()
    assert program(7, "p").text() != program(8, "p").text()
    assert program(7, "p", extended=True).text() == program(7, "p", extended=True).text()


def test_what_a_loop_made_of_a_value_may_be_of_any_type():
    checker = {(3, 7, "limit", "repeated", ">"): 1}
    for type_ in ("parameter", "derived"):
        assert run.agree({(type_, ">"): 1}, {("repeated", ">"): 1})
    assert not run.agree({("derived", "<"): 1}, {("repeated", ">"): 1})
    assert len(run.Answers({}, checker).difference()) == 1


def test_shrinking_keeps_only_what_matters():
    whole = Program("p", tuple(text(f"int A{n};") for n in range(9)))
    small = run.shrink(whole, lambda p: "A4;" in p.text())
    assert [s.parts for s in small.body] == [("int A4;",)]


def test_control_dependence_by_hand():
    # top -> (left | join), left -> join: left depends on top, join on nothing.
    module = parse(
        "define void @f(i1 %c) {\n"
        "top:\n  br i1 %c, label %left, label %join\n"
        "left:\n  br label %join\n"
        "join:\n  ret void\n}\n"
    )
    top, left, join = module.functions["f"].blocks
    control = ControlDependence(module.functions["f"])
    assert control.controllers(left, left.terminator) == ({top.terminator}, False)
    assert control.controllers(join, join.terminator) == (set(), True)
    assert control.graph.has_edge((join, ()), EXIT)


def test_a_load_that_begins_its_function_sees_what_others_wrote():
    # @reads replaces @g only after it has read it: it sees the store of @writes, and its own.
    module = parse(
        "@g = internal global i8 0\n"
        "define void @writes(i8 %v) {\n  store i8 %v, ptr @g\n  ret void\n}\n"
        "define i8 @reads() {\n  %l = load i8, ptr @g\n  store i8 1, ptr @g\n  ret i8 %l\n}\n"
    )
    store, _ = module.functions["writes"].instructions
    load, own, _ = module.functions["reads"].instructions
    memory = Memory(module, Known(module, Rules()))
    assert memory.definitions(load) == {store, own}
