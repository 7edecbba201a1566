"""A fork comes at any moment; the locks of the log library are taken in one order."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from compiling import compile_program

HERE = Path(__file__).parent
# A fork that waits for ever is met within 50.
FORKS = 200


@pytest.fixture(scope="module")
def forking(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return compile_program(HERE / "forking.cpp", tmp_path_factory.mktemp("fork") / "forking")


# The helper thread passes the summaries of 4,000 sites to the store of the topic, 50 times a
# second, while it holds the lock of the settings.
@pytest.mark.parametrize("sink", ["auto", "topic", "rosout"])
def test_a_fork_does_not_wait_for_a_helper_that_waits_for_it(
    forking: Path, settings: dict[str, str], sink: str
):
    env = {**settings, "TPC_SINK": sink, "TPC_POLICY": "edges", "TPC_PERIOD": "0.02"}
    ran = subprocess.run([str(forking), "4000", str(FORKS)], env=env, timeout=60, check=False)
    assert ran.returncode == 0
