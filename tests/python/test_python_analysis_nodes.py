"""Whole nodes as people write them: main loops, threads, tables of functions."""

from pathlib import Path

import pytest
from python_analysis_samples import analysed, found, marked

NODES = {
    "main loop": """
    def main():
        rospy.init_node("x")
        limit = rospy.get_param("~limit")
        rate = rospy.Rate(10)
        level = 0
        while not rospy.is_shutdown():
            level += 1
            if level > limit:  #: ~limit >
                pub.publish(level)
            rate.sleep()
    if __name__ == "__main__":
        main()
    """,
    "rate is no comparison": """
    r = rospy.Rate(rospy.get_param("~rate"))
    def cb(m):
        pub.publish(m)
    rospy.Timer(rospy.Duration(rospy.get_param("~period")), cb)
    """,
    "thread": """
    import threading
    class W(threading.Thread):
        def __init__(self, limit):
            threading.Thread.__init__(self)
            self.limit = limit
        def run(self):
            if self.limit > 3:  #: ~limit <
                pub.publish(1)
    W(rospy.get_param("~limit")).start()
    """,
    "nested function state": """
    def main():
        limit = rospy.get_param("~limit")
        n = 0
        def cb(m):
            nonlocal n
            n += 1
            if n > limit:  #: ~limit >
                pub.publish(m)
        rospy.Subscriber("in", Float64, cb)
    main()
    """,
    "optional": """
    limit = rospy.get_param("~limit", None)
    def cb(m):
        if limit is not None and m.data > limit:  #: ~limit !=, ~limit >
            pub.publish(m)
    rospy.Subscriber("in", Float64, cb)
    """,
    "if expression default": """
    limit = rospy.get_param("~limit") if rospy.has_param("~limit") else 3.0
    def cb(m):
        if m.data > limit:  #: ~limit >
            pub.publish(m)
    rospy.Subscriber("in", Float64, cb)
    """,
    "clip": """
    limit = rospy.get_param("~limit")
    def cb(m):
        v = m.data
        if v > limit:  #: ~limit >
            v = limit
        if v > 0.1:
            pub.publish(v)
    rospy.Subscriber("in", Float64, cb)
    """,
    "dispatch table": """
    limit = rospy.get_param("~limit")
    def high(m):
        pub.publish(m)
    def low(m):
        rospy.loginfo("low")
    table = {"high": high, "low": low}
    def cb(m):
        name = "high" if m.data > limit else "low"  #: ~limit >
        table[name](m)
    rospy.Subscriber("in", Float64, cb)
    """,
    "set in config dict by **": """
    class G:
        def __init__(self, **kw):
            self.__dict__.update(kw)
            self.p = kw["p"]
        def cb(self, m):
            if m.data > self.p:  #: ~p >
                pub.publish(m)
    g = G(**{"p": rospy.get_param("~p")})
    rospy.Subscriber("in", Float64, g.cb)
    """,
    "contextmanager": """
    from contextlib import contextmanager
    @contextmanager
    def limits():
        yield rospy.get_param("~limit")
    def cb(m):
        with limits() as top:
            if m.data > top:  #: ~limit >
                pub.publish(m)
    rospy.Subscriber("in", Float64, cb)
    """,
}


@pytest.mark.parametrize("name", NODES)
def test_found(name: str, tmp_path: Path) -> None:
    assert found(analysed(NODES[name], tmp_path)) == marked(NODES[name])
