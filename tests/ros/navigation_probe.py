"""Talks to one node of the ground robot, its messages in an order that a slow connection gives.

    navigation_probe.py controller_host    a path before the goal that it leads to
    navigation_probe.py recovery           a command before the pose that it goes back to

Prints what the node answers as one line of JSON. A second between two messages makes it likely that
the first one is there first; which of them is must not matter.
"""

from __future__ import annotations

import json
import sys
import time

import rospy
from genpy.dynamic import generate_dynamic
from geometry_msgs.msg import PoseStamped, TwistStamped
from navigation.msg import ControllerStatus, Localised, MissionCommand, RecoveryStatus

# nav_msgs is there for C++ alone.
Path = generate_dynamic(
    "nav_msgs/Path",
    "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n"
    f"{'=' * 80}\nMSG: geometry_msgs/PoseStamped\n{PoseStamped._full_text}",
)["nav_msgs/Path"]

PATIENCE_S = 30.0
BETWEEN_S = 1.0


def publisher(topic: str, kind: type) -> rospy.Publisher:
    """One that somebody listens to."""
    made = rospy.Publisher(topic, kind, queue_size=10)
    end = time.monotonic() + PATIENCE_S
    while not made.get_num_connections():
        if time.monotonic() > end:
            raise SystemExit(f"nobody listens to {topic}")
        time.sleep(0.05)
    return made


class Answers:
    """The last message of each topic."""

    def __init__(self, **topics: tuple[str, type]) -> None:
        self._found: dict[str, object] = {}
        for name, (topic, kind) in topics.items():
            rospy.Subscriber(topic, kind, self._take, callback_args=name)

    def _take(self, message: object, name: str) -> None:
        self._found[name] = message

    def wait(self, name: str, second: float) -> object:
        """The message with that stamp."""
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            found = self._found.get(name)
            if found is not None and found.header.stamp == rospy.Time(second):
                return found
            time.sleep(0.01)
        raise SystemExit(f"no answer to second {second}: {name}")


def pose_at(second: float, *, lost: bool = False) -> Localised:
    pose = Localised(x=1.0, y=1.0, quality=1.0, ready=True, lost=lost)
    pose.header.stamp = rospy.Time(second)
    return pose


def goal(number: int, x: float) -> MissionCommand:
    return MissionCommand(mode=MissionCommand.DRIVE, goal_id=number, goal_x=x, goal_y=1.0)


def path_to(x: float) -> rospy.Message:
    path = Path()
    path.header.stamp = rospy.Time(1)
    for step in range(11):
        pose = PoseStamped()
        pose.pose.position.x = 1.0 + (x - 1.0) * step / 10
        pose.pose.position.y = 1.0
        pose.pose.orientation.w = 1.0
        path.poses.append(pose)
    return path


def controller_host() -> dict[str, object]:
    """It stands at its first goal; the path to a second one comes before its command."""
    answers = Answers(status=("/controller/status", ControllerStatus))
    goals = publisher("/mission/command", MissionCommand)
    paths = publisher("/planner/path", Path)
    poses = publisher("/localisation/pose", Localised)
    goals.publish(goal(1, 1.0))
    time.sleep(BETWEEN_S)
    paths.publish(path_to(1.0))
    time.sleep(BETWEEN_S)
    second = 1
    while True:
        poses.publish(pose_at(second))
        status = answers.wait("status", second)
        if status.arrived:
            break
        second += 1 / 8
    paths.publish(path_to(3.0))
    time.sleep(BETWEEN_S)
    goals.publish(goal(2, 3.0))
    time.sleep(BETWEEN_S)
    poses.publish(pose_at(second + 1 / 8))
    status = answers.wait("status", second + 1 / 8)
    return {"goal": status.goal_id, "arrived": status.arrived, "drives": status.speed > 0.0}


def recovery() -> dict[str, object]:
    """It was lost, and is not any more when the command is given; that it hears later."""
    answers = Answers(status=("/recovery/status", RecoveryStatus))
    poses = publisher("/localisation/pose", Localised)
    commands = publisher("/controller/cmd_vel", TwistStamped)
    poses.publish(pose_at(1, lost=True))
    time.sleep(BETWEEN_S)
    command = TwistStamped()
    command.header.stamp = rospy.Time(2)
    commands.publish(command)
    time.sleep(BETWEEN_S)
    poses.publish(pose_at(2))
    return {"action": answers.wait("status", 2).action}


if __name__ == "__main__":
    rospy.init_node("probe", disable_signals=True)
    print(json.dumps({"controller_host": controller_host, "recovery": recovery}[sys.argv[1]]()))
