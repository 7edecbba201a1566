"""Control dependence and slices of Python nodes."""

from pathlib import Path
from textwrap import dedent

import pytest
from python_analysis_samples import analysed, found, marked

_READ = "limit = rospy.get_param('~limit')\nother = rospy.get_param('~other')\n"
_SUB = "\nrospy.Subscriber('in', Float64, cb)\n"

BODIES = {
    "early return": """
        def cb(msg):
            if msg.data < limit:  #: ~limit <
                return
            pub.publish(msg)
    """,
    "the decision only logs": """
        def cb(msg):
            if msg.data < limit:
                rospy.loginfo("low")
            pub.publish(msg)
    """,
    "what is chosen is published": """
        def cb(msg):
            out = Float64()
            if msg.data < limit:  #: ~limit <
                out.data = 1.0
            pub.publish(out)
    """,
    "what is chosen is dead": """
        def cb(msg):
            out = Float64()
            if msg.data < limit:
                out.data = 1.0
            out = Float64()
            pub.publish(out)
    """,
    "continue and break": """
        def cb(msg):
            for value in range(3):
                if value > limit:  #: ~limit >
                    continue
                if msg.data > other:  #: ~other >
                    break
                pub.publish(value)
    """,
    "loops with else": """
        def cb(msg):
            for value in msg.data:
                if value > limit:  #: ~limit >
                    break
            else:
                pub.publish(1)
            while msg.data:
                if msg.data < other:  #: ~other <
                    break
            else:
                pub.publish(2)
    """,
    "while": """
        def cb(msg):
            n = 0
            while n < limit:  #: ~limit <
                n += 1
                pub.publish(n)
    """,
    "conditional expression, walrus, chain": """
        def cb(msg):
            pub.publish(1 if msg.data > limit else 2)  #: ~limit >
            if (v := msg.data) > other:  #: ~other >
                pub.publish(v)
            if limit < msg.data <= other:  #: ~limit >, ~other <=
                pub.publish(0)
    """,
    "and, or, not": """
        def cb(msg):
            if not (msg.data < limit or msg.ok and msg.data >= other):  #: ~limit <, ~other >=
                pub.publish(msg)
    """,
    "and as a value": """
        def cb(msg):
            high = msg.ok and msg.data > limit  #: ~limit >
            if high:
                pub.publish(msg)
    """,
    "outcome stored, handed on, returned": """
        class State:
            hot = False
        state = State()
        def is_high(value):
            return value > limit  #: ~limit >
        def note(hot):
            state.hot = hot
        def cb(msg):
            note(msg.data > other)  #: ~other >
            if is_high(msg.data) or state.hot:
                pub.publish(msg)
    """,
    "the outcome alone is published": """
        def cb(msg):
            pub.publish(msg.data > limit)  #: ~limit >
    """,
    "assert": """
        def cb(msg):
            assert msg.data < limit  #: ~limit <
            pub.publish(msg)
    """,
    "comprehension": """
        def cb(msg):
            good = [v for v in msg.values if v > limit]  #: ~limit >
            pub.publish(good)
            if any(v > other for v in msg.values):  #: ~other >
                pub.publish(0)
    """,
    "comprehension that is not used": """
        def cb(msg):
            good = [v for v in msg.values if v > limit]
            rospy.loginfo(good)
            pub.publish(0)
    """,
    "try, except, finally": """
        def cb(msg):
            try:
                if msg.data > limit:  #: ~limit >
                    raise ValueError("high")
                pub.publish(msg)
            except ValueError:
                if msg.data > other:  #: ~other >
                    pub.publish(0)
            finally:
                rospy.loginfo("done")
    """,
    "finally publishes in any case": """
        def cb(msg):
            try:
                if msg.data > limit:
                    return
                rospy.loginfo("low")
            finally:
                pub.publish(0)
    """,
    "a function that raises": """
        class TooHigh(Exception):
            pass
        def check(value):
            if value > limit:  #: ~limit >
                raise TooHigh()
        def cb(msg):
            check(msg.data)
            pub.publish(msg)
    """,
    "a function that raises what is caught": """
        def check(value):
            if value > limit:
                raise ValueError()
        def cb(msg):
            try:
                check(msg.data)
            except ValueError:
                rospy.loginfo("high")
            pub.publish(msg)
    """,
    "with": """
        import threading
        lock = threading.Lock()
        def cb(msg):
            with lock:
                if msg.data > limit:  #: ~limit >
                    pub.publish(msg)
    """,
    "match": """
        def cb(msg):
            match limit:  #: ~limit flag
                case 1:
                    pub.publish(1)
                case _:
                    pass
            match msg.data:
                case v if v > other:  #: ~other >
                    pub.publish(v)
    """,
    "flags": """
        def cb(msg):
            if limit:  #: ~limit flag
                pub.publish(1)
            if not other and msg.ok:  #: ~other flag
                pub.publish(2)
    """,
    "state decides later": """
        class State:
            high = False
            idle = False
        state = State()
        def cb(msg):
            if msg.data > limit:  #: ~limit >
                state.high = True
            if msg.data > other:
                state.idle = True
            if state.high:
                pub.publish(msg)
    """,
    "none, in, is": """
        def cb(msg):
            if limit is None or msg.data in other:  #: ~limit ==, ~other ==
                pub.publish(msg)
    """,
    "generator": """
        def good(values):
            for v in values:
                if v > limit:  #: ~limit >
                    yield v
        def cb(msg):
            for v in good(msg.values):
                pub.publish(v)
    """,
    "async": """
        async def run(msg):
            if msg.data > limit:  #: ~limit >
                await send(msg)
        async def send(msg):
            pub.publish(msg)
        def cb(msg):
            run(msg)
    """,
    "decorator": """
        import functools
        def guarded(function):
            @functools.wraps(function)
            def inner(msg):
                if msg.data > limit:  #: ~limit >
                    return function(msg)
            return inner
        @guarded
        def cb(msg):
            pub.publish(msg)
    """,
    "counter": """
        count = 0
        def cb(msg):
            global count
            if msg.data > limit:  #: ~limit >
                count += 1
            if count >= other:  #: ~other >=
                count = 0
                pub.publish(msg)
    """,
    "a list that is filled": """
        def cb(msg):
            kept = []
            for value in msg.values:
                if value < limit:  #: ~limit <
                    kept.append(value)
            pub.publish(kept)
    """,
    "the subscription": """
        def cb(msg):
            pub.publish(msg)
        if limit:  #: ~limit flag
            rospy.Subscriber("more", Float64, cb)
    """,
    "sys.exit": """
        import sys
        def cb(msg):
            if msg.data > limit:  #: ~limit >
                sys.exit(1)
            pub.publish(msg)
    """,
    "for over range": """
        def cb(msg):
            for i in range(limit):  #: ~limit <
                pub.publish(i)
    """,
}


@pytest.mark.parametrize("name", BODIES)
def test_found(name: str, tmp_path: Path) -> None:
    text = _READ + dedent(BODIES[name]) + _SUB
    assert found(analysed(text, tmp_path)) == marked(text)


def test_a_raise_within_finally_decides_what_follows(tmp_path: Path) -> None:
    text = """
        limit = rospy.get_param("~limit")
        def cb(msg):
            try:
                pass
            finally:
                if limit:  #: ~limit flag
                    raise ValueError("own")
            pub.publish(1.0)
        rospy.Subscriber("in", Float64, cb)
    """
    assert found(analysed(text, tmp_path)) == marked(text)
