"""Parameter reads in Python, and how their values reach comparisons."""

from pathlib import Path

import pytest
from python_analysis_samples import analysed, found, marked

SAMPLES = {
    "local": """
        limit = rospy.get_param("~limit", 3.0)
        def cb(msg):
            if msg.data > limit:  #: ~limit >
                pub.publish(msg)
        rospy.Subscriber("in", Float64, cb)
    """,
    "threshold on the left": """
        limit = rospy.get_param("/limit")
        def cb(msg):
            if limit >= msg.data:  #: /limit <=
                pub.publish(msg)
        rospy.Subscriber("in", Float64, cb)
    """,
    "keywords": """
        limit = rospy.get_param(default=2, param_name="limit")
        def cb(msg):
            if msg.data == limit:  #: limit ==
                pub.publish(msg)
        rospy.Subscriber("in", Float64, cb)
    """,
    "aliases of the module and of the function": """
        import rospy as r
        from rospy import get_param as gp, get_param_cached
        low = r.get_param("~low")
        high = gp("~high")
        top = get_param_cached("~top")
        def cb(msg):
            if msg.data < low:  #: ~low <
                return
            if msg.data > high:  #: ~high >
                return
            if msg.data != top:  #: ~top !=
                pub.publish(msg)
        rospy.Subscriber("in", Float64, cb)
    """,
    "names that are put together": """
        NS = "~arm"
        JOINT = "elbow"
        a = rospy.get_param(NS + "/a")
        b = rospy.get_param(f"{NS}/{JOINT}/b")
        c = rospy.get_param("%s/c" % NS)
        d = rospy.get_param("{}/{joint}".format(NS, joint=JOINT))
        e = rospy.get_param("~" + rospy.get_name() + "/e")
        def cb(msg):
            if msg.data > a:  #: ~arm/a >
                pub.publish(msg)
            if msg.data > b:  #: ~arm/elbow/b >
                pub.publish(msg)
            if msg.data > c:  #: ~arm/c >
                pub.publish(msg)
            if msg.data > d:  #: ~arm/elbow >
                pub.publish(msg)
            if msg.data > e:  #: ~<dynamic>/e >
                pub.publish(msg)
        rospy.Subscriber("in", Float64, cb)
    """,
    "attribute, class attribute, and a base class": """
        class Base:
            scale = rospy.get_param("~scale")
            def __init__(self):
                self.limit = rospy.get_param("~limit")
        class Node(Base):
            def __init__(self):
                super().__init__()
                rospy.Subscriber("in", Float64, self.cb)
            def cb(self, msg):
                if msg.data > self.limit:  #: ~limit >
                    pub.publish(msg)
                if msg.data < self.scale:  #: ~scale <
                    pub.publish(msg)
                if msg.data < Base.scale:  #: ~scale <
                    pub.publish(msg)
        Node()
    """,
    "dict, list, tuple": """
        limits = {"low": rospy.get_param("~low"), "high": rospy.get_param("~high")}
        both = (rospy.get_param("~first"), rospy.get_param("~second"))
        some = [rospy.get_param("~third")]
        first, second = both
        def cb(msg):
            if msg.data < limits["low"]:  #: ~low <
                pub.publish(msg)
            if msg.data > limits.get("high"):  #: ~high >
                pub.publish(msg)
            if msg.data > first:  #: ~first >
                pub.publish(msg)
            if msg.data > both[1]:  #: ~second >
                pub.publish(msg)
            for each in some:
                if msg.data > each:  #: ~third >
                    pub.publish(msg)
        rospy.Subscriber("in", Float64, cb)
    """,
    "a table of parameters": """
        gains = rospy.get_param("~gains", {})
        def cb(msg):
            if msg.data > gains["p"]:  #: ~gains/p >
                pub.publish(msg)
            if msg.data > gains.get("i", 0.0):  #: ~gains/i >
                pub.publish(msg)
            if msg.data > gains["inner"]["d"]:  #: ~gains/inner/d >
                pub.publish(msg)
        rospy.Subscriber("in", Float64, cb)
    """,
    "loop over names": """
        limits = {}
        for name in ("low", "high"):
            limits[name] = rospy.get_param("~" + name, 0.0)
        DEFAULTS = {"near": 1.0, "far": 2.0}
        ranges = {key: rospy.get_param("~" + key, value) for key, value in DEFAULTS.items()}
        def cb(msg):
            if msg.data < limits["low"]:  #: ~low <
                pub.publish(msg)
            if msg.data > limits["high"]:  #: ~high >
                pub.publish(msg)
            if msg.data > ranges["far"]:  #: ~far >
                pub.publish(msg)
        rospy.Subscriber("in", Float64, cb)
    """,
    "default argument, closure, partial": """
        from functools import partial
        def cb(msg, limit=rospy.get_param("~limit")):
            if msg.data > limit:  #: ~limit >
                pub.publish(msg)
        def made(limit):
            def inner(msg):
                if msg.data > limit:  #: ~closed >
                    pub.publish(msg)
            return inner
        def third(limit, msg):
            if msg.data > limit:  #: ~partial >
                pub.publish(msg)
        rospy.Subscriber("a", Float64, cb)
        rospy.Subscriber("b", Float64, made(rospy.get_param("~closed")))
        rospy.Subscriber("c", Float64, partial(third, rospy.get_param("~partial")))
        rospy.Subscriber("d", Float64, lambda m: third(rospy.get_param("~lambda"), m))
    """.replace("~partial >", "~partial >, ~lambda >"),
    "dynamic_reconfigure": """
        from dynamic_reconfigure.server import Server
        from pkg.cfg import NodeConfig
        class Node:
            def __init__(self):
                self.config = None
                self.high = 0.0
                self.server = Server(NodeConfig, self.reconfigure)
                rospy.Subscriber("in", Float64, self.cb)
            def reconfigure(self, config, level):
                self.config = config
                self.high = config.high
                self.low = config["low"]
                return config
            def cb(self, msg):
                if msg.data > self.high:  #: ~high >
                    pub.publish(msg)
                if msg.data < self.low:  #: ~low <
                    pub.publish(msg)
                if msg.data < self.config.other:  #: ~other <
                    pub.publish(msg)
        Node()
    """,
    "namespaces of dynamic_reconfigure": """
        from dynamic_reconfigure.client import Client
        from dynamic_reconfigure.server import Server
        from pkg.cfg import NodeConfig
        limits = {}
        def below(config, level):
            limits["below"] = config.high
            return config
        def global_(config, level):
            limits["global"] = config.high
            return config
        def own(config, level):
            limits["own"] = config.high
            return config
        def other(config):
            limits["other"] = config["high"]
        def unknown(config, level):
            limits["unknown"] = config.high
            return config
        Server(NodeConfig, below, "planner")
        Server(NodeConfig, global_, namespace="/robot/planner/")
        Server(NodeConfig, own, namespace="~costs")
        Server(NodeConfig, unknown, rospy.get_name())
        Client("/planner_node", timeout=3, config_callback=other)
        def cb(msg):
            if msg.data > limits["below"]:  #: ~planner/high >
                pub.publish(msg)
            if msg.data > limits["global"]:  #: /robot/planner/high >
                pub.publish(msg)
            if msg.data > limits["own"]:  #: ~costs/high >
                pub.publish(msg)
            if msg.data > limits["other"]:  #: /planner_node/high >
                pub.publish(msg)
            if msg.data > limits["unknown"]:  #: ~<dynamic>/high >
                pub.publish(msg)
        rospy.Subscriber("in", Float64, cb)
    """,
    "dataclass and property": """
        from dataclasses import dataclass
        @dataclass
        class Limits:
            low: float
            high: float = 3.0
        class Node:
            def __init__(self):
                self.limits = Limits(rospy.get_param("~low"), high=rospy.get_param("~high"))
                self._top = rospy.get_param("~top")
                rospy.Subscriber("in", Float64, self.cb)
            @property
            def top(self):
                return self._top
            def cb(self, msg):
                if msg.data < self.limits.low:  #: ~low <
                    pub.publish(msg)
                if msg.data > self.limits.high:  #: ~high >
                    pub.publish(msg)
                if msg.data > self.top:  #: ~top >
                    pub.publish(msg)
        Node()
    """,
    "overwritten before anybody sees it": """
        class Node:
            def __init__(self):
                self.limit = rospy.get_param("~limit")
                self.limit = 5.0
                rospy.Subscriber("in", Float64, self.cb)
            def cb(self, msg):
                top = rospy.get_param("~top")
                top = 4.0
                if msg.data > self.limit:
                    pub.publish(msg)
                if msg.data > top:
                    pub.publish(msg)
        Node()
    """,
    "objects of one class are told apart by where they are kept": """
        class Limits:
            def __init__(self, value):
                self.value = value
        a = Limits(rospy.get_param("~a"))
        b = Limits(7.0)
        def cb(msg):
            if msg.data > a.value:  #: ~a >
                pub.publish(msg)
            if msg.data > b.value:
                pub.publish(msg)
        rospy.Subscriber("in", Float64, cb)
    """,
    "rclpy": """
        import rclpy
        from rclpy.node import Node
        class Guard(Node):
            def __init__(self):
                super().__init__("guard")
                self.declare_parameter("limit", 2.0)
                self.low = self.declare_parameter("low", 1.0).value
                self.pub = self.create_publisher(Float64, "out", 10)
                self.create_subscription(Float64, "in", self.cb, 10)
            def cb(self, msg):
                if msg.data > self.get_parameter("limit").value:  #: limit >
                    self.pub.publish(msg)
                if msg.data < self.low:  #: low <
                    self.pub.publish(msg)
                top = self.get_parameter("top").get_parameter_value().double_value
                if msg.data > top:  #: top >
                    self.pub.publish(msg)
        rclpy.init()
        Guard()
    """,
    "keyword arguments and starred ones": """
        class Guard:
            def __init__(self, low, *rest, high=0.0, **others):
                self.low, self.high, self.rest = low, high, rest
                self.others = others
            def cb(self, msg):
                if msg.data < self.low:  #: ~low <
                    pub.publish(msg)
                if msg.data > self.high:  #: ~high >
                    pub.publish(msg)
                if msg.data > self.rest[0]:  #: ~rest >
                    pub.publish(msg)
                if msg.data > self.others["top"]:  #: ~top >
                    pub.publish(msg)
        g = Guard(rospy.get_param("~low"), rospy.get_param("~rest"),
                  high=rospy.get_param("~high"), top=rospy.get_param("~top"))
        rospy.Subscriber("in", Float64, g.cb)
    """,
    "setattr, vars of a namespace, global statement": """
        limit = None
        class Options:
            pass
        options = Options()
        def setup():
            global limit
            limit = rospy.get_param("~limit")
            setattr(options, "top", rospy.get_param("~top"))
        def cb(msg):
            if msg.data > limit:  #: ~limit >
                pub.publish(msg)
            if msg.data > options.top:  #: ~top >
                pub.publish(msg)
            if msg.data > getattr(options, "top"):  #: ~top >
                pub.publish(msg)
        setup()
        rospy.Subscriber("in", Float64, cb)
    """,
}


@pytest.mark.parametrize("name", SAMPLES)
def test_found(name: str, tmp_path: Path) -> None:
    assert found(analysed(SAMPLES[name], tmp_path)) == marked(SAMPLES[name])


def test_reads_are_listed_with_their_defaults(tmp_path: Path) -> None:
    unit = analysed(
        """
        a = rospy.get_param("~a", 2)
        b = rospy.get_param("~b", 2.5)
        c = rospy.get_param("~c", "text")
        d = rospy.get_param("~d", False)
        e = rospy.get_param("~e")
        """,
        tmp_path,
    )
    # The prelude has three lines, and the text begins with an empty one.
    assert [(read.name, read.type, read.default, read.lineno) for read in unit.parameters] == [
        ("~a", "int", 2, 5),
        ("~b", "double", 2.5, 6),
        ("~c", "string", "text", 7),
        ("~d", "bool", False, 8),
        ("~e", "", None, 9),
    ]
    assert {read.api for read in unit.parameters} == {"rospy.get_param"}
