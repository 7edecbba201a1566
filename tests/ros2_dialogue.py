"""Programs that answer each line with a line, for tests: a node, and its peer in rclpy."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path
from typing import Any

from patience import PATIENCE_S


class Dialogue:
    """A program that answers each line with a line."""

    def __init__(self, words: list[str], env: dict[str, str], errors: Path) -> None:
        self._errors = errors
        with errors.open("w") as stderr:
            self.process = subprocess.Popen(
                words,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=stderr,
                text=True,
                env=env,
            )
        self.answer()

    def answer(self) -> str:
        assert self.process.stdout is not None
        line = self.process.stdout.readline()
        assert line, self.errors()
        return line

    def say(self, line: str) -> str:
        self.tell(line)
        return self.answer()

    def tell(self, line: str) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()

    def finish(self, line: str = "exit") -> int:
        self.tell(line)
        return self.process.wait(timeout=PATIENCE_S)

    def errors(self) -> str:
        return self._errors.read_text()


class Peer(Dialogue):
    """tests/ros2/peer.py, whose methods are called by their names."""

    def ask(self, name: str, *words: Any, **keywords: Any) -> Any:
        return json.loads(self.say(json.dumps([name, words, keywords])))

    def values(self, reports: int) -> list[float]:
        """The compared values of the batches, when there are so many."""
        batches = self.ask("heard", reports)["batches"]
        return [compared(line) for batch in batches for line in events(batch)]


def events(batch: str) -> list[str]:
    """The reports of a batch, without summaries, names and accounts."""
    return [
        line
        for line in batch.split("\n")[1:]
        if ",threshold_" not in line and "@" != line[0] != "~"
    ]


def compared(line: str) -> float:
    found = re.search(r",cmp:([^,]*),", line)
    assert found, line
    return float(found[1])
