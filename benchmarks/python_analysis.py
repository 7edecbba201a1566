"""How long the analysis of Python takes: packages of 3,000, 30,000 and 100,000 lines.

The package is generated: a script that makes an object of each class of its modules. Every class
has a callback with two comparisons, loops, a `try` and helpers.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from figures import figure

CLASSES = 12
MODULES = (6, 60, 200)
ROUNDS = 3
MANIFEST = """<package format="2"><name>large</name><version>0.0.1</version>
<description>generated</description><license>BSD</license>
<maintainer email="someone@example.org">x</maintainer></package>"""
STAGE = '''
class Stage{n}:
    """One of many."""

    def __init__(self, name, limit=1.0):
        self.name = name
        self.limit = limit
        self.gain = rospy.get_param("~stage{n}/gain", 2.0)
        self.count = 0
        self.items = []
        self.table = {{"a": 1, "b": 2}}
        self.pub = rospy.Publisher("out{n}", Float64, queue_size=1)
        self.sub = rospy.Subscriber("in{n}", Float64, self.on_input)

    def filtered(self, value):
        total = 0.0
        for index, item in enumerate(self.items):
            if item is None:
                continue
            total += item * (index + 1) * 0.5
        if total > 100.0:
            total = 100.0
        try:
            result = total / (value + 1.0)
        except ZeroDivisionError as error:
            rospy.logwarn("zero %s", error)
            result = 0.0
        finally:
            self.count += 1
        return result

    def checked(self, msg):
        out = Float64()
        out.data = self.filtered(msg.data)
        return out if out.data > self.limit else None

    def on_input(self, msg):
        if msg.data > self.gain:
            self.items.append(msg.data)
        out = self.checked(msg)
        if out is not None and len(self.items) < 10:
            self.pub.publish(out)
        self.table["a"] = [item * 2 for item in self.items if item]
'''


def generate(modules: int, folder: Path) -> int:
    """Write a package of that many modules; returns its lines."""
    source = folder / "src/large"
    source.mkdir(parents=True)
    (folder / "package.xml").write_text(MANIFEST)
    (source / "__init__.py").write_text("")
    script = ["#!/usr/bin/env python3", "import rospy"]
    made = []
    lines = 0
    for module in range(modules):
        numbers = range(module * CLASSES, (module + 1) * CLASSES)
        text = "import rospy\nfrom std_msgs.msg import Float64\n"
        text += "".join(STAGE.format(n=number) for number in numbers)
        (source / f"m{module}.py").write_text(text)
        lines += text.count("\n")
        script.append(f"from large import m{module}")
        made += [
            f'    m{module}.Stage{number}("s", rospy.get_param("~limit{number}"))'
            for number in numbers
        ]
    script += ['if __name__ == "__main__":', '    rospy.init_node("large")', *made, ""]
    (folder / "large_node.py").write_text("\n".join(script))
    return lines + len(script)


def cost(folder: Path) -> float:
    """CPU seconds of `pytpc analyse`, with the start of Python."""
    words = ["-m", "pytpc", "analyse", str(folder), "-o", str(folder / "static.json")]
    process = subprocess.Popen(
        [sys.executable, *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        raise subprocess.CalledProcessError(status, "pytpc analyse")
    return usage.ru_utime + usage.ru_stime


def main() -> None:
    """Prints the seconds of the larger packages, and how much worse than their lines they grow."""
    seconds, lines = {}, {}
    with tempfile.TemporaryDirectory() as scratch:
        for modules in MODULES:
            folder = Path(scratch) / f"p{modules}"
            lines[modules] = generate(modules, folder)
            seconds[modules] = statistics.median(cost(folder) for _ in range(ROUNDS))
    small, middle, large = MODULES
    growth = seconds[large] / seconds[small] / (lines[large] / lines[small])
    for name, value, unit, target in (
        (f"cpu_of_{lines[middle]}_lines", seconds[middle], "s", 10.0),
        (f"cpu_of_{lines[large]}_lines", seconds[large], "s", 60.0),
        ("growth_over_lines", growth, "ratio", 1.5),
    ):
        figure(
            "python-analysis", name, value, unit=unit, target=f"<={target:g}", hit=value <= target
        )


if __name__ == "__main__":
    main()
