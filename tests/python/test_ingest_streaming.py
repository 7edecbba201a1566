"""What does not fit into memory gives the same as what does; and the command ``convert``."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pyarrow.parquet as pq
import pytest
import tpc_file
from click.testing import CliRunner
from mission_samples import BagFile, equal_tables, key, line, ns
from tpc_file import FULL, TpcFile, report, site, summary, sync

from pytpc.base.errors import TpcError
from pytpc.cli.main import main
from pytpc.ingest import spool as spool_module
from pytpc.ingest.gathering import Gathering
from pytpc.ingest.merged import Merged
from pytpc.ingest.reading import gather, opened, read
from pytpc.recording.events import Events
from pytpc.recording.mission import load_recording

ROOT = Path(__file__).parents[2]


@pytest.fixture
def mission(tmp_path) -> list[Path]:
    """A bag and two binary files; the second has, of each of the bag's reports, the same."""
    folder = tmp_path / "mission"
    folder.mkdir()
    with BagFile(folder / "a.bag") as bag:
        for step in range(300):
            bag.log(100 + step / 10, "/uav", line(step % 3, step % 2, step, 5))
        bag.mark(110, "/mark_action")
        bag.log(111, "/uav", "threshold_information:broken")
    for name, node, count in (("b.tpc", "/uav", 300), ("c.tpc", "/face", 3 * FULL)):
        made = TpcFile(tpc_file.header(node=node, real=ns(100)))
        made.system(*(site(n + 1, key(n)) for n in range(3)), sync(0, ns(100)))
        made.system(*(summary(1, begin=(n, 0), end=(n + 5, 0), period=n) for n in range(40)))
        step_ns = ns(0.1) if node == "/uav" else ns(0.003)
        for thread in (1, 2):
            own = range(thread - 1, count, 2)
            records = [report(n % 3 + 1, n * step_ns, n, 5, result=n % 2) for n in own]
            for begin in range(0, len(records), FULL):
                made.thread(thread, *records[begin : begin + FULL])
        made.write(folder / name)
    return sorted(folder.iterdir())


def test_runs_on_disk_give_the_same(mission, tmp_path, monkeypatch):
    whole = read(mission)
    assert len(whole.events) == 300 + 3 * FULL
    assert len(whole.summaries) == 80
    monkeypatch.setattr(spool_module, "_BLOCK_ROWS", 128)
    monkeypatch.setattr(spool_module, "_SMALLEST_BLOCK", 16)
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    gathering = Gathering(scratch, run_rows=97)
    gather(mission, gathering)
    Merged(gathering, "a").save(tmp_path / "out")
    parts = load_recording(tmp_path / "out")
    assert equal_tables(parts.events, whole.events)
    assert equal_tables(parts.summaries, whole.summaries)
    for name in ("marks", "start_ns", "end_ns", "malformed", "malformed_first", "notes", "lost"):
        assert getattr(parts, name) == getattr(whole, name), name
    assert (scratch / "events").stat().st_size > 0


def test_scratch_is_removed_whatever_happens(mission, tmp_path):
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    with opened(mission, scratch) as outcome:
        assert len(list(scratch.iterdir())) == 1
        outcome.save(tmp_path / "out")
    assert list(scratch.iterdir()) == []
    mission[1].write_bytes(mission[1].read_bytes()[:20])
    with pytest.raises(TpcError, match="ends at byte 20"), opened(mission, scratch):
        pass
    assert list(scratch.iterdir()) == []


def run(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def test_convert(mission, tmp_path):
    result = run("convert", *mission, "-o", tmp_path / "out")
    assert result.exit_code == 0, result.output
    assert result.stdout == (
        f"6,438 reports of 3 comparisons, 80 summaries, 1 mark (1 of type I, 0 of type II) in"
        f" 29.9 s: {tmp_path / 'out'}\n"
    )
    assert "300 reports in" in result.stderr
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == [
        "events.parquet",
        "marks.json",
        "summaries.parquet",
    ]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mission", "out"]


def test_convert_as_json_to_a_file(mission, tmp_path):
    out = tmp_path / "x.parquet"
    said = json.loads(run("convert", mission[0].parent, "-o", out, "--json").stdout)
    assert (said["reports"], said["comparisons"], said["malformed"], said["name"]) == (
        6438,
        3,
        1,
        "mission",
    )
    assert equal_tables(Events.read(out), read(mission).events)
    assert pq.read_schema(out).names[0] == "time_ns"


# What was written as CSV is read again: the same but for the node.
def test_convert_to_csv_and_back(tmp_path):
    bag = tmp_path / "a.bag"
    values = [0.1, 1 / 3, 1e-300, -0.0, float("inf"), float("nan"), 123456789.0]
    with BagFile(bag) as writer:
        for step, value in enumerate(values):
            writer.log(1_700_000_000.5 + step, "/uav", line(1, step % 2, value, 5))
    out = tmp_path / "x.csv"
    assert run("convert", bag, "-o", out).exit_code == 0
    first = out.read_text().splitlines()[0]
    assert first == f"1700000000.5000000,{key(1)},0,cmp:0.1,thresh:5,res:0"
    again, before = read(out).events, read(bag).events
    assert again.time_ns.tolist() == before.time_ns.tolist()
    assert [str(value) for value in again.cmp] == [str(value) for value in before.cmp]
    assert again.result.tolist() == before.result.tolist()


def test_convert_says_what_is_wrong(mission, tmp_path):
    (tmp_path / "file").write_text("x")
    for arguments, text in [
        ((tmp_path / "no", "-o", tmp_path / "out"), "no such bag, file or folder"),
        ((mission[0], "-o", tmp_path / "file" / "x.parquet"), "cannot be written"),
    ]:
        result = run("convert", *arguments)
        assert result.exit_code == 1
        assert text in result.stderr.splitlines()[-1]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "mission"]


# 3.3 million reports, 100 MiB: in memory they take 420 MB, and what is imported 120 MB alone.
def test_memory_is_bounded(tmp_path):
    made = TpcFile(tpc_file.header(real=ns(100)))
    made.system(site(1, key(1)), sync(0, ns(100)))
    records = b"".join(report(1, n, n, 5) for n in range(FULL))
    path = tmp_path / "large.tpc"
    with path.open("wb") as stream:
        stream.write(made.data())
        for number in range(1600):
            stream.write(tpc_file.chunk(1, number % 2 + 1, number // 2 * FULL, records))
    program = (
        "import sys\n"
        "from pytpc.cli.main import main\n"
        "main(sys.argv[1:], standalone_mode=False)\n"
        "print(next(line for line in open('/proc/self/status') if line.startswith('VmHWM')))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program, "convert", str(path), "-o", str(tmp_path / "out")],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.startswith("3,273,600 reports")
    peak_kb = int(done.stdout.split("VmHWM:")[1].split()[0])
    assert peak_kb < 330 * 1024
