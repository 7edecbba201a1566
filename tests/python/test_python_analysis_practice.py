"""Nodes like those of real packages: state machines, actions, configurations, threads, numpy.

The marks beside the lines were written by hand, from the source, before the analysis was run.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from python_analysis_samples import analysed, found, marked

SAMPLES = {
    "how long a call waits is not what it gives": """
        import queue
        import actionlib
        inbox = queue.Queue()
        client = actionlib.SimpleActionClient("spray", object)
        patience = rospy.get_param("~patience")
        stop = rospy.get_param("~stop")
        rospy.Subscriber("range", object, lambda m: inbox.put(m.data))
        while not rospy.is_shutdown():
            if inbox.get(timeout=patience) < stop:  #: ~stop <
                pub.publish(1)
            if inbox.get(True, patience) < stop:  #: ~stop <
                pub.publish(2)
            if client.wait_for_result(rospy.Duration(patience)):
                pub.publish(3)
    """,
    "what is put into a queue comes out of it": """
        import queue
        inbox = queue.Queue()
        inbox.put(rospy.get_param("~limit"))
        limit = inbox.get(timeout=1.0)
        def heard(msg):
            if msg.data > limit:  #: ~limit >
                pub.publish(msg)
        rospy.Subscriber("in", object, heard)
    """,
    "smach states": """
        import smach
        class Charge(smach.State):
            def __init__(self, full):
                smach.State.__init__(self, outcomes=["full", "more"])
                self.full = full
            def execute(self, userdata):
                if userdata.level >= self.full:  #: ~full >=
                    return "full"
                pub.publish(userdata.level)
                return "more"
        class Drive(smach.State):
            def __init__(self, pub, speed):
                super(Drive, self).__init__(outcomes=["done"])
                self.pub, self.speed = pub, speed
            def execute(self, userdata):
                if userdata.gap < self.speed:  #: ~speed <
                    self.pub.publish(0.0)
                return "done"
        machine = smach.StateMachine(outcomes=["end"])
        with machine:
            charge = Charge(rospy.get_param("~full"))
            smach.StateMachine.add("CHARGE", charge, transitions={"full": "end"})
            smach.StateMachine.add("DRIVE", Drive(pub, rospy.get_param("~speed")))
        machine.execute()
    """,
    "an action server": """
        import actionlib
        class Pump:
            def __init__(self, name):
                self.most = rospy.get_param("~most", 3.0)
                self.tries = rospy.get_param("~tries", 3)
                self.server = actionlib.SimpleActionServer(
                    name, object, execute_cb=self.run, auto_start=False
                )
                self.server.start()
            def run(self, goal):
                for attempt in range(self.tries):  #: ~tries <
                    if self.server.is_preempt_requested():
                        self.server.set_preempted()
                        return
                    if goal.amount > self.most:  #: ~most >
                        self.server.set_aborted()
                        return
                    self.server.publish_feedback(attempt)
                self.server.set_succeeded()
        Pump("pump")
    """,
    "a move_base client": """
        import actionlib
        client = actionlib.SimpleActionClient("move_base", object)
        patience = rospy.Duration(rospy.get_param("~patience", 20.0))
        retries = int(rospy.get_param("~retries", 3))
        def go(goals):
            failed = 0
            for goal in goals:
                client.send_goal(goal)
                begun = rospy.Time.now()
                while not client.wait_for_result(rospy.Duration(0.1)):
                    if rospy.Time.now() - begun > patience:  #: ~patience >
                        client.cancel_goal()
                        failed += 1
                        break
                if failed > retries:  #: ~retries > derived
                    return False
            return True
        go([1, 2])
    """,
    "two objects of a class below another": """
        class Base:
            def __init__(self, limit, name):
                self.limit = limit
                self.name = name
        class Upper(Base):
            def __init__(self, limit):
                super().__init__(limit, "upper")
            def cb(self, msg):
                if msg.data > self.limit:  #: ~upper >
                    pub.publish(msg)
        class Lower(Base):
            def __init__(self, limit):
                Base.__init__(self, limit, name="lower")
            def cb(self, msg):
                if msg.data < self.limit:  #: ~lower <
                    pub.publish(msg)
        class Lowest(Lower):
            def __init__(self, limit):
                super().__init__(limit)
            def cb(self, msg):
                if msg.data <= self.limit:  #: ~lowest <=
                    pub.publish(msg)
        rospy.Subscriber("a", Float64, Upper(rospy.get_param("~upper")).cb)
        rospy.Subscriber("a", Float64, Lower(rospy.get_param("~lower")).cb)
        rospy.Subscriber("a", Float64, Lowest(rospy.get_param("~lowest")).cb)
    """,
    "names from a table": """
        DEFAULTS = {"low": 1.0, "high": 2.0}
        class Guard:
            def __init__(self):
                for name, default in DEFAULTS.items():
                    setattr(self, name, rospy.get_param("~" + name, default))
            def cb(self, msg):
                if self.low < msg.data:  #: ~low >
                    pub.publish(msg)
                if msg.data > self.high:  #: ~high >
                    pub.publish(msg)
        rospy.Subscriber("a", Float64, Guard().cb)
    """,
    "__dict__ takes all parameters": """
        class Guard:
            gain = -1.0
            def __init__(self):
                self.most = 3.0
                self.__dict__.update(rospy.get_param("~"))
                self.kept = rospy.get_param("~own")
                self.count = len("abc")
            def cb(self, msg):
                if msg.data > self.limit:  #: ~limit >
                    pub.publish(msg)
                if msg.data > self.most:  #: ~most >
                    pub.publish(msg)
                if msg.data > self.gain:  #: ~gain >
                    pub.publish(msg)
                if msg.data > self.kept:  #: ~own >
                    pub.publish(msg)
                if msg.data > self.count:
                    pub.publish(msg)
        rospy.Subscriber("a", Float64, Guard().cb)
    """,
    "vars and a loop over names": """
        class Guard:
            def __init__(self, names):
                vars(self)["limit"] = rospy.get_param("~limit")
            def cb(self, msg):
                if msg.data > self.limit:  #: ~limit >
                    pub.publish(msg)
                if msg.data > self.other:
                    pub.publish(msg)
        rospy.Subscriber("a", Float64, Guard([]).cb)
    """,
    "getattr with half a name": """
        class Guard:
            def __init__(self):
                self.max_x = rospy.get_param("~x")
                self.max_y = rospy.get_param("~y")
                self.min_y = rospy.get_param("~min_y")
            def cb(self, msg):
                for axis in msg.axes:
                    if msg.data > getattr(self, "max_" + axis):  #: ~x >, ~y >
                        pub.publish(msg)
                    if msg.data < getattr(self, f"{axis}_y"):  #: ~y <, ~min_y <
                        pub.publish(msg)
        rospy.Subscriber("a", Float64, Guard().cb)
    """,
    "tables that are merged and unpacked": """
        from dataclasses import dataclass
        @dataclass
        class Config:
            gap: float = 1.0
            rate: float = 2.0
        def setup(wide=1.0, **rest):
            return wide, rest
        table = {"x": 1.0, **rospy.get_param("~all")}
        known = dict(low=1.0)
        known.update(rospy.get_param("~known"))
        config = Config(**rospy.get_param("~config"))
        wide, rest = setup(**rospy.get_param("~setup"))
        def cb(msg):
            if msg.data > table["x"]:  #: ~all/x >
                pub.publish(msg)
            if msg.data > known["low"]:  #: ~known/low >
                pub.publish(msg)
            if msg.data > config.gap:  #: ~config/gap >
                pub.publish(msg)
            if msg.data > wide:  #: ~setup/wide >
                pub.publish(msg)
            if msg.data > rest["deep"]:  #: ~setup/deep >
                pub.publish(msg)
        rospy.Subscriber("a", Float64, cb)
    """,
    "a worker with a queue and a lock": """
        import queue
        import threading
        class Worker:
            def __init__(self):
                self.lock = threading.Lock()
                self.jobs = queue.Queue(maxsize=10)
                self.limit = rospy.get_param("~limit")
                self.batch = rospy.get_param("~batch")
                rospy.Subscriber("in", Float64, self.put)
                threading.Thread(target=self.work, daemon=True).start()
            def put(self, msg):
                with self.lock:
                    if msg.data > self.limit:  #: ~limit >
                        self.jobs.put(msg.data)
            def work(self):
                held = []
                while not rospy.is_shutdown():
                    held.append(self.jobs.get())
                    if len(held) >= self.batch:  #: ~batch >=
                        pub.publish(sum(held))
                        held = []
        Worker()
    """,
    "an enumeration as state": """
        import enum
        class State(enum.Enum):
            IDLE = 0
            FLY = 1
        class Pilot:
            def __init__(self):
                self.state = State.IDLE
                self.top = rospy.get_param("~top")
                self.floor = rospy.get_param("~floor")
                rospy.Timer(rospy.Duration(0.1), self.tick)
                rospy.Subscriber("in", Float64, self.cb)
            def cb(self, msg):
                if self.state == State.IDLE and msg.data > self.floor:  #: ~floor >
                    self.state = State.FLY
                elif self.state == State.FLY and msg.data > self.top:  #: ~top >
                    self.state = State.IDLE
            def tick(self, event):
                if self.state is State.FLY:
                    pub.publish(1.0)
        Pilot()
    """,
    "numpy": """
        import numpy as np
        limit = rospy.get_param("~limit")
        near = np.array(rospy.get_param("~near"))
        few = rospy.get_param("~few")
        share = rospy.get_param("~share")
        def cb(msg):
            scan = np.asarray(msg.ranges)
            if np.any(scan < limit):  #: ~limit <
                pub.publish(0.0)
            if (scan < near).any():  #: ~near <
                pub.publish(1.0)
            if np.sum(scan > 3.0) > few:  #: ~few >
                pub.publish(2.0)
            if np.mean(scan) > share * 2:  #: ~share > derived
                pub.publish(3.0)
            hits = np.where(scan > limit)[0]  #: ~limit >
            if len(hits):
                pub.publish(4.0)
            kept = scan[scan < limit]  #: ~limit <
            pub.publish(kept)
        rospy.Subscriber("in", Float64, cb)
    """,
    "sorting, any, all, next": """
        limit = rospy.get_param("~limit")
        least = rospy.get_param("~least")
        def cb(msg):
            if any(x > limit for x in msg.data):  #: ~limit >
                pub.publish(0.0)
            if all([x > least for x in msg.data]):  #: ~least >
                pub.publish(1.0)
            first = next((x for x in msg.data if x > limit), None)  #: ~limit >
            if first is not None:
                pub.publish(first)
            chosen = list(filter(lambda x: x > limit, msg.data))  #: ~limit >
            pub.publish(len(chosen))
            rospy.loginfo([x > limit for x in msg.data])
        rospy.Subscriber("in", Float64, cb)
    """,
    "tf in try": """
        import tf
        listener = tf.TransformListener()
        near = rospy.get_param("~near")
        age = rospy.get_param("~age")
        rate = rospy.Rate(rospy.get_param("~rate", 10))
        while not rospy.is_shutdown():
            try:
                place, turn = listener.lookupTransform("a", "b", rospy.Time(0))
            except (tf.LookupException, tf.ConnectivityException):
                rate.sleep()
                continue
            if place[0] < near:  #: ~near <
                pub.publish(place[0])
            stamp = listener.getLatestCommonTime("a", "b")
            if (rospy.Time.now() - stamp).to_sec() > age:  #: ~age >
                continue
            pub.publish(1.0)
            rate.sleep()
    """,
    "message_filters": """
        import message_filters
        class Fuse:
            def __init__(self):
                self.slop = rospy.get_param("~slop")
                one = message_filters.Subscriber("a", Float64)
                two = message_filters.Subscriber("b", Float64)
                both = message_filters.ApproximateTimeSynchronizer([one, two], 10, 0.1)
                both.registerCallback(self.cb)
            def cb(self, first, second):
                if abs(first.data - second.data) <= self.slop:  #: ~slop <=
                    pub.publish(first)
        Fuse()
    """,
    "a dynamic_reconfigure server": """
        from dynamic_reconfigure.server import Server
        from my.cfg import MyConfig
        class Guard:
            def __init__(self):
                self.config = None
                self.limit = 0.0
                self.server = Server(MyConfig, self.reconfigure)
                rospy.Subscriber("in", Float64, self.cb)
            def reconfigure(self, config, level):
                self.config = config
                self.limit = config["limit"]
                return config
            def cb(self, msg):
                if self.config is None:
                    return
                if self.config.enabled and msg.data > self.limit:  #: ~enabled flag, ~limit >
                    pub.publish(msg)
                if msg.data > self.config.top:  #: ~top >
                    pub.publish(msg)
        Guard()
    """,
    "what is waited for": """
        limit = rospy.get_param("~limit")
        try:
            first = rospy.wait_for_message("in", Float64, timeout=5.0)
        except rospy.ROSException:
            first = None
        if first is not None and first.data > limit:  #: ~limit >
            pub.publish(first)
    """,
    "rclpy": """
        import rclpy
        from rclpy.node import Node
        from rcl_interfaces.msg import SetParametersResult
        class Guard(Node):
            def __init__(self):
                super().__init__("guard")
                declared = [("limit", 2.0), ("low", 1.0), ("top", 3.0)]
                self.declare_parameters(namespace="", parameters=declared)
                self.low = self.get_parameter("low").get_parameter_value().double_value
                self.top = self.get_parameter("top").value
                limits = self.get_parameters(["limit", "low"])
                self.first = limits[0].value
                self.add_on_set_parameters_callback(self.changed)
                self.out = self.create_publisher(Float64, "out", 10)
                self.timer = self.create_timer(0.1, self.tick)
                self.heard = 0.0
                self.create_subscription(Float64, "in", self.cb, 10)
            def changed(self, params):
                for param in params:
                    if param.name == "top":
                        self.top = param.value
                return SetParametersResult(successful=True)
            def cb(self, msg):
                self.heard = msg.data
                if msg.data < self.low:  #: low <
                    self.out.publish(msg)
            def tick(self):
                if self.heard > self.get_parameter("limit").value:  #: limit >
                    self.out.publish(Float64())
                if self.heard > self.top:  #: top >
                    self.out.publish(Float64())
        rclpy.init()
        rclpy.spin(Guard())
    """,
    "a retry decorator and a context": """
        import contextlib
        import functools
        tries = rospy.get_param("~tries")
        slow = rospy.get_param("~slow")
        def retry(most):
            def decorate(function):
                @functools.wraps(function)
                def wrapper(*args):
                    done = 0
                    while done < most:  #: ~tries <
                        if function(*args):
                            return True
                        done += 1
                    return False
                return wrapper
            return decorate
        @retry(tries)
        def send(value):
            if value > slow:  #: ~slow >
                pub.publish(value)
                return True
            return False
        rospy.Subscriber("in", Float64, lambda msg: send(msg.data))
    """,
    "clip and folding": """
        import numpy as np
        top = rospy.get_param("~top")
        low = rospy.get_param("~low")
        near = rospy.get_param("~near")
        def cb(msg):
            speed = max(low, min(top, msg.data))  #: ~top <, ~low >
            pub.publish(speed)
            nearest = 100.0
            for value in msg.ranges:
                nearest = min(nearest, value)
            if nearest < near:  #: ~near <
                pub.publish(np.clip(msg.data, -1.0, 1.0))
        rospy.Subscriber("in", Float64, cb)
    """,
    "a config object that is passed around": """
        from types import SimpleNamespace
        class Config:
            @classmethod
            def from_ros(cls):
                config = cls()
                config.limit = rospy.get_param("~limit")
                config.mode = rospy.get_param("~mode")
                return config
        class Filter:
            def __init__(self, config):
                self.cfg = config
            def passes(self, value):
                return value < self.cfg.limit  #: ~limit <
        class Node:
            def __init__(self, config):
                self.config = config
                self.filters = [Filter(config)]
                self.extra = SimpleNamespace(top=rospy.get_param("~top"))
            def cb(self, msg):
                if self.config.mode == "fast":  #: ~mode ==
                    pub.publish(1.0)
                if all(f.passes(msg.data) for f in self.filters):
                    pub.publish(msg)
                if msg.data > self.extra.top:  #: ~top >
                    pub.publish(msg)
        rospy.Subscriber("in", Float64, Node(Config.from_ros()).cb)
    """,
    "a constant that a function makes of constants": """
        limit = rospy.get_param("~limit")
        class Node:
            def reset(self, msg):
                global limit
                limit = max(1.0, 2.0)
            def cb(self, msg):
                if 3.0 > limit:  #: ~limit >
                    pub.publish(msg)
        node = Node()
        rospy.Subscriber("a", Float64, node.cb)
        rospy.Subscriber("b", Float64, node.reset)
    """,
    "a table of handlers": """
        limits = {"a": rospy.get_param("~a"), "b": rospy.get_param("~b")}
        class Node:
            def __init__(self):
                self.handlers = {"go": self.go, "stop": self.stop}
                for name, limit in limits.items():
                    rospy.Subscriber(name, Float64, self.cb, callback_args=limit)
            def cb(self, msg, limit):
                if msg.data > limit:  #: ~a >, ~b >
                    self.handlers[msg.kind](msg)
            def go(self, msg):
                if msg.data < limits["b"]:  #: ~b <
                    pub.publish(1.0)
            def stop(self, msg):
                pub.publish(0.0)
        Node()
    """,
}

_COUNT = 16


def test_a_circle_of_values_is_gone_through_once(tmp_path: Path) -> None:
    # Each of 16 attributes may be each other one: the ways through them are 16 factorial.
    copies = [
        f"    def m{to}_{of}(self):\n        self.x{to} = self.x{of}"
        for to in range(_COUNT)
        for of in range(_COUNT)
        if to != of
    ]
    lines = ["class Node:", "    def __init__(self):"]
    lines += ["        self.x0 = rospy.get_param('~limit')"]
    lines += [*copies, "    def cb(self, msg):"]
    lines += [f"        if 3.0 < self.x{_COUNT - 1}:", "            pub.publish(msg)"]
    lines += ["node = Node()", "rospy.Subscriber('in', Float64, node.cb)"]
    unit = analysed("\n".join(lines) + "\n", tmp_path)
    assert [(each.source, each.relation) for each in unit.comparisons] == [("~limit", "<")]


@pytest.mark.parametrize("name", SAMPLES)
def test_found(name: str, tmp_path: Path) -> None:
    assert found(analysed(SAMPLES[name], tmp_path)) == marked(SAMPLES[name])
