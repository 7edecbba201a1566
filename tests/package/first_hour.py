"""A first hour with an installed pytpc: two nodes, one wrong value, its name, and the mended robot.

It needs nothing but Python and `pytpc`, so that it also runs on a machine on which only the package
was installed. Prints each command with the minutes and seconds since the beginning.

    python3 first_hour.py /usr/bin/pytpc FOLDER
"""

import fcntl
import json
import os
import pty
import re
import select
import shlex
import struct
import subprocess
import sys
import termios
import time
from pathlib import Path

# The robot must stop half a metre before a wall; the walls are 1.5 to 2.5 m away. With 4.0 it never
# drives. The other values are never reached.
VALUES = """\
driver:
  stop_distance: {stop_distance}
  max_distance: 50.0
  cruise_speed: 0.4
range_finder:
  min_range: 0.05
"""
FILES = {
    "src/patrol/package.xml": """\
<package format="2">
  <name>patrol</name>
  <version>1.0.0</version>
  <description>Drives until a wall is near.</description>
  <maintainer email="me@example.org">me</maintainer>
  <license>BSD</license>
  <buildtool_depend>catkin</buildtool_depend>
  <depend>roscpp</depend>
  <depend>std_msgs</depend>
  <exec_depend>rospy</exec_depend>
</package>
""",
    "src/patrol/CMakeLists.txt": """\
cmake_minimum_required(VERSION 3.5)
project(patrol)
find_package(catkin REQUIRED COMPONENTS roscpp std_msgs)
catkin_package()
include_directories(${catkin_INCLUDE_DIRS})
add_executable(driver src/driver.cpp)
target_link_libraries(driver ${catkin_LIBRARIES})
install(TARGETS driver DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
catkin_install_python(PROGRAMS scripts/range_finder.py
  DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(DIRECTORY launch config DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
""",
    "src/patrol/src/driver.cpp": """\
#include <ros/ros.h>
#include <std_msgs/Float64.h>

ros::Publisher Speed;
double StopDistance, MaxDistance, CruiseSpeed;

void onRange(const std_msgs::Float64 &Range) {
  if (Range.data > MaxDistance)
    return;
  std_msgs::Float64 Command;
  if (Range.data > StopDistance) {
    Command.data = CruiseSpeed;
    Speed.publish(Command);
  }
}

int main(int argc, char **argv) {
  ros::init(argc, argv, "driver");
  ros::NodeHandle Node("~");
  Node.param("stop_distance", StopDistance, 0.5);
  Node.param("max_distance", MaxDistance, 50.0);
  Node.param("cruise_speed", CruiseSpeed, 0.4);
  Speed = Node.advertise<std_msgs::Float64>("/speed", 1);
  ros::Subscriber Ranges = Node.subscribe("/range", 1, onRange);
  ros::spin();
}
""",
    "src/patrol/scripts/range_finder.py": """\
#!/usr/bin/env python3
import math
import rospy
from std_msgs.msg import Float64

rospy.init_node("range_finder")
min_range = rospy.get_param("~min_range", 0.05)
publisher = rospy.Publisher("/range", Float64, queue_size=1)
rate = rospy.Rate(20)
while not rospy.is_shutdown():
    distance = 2.0 + 0.5 * math.sin(rospy.get_time())
    if distance > min_range:
        publisher.publish(distance)
    rate.sleep()
""",
    "src/patrol/config/monday.yaml": VALUES.format(stop_distance=0.5),
    "src/patrol/config/tuesday.yaml": VALUES.format(stop_distance=4.0),
    "src/patrol/launch/patrol.launch": """\
<launch>
  <arg name="day"/>
  <rosparam command="load" file="$(find patrol)/config/$(arg day).yaml"/>
  <node name="driver" pkg="patrol" type="driver"/>
  <node name="range_finder" pkg="patrol" type="range_finder.py"/>
</launch>
""",
}
PATIENCE_S = 900
LAUNCH = ("ws", "patrol", "patrol.launch")
BEGAN = time.monotonic()


def say(text):
    minutes, seconds = divmod(int(time.monotonic() - BEGAN), 60)
    print(f"[{minutes:2d}:{seconds:02d}] {text}", flush=True)


def expect(true, problem):
    if not true:
        sys.exit(f"first_hour: error: {problem}")


def write_workspace(folder):
    """The sources of the robot, in a new workspace."""
    for name, text in FILES.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        path.chmod(0o755 if name.endswith(".py") else 0o644)


def environment():
    """What a user has who has set nothing of TPC."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith("TPC_")}
    return {**kept, "COLUMNS": "110", "TERM": "xterm-256color"}


def pytpc(program, folder, *words, quiet=False):
    """What a command of pytpc prints; it must end with status 0."""
    say("$ pytpc " + shlex.join(words))
    ran = subprocess.run(
        [program, *words],
        check=False,
        cwd=folder,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=None if quiet else subprocess.STDOUT,
        text=True,
        timeout=PATIENCE_S,
        env=environment(),
    )
    if not quiet or ran.returncode != 0:
        print(ran.stdout, end="", flush=True)
    expect(ran.returncode == 0, f"pytpc {words[0]} ends with status {ran.returncode}")
    return ran.stdout


def pytpc_in_terminal(program, folder, *words, seen, keys):
    """The same in a terminal; ``keys`` are pressed, 3 s apart, once the screen shows ``seen``."""
    say(f"$ pytpc {shlex.join(words)}      # and the keys {' '.join(keys)}")
    child, terminal = pty.fork()
    if child == 0:
        os.chdir(folder)
        os.execve(program, [str(program), *words], environment())
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 40, 110, 0, 0))
    shown, left, next_key = b"", list(keys), None
    ends = time.monotonic() + PATIENCE_S
    while time.monotonic() < ends:
        if select.select([terminal], [], [], 0.1)[0]:
            try:
                shown += os.read(terminal, 65536)
            except OSError:  # the program has ended
                break
        if next_key is None and seen.encode() in shown:
            next_key = time.monotonic() + 3
        if left and next_key is not None and time.monotonic() >= next_key:
            os.write(terminal, left.pop(0).encode())
            next_key += 3
    else:
        os.kill(child, 9)
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    # What stays when the live screen is closed.
    after = shown.decode(errors="replace").rpartition("\x1b[?1049l")[2]
    lines = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", after).replace("\r\n", "\n").split("\n")
    # A line of progress is drawn over itself.
    text = "\n".join(line.rpartition("\r")[2].rstrip() for line in lines).strip()
    print(text, flush=True)
    expect(status == 0, f"pytpc {words[0]} ends with status {status}")
    expect(not left, f"the screen never showed {seen}, so no key was pressed")
    return text


def main(program, folder):
    """Go through the first hour; returns the parameter that was blamed."""
    folder.mkdir(parents=True, exist_ok=True)
    write_workspace(folder / "ws")
    say("two nodes in ws/src/patrol; config/tuesday.yaml has stop_distance: 4.0, which is wrong")
    pytpc(program, folder, "doctor", "ws")
    pytpc(program, folder, "build", "ws")
    said = pytpc(program, folder, "list", "ws")
    for parameter in ("~stop_distance", "~max_distance", "~min_range"):
        expect(parameter in said, f"pytpc list does not name {parameter}")
    record = ("record", *LAUNCH, "--timeout", "8", "-o")
    pytpc(program, folder, *record, "monday", "day:=monday")

    # The robot should drive, and does not.
    run = ("run", *LAUNCH, "--reference", "monday", "-o", "tuesday", "day:=tuesday")
    said = pytpc_in_terminal(program, folder, *run, seen="stop_distance", keys="2222q")
    expect("blame ~stop_distance" in said, "pytpc run does not blame ~stop_distance")
    expect((folder / "tuesday/report.html").is_file(), "pytpc run writes no page")
    asked = ("rank", "tuesday", "--reference", "monday", "--json")
    accused = check_verdict(json.loads(pytpc(program, folder, *asked, quiet=True)))

    pytpc(program, folder, "apply", "tuesday", "stop_distance", "0.5")
    mended = (folder / "ws/src/patrol/config/tuesday.yaml").read_text()
    expect(mended == VALUES.format(stop_distance=0.5), "pytpc apply does not mend tuesday.yaml")
    pytpc(program, folder, "build", "ws")
    pytpc(program, folder, *record, "wednesday", "day:=tuesday")
    said = pytpc(program, folder, "diff", "monday", "wednesday")
    expect("stop_distance" not in said, "after the change, stop_distance still differs")
    say(f"blamed {accused}, changed 4.0 to 0.5, and drove again: right")
    return accused


def check_verdict(ranked):
    """The verdict on all marks together must be the parameter, and the value of the good run."""
    diagnosis = ranked[0]["diagnosis"]
    first = diagnosis["suspects"][0]
    value = first["remedy"]["value"]
    say(f"{diagnosis['text']}; {diagnosis['action']}")
    expect(diagnosis["accused"] == "~stop_distance", f"accused is {diagnosis['accused']}")
    expect(first["parameter"] == "~stop_distance", f"the first suspect is {first['parameter']}")
    expect(value == 0.5, f"the value to try is {value}, and not the 0.5 of the good run")
    expect(len(ranked) == 4, f"{len(ranked)} marks were ranked, and not the 4 that were typed")
    return diagnosis["accused"]


if __name__ == "__main__":
    main(Path(sys.argv[1]).absolute(), Path(sys.argv[2]).absolute())
