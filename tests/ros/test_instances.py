"""Two objects of one class in a real node: reports, flops and names of each, to the ranking."""

from __future__ import annotations

import json
import os
import shlex
import subprocess
import time
from pathlib import Path

import pytest
from click.testing import CliRunner

from pytpc.api.live_reports import Reports
from pytpc.base.errors import MissingToolError
from pytpc.base.paths import installed, log_library, plugin, prefix
from pytpc.cli.main import main
from pytpc.diagnosis.full_names import with_full_names
from pytpc.ingest.reading import read
from pytpc.ingest.ros1 import decode_log
from pytpc.recording.mission import Recording
from pytpc.ros.ros1.graph import RosGraph
from pytpc.ros.ros1.master import Master
from pytpc.ros.ros1.subscriber import RawSubscriber
from pytpc.ros.source import Source
from pytpc.static.link_unit import Comparison
from pytpc.static.static_info import StaticInfo, collect
from pytpc.workspace.colcon import build_environment

try:
    for half in (plugin, log_library):
        half()
    COMPILER = installed("bin/tpc-clang++")
except MissingToolError as error:
    pytest.skip(f"the C++ half is not installed: {error}", allow_module_level=True)

# As in a costmap: a layer reads its radius below its own name; one class, two objects in a node.
# The local layer's outcome changes in each 10th step; the global one's never does. The base class
# compares, too. A check of the node itself has no object.
NODE = """#include <ros/ros.h>
#include <std_msgs/Float64.h>
class Base {
public:
  virtual ~Base() = default;
  bool isFar(double value) { return value > horizon_; }
protected:
  double horizon_ = 0;
};
class Layer : public Base {
public:
  explicit Layer(const std::string &name) : nh_("~/" + name) {
    nh_.param("radius", radius_, 1.0);
    nh_.param("horizon", horizon_, 9.0);
  }
  bool isNear(double value) { return value < radius_; }
private:
  ros::NodeHandle nh_;
  double radius_;
};
int main(int argc, char **argv) {
  ros::init(argc, argv, "map");
  ros::NodeHandle nh("~");
  ros::Publisher pub = nh.advertise<std_msgs::Float64>("out", 1);
  int most;
  nh.param("most", most, 1000);
  Layer global("global"), local("local");
  ros::Rate rate(100);
  for (int i = 0; i < 300 && ros::ok(); ++i, rate.sleep()) {
    double value = i / 10 % 2;
    std_msgs::Float64 message;
    message.data = value;
    if (global.isNear(value + 2))
      pub.publish(message);
    if (local.isNear(value + 2))
      pub.publish(message);
    if (global.isFar(value) || local.isFar(value) || i > most)
      pub.publish(message);
  }
}
"""
GLOBAL, LOCAL = "/map/global/radius", "/map/local/radius"
# Global: 2 or 3 is always less than 4. Local: 2 or 3 against 2.5.
VALUES = {GLOBAL: 4.0, LOCAL: 2.5, "/map/global/horizon": 8.0, "/map/local/horizon": 7.0}


@pytest.fixture(scope="module")
def built(tmp_path_factory) -> Path:
    """A folder with the node and, below it, its static information."""
    folder = tmp_path_factory.mktemp("map")
    (folder / "map.cpp").write_text(NODE)
    found = subprocess.run(
        ["pkg-config", "--cflags", "--libs", "roscpp", "std_msgs"],
        check=True,
        capture_output=True,
        text=True,
    )
    kept = {name: value for name, value in build_environment().items() if "TPC" not in name}
    done = subprocess.run(
        [str(COMPILER), "-O2", "map.cpp", "-o", "map", *shlex.split(found.stdout)],
        cwd=folder,
        env={**kept, "TPC_STATIC_INFO": str(folder / "static")},
        check=False,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


def run(built: Path, folder: Path, **settings: str) -> list[tuple[Source, bytes]]:
    """Run the node; what it sent on /rosout."""
    kept = {name: text for name, text in os.environ.items() if not name.startswith("TPC_")}
    heard: list[tuple[Source, bytes]] = []
    with RosGraph(kept, folder / "graph") as graph:
        for name, value in VALUES.items():
            graph.call("setParam", name, value)
        listener = RawSubscriber(Master(graph.uri, "/listener"), "127.0.0.1", ["/rosout"])
        env = {**kept, "LD_LIBRARY_PATH": str(prefix() / "lib"), **settings}
        process = graph.start("map", [str(built / "map")], env=env)
        end = time.monotonic() + 60
        while process.popen.poll() is None:
            assert time.monotonic() < end
            heard += listener.poll(0.05)
        heard += listener.poll(0.2)
        listener.close()
        assert process.popen.poll() == 0, process.log.read_text()
    return heard


def compared(static: StaticInfo, recording: Recording, function: str) -> dict[str, Comparison]:
    """The comparisons of a function in a mission, by parameter."""
    found = with_full_names(static, recording, {}).thresholds.values()
    return {str(one.source): one for one in found if f"::{function}(" in one.function}


# 300 evaluations of each: the local radius flops at 10, 20, ... 290, the global one never.
@pytest.mark.parametrize("policy", ["every", "edges", "light"])
def test_each_object_has_its_reports_and_names(built, tmp_path, policy):
    run(built, tmp_path, TPC_SINK="file", TPC_FOLDER=str(tmp_path / "m"), TPC_POLICY=policy,
        TPC_SITE_CAP="1000", TPC_PROCESS_CAP="10000")  # fmt: skip
    recording = read(tmp_path / "m")
    static = collect(built / "static")
    near = compared(static, recording, "isNear")
    assert set(near) == {GLOBAL, LOCAL}
    events = recording.events
    flops = {
        name: int(events.flop[events.key == events.keys.index(one.key)].sum())
        for name, one in near.items()
    }
    assert flops == {GLOBAL: 0, LOCAL: 29}
    thresholds = {
        name: set(events.thresh[events.key == events.keys.index(one.key)].tolist())
        for name, one in near.items()
    }
    assert thresholds == {name: {VALUES[name]} for name in (GLOBAL, LOCAL)}
    far = compared(static, recording, "isFar")
    assert set(far) == {"/map/global/horizon", "/map/local/horizon"}
    # What has no object has no number either.
    (most,) = (one for one in static.thresholds.values() if one.function.startswith("main"))
    assert [key for key in events.keys if key.startswith(most.key)] == [most.key]


def test_rank_names_the_parameter_of_the_object_that_flopped(built, tmp_path):
    run(built, tmp_path, TPC_SINK="file", TPC_FOLDER=str(tmp_path / "m"), TPC_POLICY="every")
    words = ["rank", str(tmp_path / "m"), "--static", str(built / "static"), "--at", "2.5"]
    result = CliRunner().invoke(main, [*words, "--score", "thesis", "--json"])
    assert result.exit_code == 0, result.output
    (ranking,) = json.loads(result.output)
    assert ranking["suspects"][0]["parameter"] == LOCAL


# Without a setting, too: what is sent on /rosout has the numbers and the names.
def test_the_default_sends_the_objects(built, tmp_path):
    heard = run(built, tmp_path)
    text = b"\n".join(decode_log(data).msg for _, data in heard).decode()
    assert "#2," in text
    assert ",of:" in text
    assert f",{LOCAL}" in text
    reports = Reports()
    for number, (source, data) in enumerate(heard):
        reports.read(source, data, float(number))
    assert reports.malformed == 0
