"""What the source beside a read says: needed, deprecated, only at the start."""

from pathlib import Path

import pytest

from pytpc.conditions.parameter_calls import CallText, call_text
from pytpc.conditions.source_texts import source_texts

CPP = """\
Guard::Guard() {
  ros::NodeHandle nh("~");
  nh.param("rate", rate_, 5.0);
  if (!nh.getParam("frame", frame_)) {
    ROS_FATAL("no frame");
    return;
  }
  if (!nh.getParam("size", size_))
    size_ = 3;
  if (nh.getParam("old_limit", limit_)) {
    ROS_WARN("old_limit is deprecated, use limit");
  }
  nh.param("limit", limit_, 0.5);
  timer_ = nh.createTimer(period, [this, nh](const ros::TimerEvent&) {
    nh.getParam("gain", gain_);
  });
  for (const auto& name : names_) {
    nh.getParam("weight", weight_);
  }
}
void Guard::onScan() {
  nh_.getParam("threshold", threshold_);
  // This is deprecated.
}
"""
PYTHON = """\
import rospy
class Guard:
    def __init__(self):
        self.rate = rospy.get_param('~rate', 5.0)
        self.port = rospy.get_param('~port')
        try:
            self.host = rospy.get_param('~host')
        except KeyError:
            self.host = ''
        rospy.Subscriber('scan', Scan, self.on_scan)
        while not rospy.is_shutdown():
            self.gain = rospy.get_param('~gain', 1.0)
    def on_scan(self, scan):
        self.limit = rospy.get_param('~limit', 1.0)
        rospy.logwarn('limit is deprecated')
"""


@pytest.fixture
def package(tmp_path: Path) -> Path:
    (tmp_path / "guard.cpp").write_text(CPP)
    (tmp_path / "guard.py").write_text(PYTHON)
    source_texts.cache_clear()
    return tmp_path


@pytest.mark.parametrize(
    ("lineno", "expected"),
    [
        (3, CallText(at_start=True)),
        (4, CallText("reports", at_start=True)),
        (8, CallText(at_start=True)),
        (10, CallText(deprecation=11, at_start=True)),
        (13, CallText(at_start=True)),
        (15, CallText()),
        (18, CallText()),
    ],
)
def test_cpp(package: Path, lineno: int, expected: CallText):
    found = call_text(f"{package}/guard.cpp", lineno, "ros::NodeHandle::param", "Guard::Guard()")
    assert found == expected


def test_a_constructor_with_initialisers(tmp_path: Path):
    file = tmp_path / "a.cpp"
    file.write_text(
        "Grid::Grid(Handle &nh)\n    : wall_(4),\n      hits_(4),\n      far_(2) {\n"
        '  nh.param("radius", radius_, 0.3);\n}\n'
    )
    found = call_text(str(file), 5, "ros::NodeHandle::param", "Grid::Grid(Handle&)")
    assert found.at_start


def test_cpp_in_a_callback(package: Path):
    api, function = "ros::NodeHandle::getParam", "Guard::onScan()"
    assert call_text(f"{package}/guard.cpp", 22, api, function) == CallText()


@pytest.mark.parametrize(
    ("text", "needed"),
    [
        ('auto x = node->declare_parameter<double>("x");', "fails"),
        ('node->declare_parameter("x", rclcpp::PARAMETER_DOUBLE);', "fails"),
        ('node->declare_parameter<double>("x", 0.5);', ""),
        ('node->declare_parameter("x", 0.5);', ""),
    ],
)
def test_declared_without_a_default(tmp_path: Path, text: str, needed: str):
    file = tmp_path / "a.cpp"
    file.write_text(text)
    found = call_text(str(file), 1, "rclcpp::Node::declare_parameter", "main(int, char**)")
    assert found.needed == needed


@pytest.mark.parametrize(
    ("lineno", "expected"),
    [
        (4, CallText(at_start=True)),
        (5, CallText("fails", at_start=True)),
        (7, CallText(at_start=True)),
        (12, CallText()),
        (14, CallText(deprecation=15)),
    ],
)
def test_python(package: Path, lineno: int, expected: CallText):
    assert call_text(f"{package}/guard.py", lineno, "rospy.get_param", "") == expected


OLD_NAMES = """\
limit = rospy.get_param('~old_limit', None)
if limit is not None:
    rospy.logwarn('~old_limit is deprecated')
omega = rospy.get_param('~omega', 1.0)
rospy.logwarn('omega is obsolete')
tilt = rospy.get_param('~tilt', 0.3)
"""


# The message in line 5 is about another name than the call in line 6.
def test_a_message_about_another_name(tmp_path: Path):
    (tmp_path / "a.py").write_text(OLD_NAMES)
    lines = [call_text(f"{tmp_path}/a.py", n, "rospy.get_param", "").deprecation for n in (1, 4, 6)]
    assert lines == [3, 5, None]
    (tmp_path / "a.cpp").write_text(
        'if (nh.hasParam("old")) {\n  nh.getParam("now", x_);\n  ROS_WARN("old is obsolete");\n}\n'
    )
    api = "ros::NodeHandle::getParam"
    assert call_text(f"{tmp_path}/a.cpp", 2, api, "main()").deprecation is None


# rosserial reads its rate so: "57600" and 57600 are the same to it.
def test_what_is_converted(tmp_path: Path):
    file = tmp_path / "a.py"
    file.write_text(
        "rate = int(rospy.get_param('~rate', '57600'))\nrun(rospy.get_param('~x', 1))\n"
    )
    assert call_text(str(file), 1, "rospy.get_param", "").is_converted
    assert not call_text(str(file), 2, "rospy.get_param", "").is_converted


def test_a_place_that_is_not_there(tmp_path: Path):
    assert call_text(f"{tmp_path}/gone.cpp", 3, "ros::NodeHandle::param", "main()") == CallText()
    assert call_text(f"{tmp_path}/gone.py", 3, "rospy.get_param", "") == CallText()


def test_texts_that_stand_beside_no_read(package: Path):
    (package / "other.hpp").write_text(
        'nh.setParam("made", 1);\nx = angles::from_degrees(tilt_);\ny = cos(max_yaw_) + sin(yaw);\n'
    )
    found = source_texts(str(package))
    cpp, python = f"{package}/guard.cpp", f"{package}/guard.py"
    assert "rate" in found.unread([], python=True)
    # "port" stands beside the read in line 4, "gain" beside none; "scan" is in Python alone.
    assert found.unread([(python, 4)], python=True) >= {"scan", "gain"}
    assert {"rate", "port"}.isdisjoint(found.unread([(python, 4)], python=True))
    left = found.unread([(cpp, 3), (cpp, 4)], python=False)
    assert {"rate", "frame", "scan"}.isdisjoint(left)
    assert {"size", "made"} <= left
    assert found.sets == {"made"}
    assert not found.reads_all
    assert found.converts("tilt")
    assert not found.converts("til")
    assert found.turns("max_yaw")
    assert not found.turns("yaw")


# `sim_time` is in the line of an angle, and is none.
def test_what_stands_beside_an_angle(tmp_path: Path):
    (tmp_path / "a.cpp").write_text("x += sim_time * cos(yaw_goal + max_yaw); y = sin(th_goal_);\n")
    source_texts.cache_clear()
    found = source_texts(str(tmp_path))
    names = ("sim_time", "yaw_goal", "max_yaw", "th_goal")
    assert [name for name in names if found.turns(name)] == ["th_goal"]


def test_functions_of_old_names(tmp_path: Path):
    (tmp_path / "magic.h").write_text(
        "template <class T> T loadWithDeprecation(const NodeHandle& nh, const std::string now,\n"
        "    const std::string old_name, const T& value) {\n"
    )
    (tmp_path / "a.cpp").write_text(
        'x = loadWithDeprecation<double>(nh,\n  "bias", "scale", 0.6);\nlogDeprecated("bias");\n'
        'ros::NodeHandle blp("~/TrajectoryPlanner"), own("~/" + name);\n'
        'y = loadWithDeprecation(blp, "now", "then", 1);\n'
        'ros::NodeHandle own("~/" + name);\n'
        'z = loadWithDeprecation(own, "new", "old", 1);\n'
    )
    source_texts.cache_clear()
    found = source_texts(str(tmp_path))
    assert found.renamers == {"loadWithDeprecation": (1, f"{tmp_path}/magic.h")}
    assert [(one.texts, one.lineno, one.namespace) for one in found.renamings] == [
        (("bias", "scale"), 1, ""),
        (("now", "then"), 5, "TrajectoryPlanner"),
        (("new", "old"), 7, ""),
    ]


def test_code_that_reads_all(tmp_path: Path):
    (tmp_path / "a.cpp").write_text("nh.getParamNames(names);\n")
    (tmp_path / "test").mkdir()
    source_texts.cache_clear()
    assert source_texts(str(tmp_path)).reads_all
