"""The engine: the same results by threads, by processes and by a scheduler."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import dask
import pytest
from recorded_fleet import dies, dies_for_good, dies_once, fails, joined, square

from patience import PATIENCE_S, wait_for
from pytpc.api.dask_engine import engine
from pytpc.base.errors import InputError, TpcError

pytestmark = pytest.mark.filterwarnings("ignore")
NUMBERS = list(range(100))


@pytest.mark.parametrize("cluster", [None, "local"])
def test_results_are_in_the_order_of_the_items(cluster: str | None):
    told = []
    with engine(cluster, 2) as own:
        assert own.map(square, NUMBERS, lambda *at: told.append(at)) == [[n * n] for n in NUMBERS]
        assert own.joined(square, NUMBERS, joined) == [n * n for n in NUMBERS]
        assert own.joined(square, [3], joined) == [9]
        assert own.map(square, []) == []
        assert own.joined(square, [], joined) == []
        with pytest.raises(ZeroDivisionError, match="7 / 0"):
            own.map(fails, [7])
    assert sorted(told) == [(done, 100) for done in range(1, 101)]


def test_a_worker_that_is_killed_changes_nothing(tmp_path: Path):
    with engine("local", 2) as own:
        jobs = [(tmp_path, number) for number in range(20)]
        assert own.joined(dies_once, jobs, joined) == [n * n for n in range(20)]
    # It was done once more.
    assert (tmp_path / "died").exists()
    assert len((tmp_path / "5").read_text()) >= 2


def test_an_item_at_which_workers_die_again_and_again():
    """The others have their results, also those that waited on these workers."""
    once = dask.config.set({"distributed.scheduler.allowed-failures": 0})
    with once, engine("local", 2) as own:
        found = own.map(dies, list(range(10)), lost=lambda number: [-number])
        assert found == [[-5 if n == 5 else n * n] for n in range(10)]
        with pytest.raises(TpcError, match="workers died again and again"):
            own.map(dies, [5])


def test_no_worker_starts_any_more(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("pytpc.api.dask_engine._STARTS_S", 1.0)
    died, preload = tmp_path / "died", tmp_path / "preload.py"
    preload.write_text(f"import os\nos.path.exists({str(died)!r}) and os._exit(1)\n")
    with dask.config.set({"distributed.worker.preload": [str(preload)]}), engine("local", 1) as own:
        assert own.map(square, [3]) == [[9]]
        # It is in this list as long as it lives.
        assert own.client.cluster.scheduler_info["workers"]
        with pytest.raises(TpcError, match="no worker process starts any more; give fewer"):
            own.map(dies_for_good, [died], lost=lambda _: [])


def test_a_scheduler_that_runs_already(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("pytpc.api.dask_engine._STARTS_S", 1.0)
    file = tmp_path / "scheduler.json"
    folder = str(Path(__file__).parent)
    env = {"PYTHONPATH": ":".join([folder, *sys.path]), "PATH": "/usr/bin:/bin"}
    command = [sys.executable, "-m", "distributed.cli.dask_scheduler"]
    own = ["--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", str(file)]
    started = [subprocess.Popen([*command, *own], env=env, stderr=subprocess.DEVNULL)]
    try:
        wait_for(lambda: file.is_file() and file.read_text().endswith("}"))
        address = json.loads(file.read_text())["address"]
        with (
            engine(address) as found,
            pytest.raises(TpcError, match=f"no workers; start some with `dask worker {address}`"),
        ):
            found.map(square, NUMBERS)
        monkeypatch.undo()
        worker = [sys.executable, "-m", "distributed.cli.dask_worker", "--no-dashboard"]
        words = [*worker, "--scheduler-file", str(file), "--nthreads", "1"]
        started.append(subprocess.Popen(words, env=env, stderr=subprocess.DEVNULL, cwd=tmp_path))
        with engine(address) as found:
            assert found.joined(square, NUMBERS, joined) == [n * n for n in NUMBERS]
    finally:
        for one in reversed(started):
            one.terminate()
            one.wait(PATIENCE_S)


def test_nobody_answers(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr("pytpc.api.dask_engine._ANSWERS_S", 1)
    what = "no scheduler of Dask answers at tcp://127"
    with pytest.raises(InputError, match=what), engine("tcp://127.0.0.1:9"):
        pass
