"""Analyses processes as a whole: their link units, merged, are one program.

For each process, ``tpc-merge`` makes one module of the bitcode of its units, and the passes write a
plan: the places to report, in terms of the units. Nothing of the build is changed here.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import re
import resource
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any

from pytpc.base.atomic import write_atomic
from pytpc.base.checked_json import parse_json
from pytpc.base.errors import InputError, MissingToolError, RunError, TpcError
from pytpc.base.paths import clang_release, plugin, prefix, search_path
from pytpc.base.wording import many
from pytpc.processes.manifests import Manifest, read_manifest_of
from pytpc.processes.process import Outcome, Process, Unit

FOLDER = "processes"
"""Below the root of the bases."""
_ODD = re.compile(r"[^\w.-]+", re.ASCII)
# A larger process is not tried.
_MOST_FUNCTIONS = 50_000
_RESULT = "result.json"
_SCHEMA = 1
# A program that neither ends nor keeps to its budget.
_MOST_SECONDS = 7200
_BROKEN = (OSError, ValueError, KeyError, TypeError)
_Units = Sequence[tuple[Unit, Manifest]]
_PLAN = "plan.json"


@dataclass(frozen=True, slots=True)
class Budget:
    """What the analysis of one process may take; beyond it, its units are analysed alone.

    ``seconds`` are of processor time.
    """

    seconds: int
    memory_mib: int = 6144


@dataclass(frozen=True, slots=True)
class Analysed:
    """A process whose analysis was tried.

    ``plan`` is the file that the links of its units take; None if there is none, and ``failure``
    says why. ``functions`` are the names of each unit's. ``left_out`` are texts about code that is
    not in it. ``is_new`` is false where an earlier result still holds.
    """

    process: Process
    plan: Path | None
    functions: Mapping[str, frozenset[str]]
    left_out: tuple[str, ...] = ()
    failure: str | None = None
    is_new: bool = True


Progress = Callable[[str, int, int], None]


def analyse_processes(
    processes: Sequence[Process],
    root: Path,
    budget: Budget,
    on_progress: Progress | None = None,
) -> list[Analysed]:
    """Analyse each process in which code of several units meets; reuse what still holds.

    Args:
        processes: those of a workspace.
        root: the root of its bases; results are kept below it.
        budget: for each of them.
        on_progress: called with (name of a process that begins, processes done, all of them).

    Raises:
        MissingToolError: a program of TPC or LLVM is absent.
    """
    joined = [process for process in processes if process.is_joined]
    kept = {_folder_of(process, root) for process in joined}
    for folder in (root / FOLDER).glob("*"):
        if folder not in kept:
            shutil.rmtree(folder, ignore_errors=True)
    if not joined:
        return []
    tools = _Tools.find()
    digest_of = cache(_digest)
    done = 0

    def work(process: Process) -> Analysed:
        nonlocal done
        folder = _folder_of(process, root)

        def begin() -> None:
            if on_progress is not None:
                on_progress(process.name, done, len(joined))

        found = _analyse(_Work(process, folder, tools, budget), digest_of, begin)
        done += 1
        return found

    with ThreadPoolExecutor(_workers(budget)) as pool:
        futures = [pool.submit(work, process) for process in joined]
        try:
            return [future.result() for future in futures]
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            tools.end()
            raise


def with_outcomes(processes: Sequence[Process], root: Path) -> tuple[Process, ...]:
    """The processes, with what the last analysis of each came to.

    Args:
        processes: those of a workspace.
        root: the root of its bases.
    """
    return tuple(replace(one, outcome=_outcome(_folder_of(one, root))) for one in processes)


def _outcome(folder: Path) -> Outcome | None:
    found = _result_in(folder)
    if found is None:
        return None
    return Outcome(
        found["count"],
        found["comparisons"],
        found["seconds"],
        found["memory_mib"],
        found["failure"],
    )


def _folder_of(process: Process, root: Path) -> Path:
    # Two names may differ only in what is replaced.
    digest = hashlib.sha256(process.name.encode()).hexdigest()[:8]
    return root / FOLDER / f"{_ODD.sub('_', process.name)}-{digest}"


def _workers(budget: Budget) -> int:
    """How many processes are analysed side by side: each may need all of its budget."""
    try:
        free = re.search(r"MemAvailable:\s*(\d+)", Path("/proc/meminfo").read_text("ascii"))
    except OSError:
        free = None
    if free is None:
        return 1
    return max(1, min(len(os.sched_getaffinity(0)), (int(free[1]) >> 10) // budget.memory_mib))


@dataclass(frozen=True, slots=True)
class _Spent:
    """What a program said, and what it took."""

    status: int
    out: str
    err: str
    seconds: float
    memory_mib: int

    @property
    def failure(self) -> str:
        """The last line that it wrote."""
        said = self.err.strip().splitlines() or [f"it ends with status {self.status}"]
        return said[-1]


@dataclass(slots=True)
class _Tools:
    """The programs; those that run are ended together."""

    merge: Path
    opt: Path
    passes: Path
    _running: set[subprocess.Popen[str]] = field(default_factory=set)
    has_ended: bool = False

    @classmethod
    def find(cls) -> _Tools:
        merge = prefix() / "bin/tpc-merge"
        release = clang_release()
        opt = shutil.which(f"opt-{release}", path=search_path())
        if not merge.is_file():
            raise MissingToolError(f"{merge} is not there; install TPC's C++ half again")
        if opt is None:
            raise MissingToolError(f"opt-{release} not found; apt-get install llvm-{release}")
        return cls(merge, Path(opt), plugin())

    def run(self, command: Sequence[object]) -> _Spent:
        """Run a program to its end.

        Raises:
            RunError: it was ended from outside, as by an interruption or for want of memory.
        """
        if self.has_ended:
            raise RunError("interrupted")
        with (
            tempfile.TemporaryFile("w+") as out,
            tempfile.TemporaryFile("w+", errors="replace") as err,
            subprocess.Popen(
                [str(word) for word in command],
                stdin=subprocess.DEVNULL,
                stdout=out,
                stderr=err,
                text=True,
            ) as process,
        ):
            self._running.add(process)
            resource.prlimit(process.pid, resource.RLIMIT_CPU, (_MOST_SECONDS, _MOST_SECONDS))
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            self._running.discard(process)
            texts = []
            for stream in (out, err):
                stream.seek(0)
                texts.append(stream.read())
        if process.returncode < 0:
            raise RunError(f"{command[0]} was ended by signal {-process.returncode}")
        seconds = usage.ru_utime + usage.ru_stime
        return _Spent(process.returncode, texts[0], texts[1], seconds, usage.ru_maxrss >> 10)

    def end(self) -> None:
        """End the programs that run, and begin no other."""
        self.has_ended = True
        for process in list(self._running):
            with contextlib.suppress(ProcessLookupError):
                process.kill()


def _analyse(work: _Work, digest_of: Callable[[Path], str], begin: Callable[[], None]) -> Analysed:
    left_out = []
    units: list[tuple[Unit, Manifest]] = []
    try:
        for unit in work.process.units:
            manifest = read_manifest_of(unit)
            if manifest is None:
                left_out.append(f"{unit.path}: has no bitcode; what it does is not seen")
            else:
                units.append((unit, manifest))
        key = work.key(units, digest_of)
        result = _result_in(work.folder)
        is_new = result is None or result["key"] != key or not _is_complete(work.folder, result)
        if result is None or is_new:
            begin()
            work.folder.mkdir(parents=True, exist_ok=True)
            # An interruption must not leave it beside the plan of other code.
            (work.folder / _RESULT).unlink(missing_ok=True)
            result = {"schema": _SCHEMA, "key": key, **work.run(units)}
            write_atomic(work.folder / _RESULT, json.dumps(result).encode())
    except (TpcError, *_BROKEN) as error:
        return Analysed(work.process, None, {}, failure=str(error))
    else:
        return Analysed(
            work.process,
            work.folder / _PLAN if result["failure"] is None else None,
            {name: frozenset(names) for name, names in result["functions"].items()},
            (*left_out, *result["left_out"]),
            result["failure"],
            is_new,
        )


def _digest(path: Path) -> str:
    """The SHA-256 of a file of any size."""
    digest = hashlib.sha256()
    with path.open("rb") as stream:
        while block := stream.read(1 << 20):
            digest.update(block)
    return digest.hexdigest()


def _is_complete(folder: Path, result: Mapping[str, Any]) -> bool:
    return result["failure"] is not None or (folder / _PLAN).is_file()


def _result_in(folder: Path) -> dict[str, Any] | None:
    """The result of the last analysis; None if there is none of this version of TPC."""
    path = folder / _RESULT
    if not path.is_file():
        return None
    try:
        found: Any = parse_json(path)
    except InputError:
        return None
    return found if isinstance(found, dict) and found.get("schema") == _SCHEMA else None


@dataclass(frozen=True, slots=True)
class _Work:
    """The analysis of one process; results are JSON."""

    process: Process
    folder: Path
    tools: _Tools
    budget: Budget

    def key(self, units: _Units, digest_of: Callable[[Path], str]) -> str:
        """A text that differs when the result may."""
        tools = [digest_of(tool) for tool in (self.tools.passes, self.tools.merge)]
        budget = [self.budget.seconds, self.budget.memory_mib, _MOST_FUNCTIONS]
        scopes = self.process.named_scopes
        what: list[Any] = [self.process.name, *tools, budget, self._without(), scopes]
        for unit, one in units:
            objects = [(file.as_json(), digest_of(file.path)) for file in one.objects]
            rules = [(rule, digest_of(Path(rule))) for rule in one.rules]
            options = [one.source_root, one.profile, rules, one.excluded, one.constants]
            what.append([unit.package, unit.name, objects, options])
        return hashlib.sha256(json.dumps(what).encode()).hexdigest()

    def run(self, units: _Units) -> dict[str, Any]:
        """Merge and analyse."""
        with tempfile.TemporaryDirectory(prefix="tpc-process-") as name:
            return self._run_in(Path(name), units)

    def _run_in(self, folder: Path, units: _Units) -> dict[str, Any]:
        listed = [
            {
                "name": unit.full_name,
                "files": [file.as_json() for file in one.objects],
            }
            for unit, one in units
        ]
        scopes, without = self.process.named_scopes, self._without()
        (folder / "units.json").write_text(
            json.dumps({"units": listed, "scopes": scopes, "without": without})
        )
        tools, program = self.tools, folder / "all.bc"
        merged = tools.run([tools.merge, folder / "units.json", "-o", program])
        if merged.status != 0:
            return _result(merged, failure=merged.failure)
        summary = json.loads(merged.out)
        if summary["functions"] > _MOST_FUNCTIONS:
            count = many(summary["functions"], "function")
            return _result(merged, failure=f"too large to be analysed as a whole: {count}")
        plan, static = self.folder / _PLAN, folder / "static.json"
        load = [f"-load={tools.passes}", f"-load-pass-plugin={tools.passes}", "-passes=tpc"]
        output = ["-disable-output", "-tpc-instrument=false", f"-tpc-plan-out={plan}"]
        named = [f"-tpc-link-unit={self.process.name}", f"-tpc-static-info={static}"]
        analysed = tools.run([tools.opt, *load, *output, *named, *self._options(units), program])
        if analysed.status != 0 or not plan.is_file():
            return _result(merged, analysed, failure=analysed.failure)
        found: Any = parse_json(static)
        if found["failure"] is not None or "incomplete" in found:
            why = found["failure"] or found["incomplete"]
            return _result(merged, analysed, failure=why)
        return _result(merged, analysed, summary=summary, counts=found["counts"])

    def _without(self) -> list[str]:
        """The classes of plugins that it does not load, although a library of it may have them."""
        loaded = {plugin.kind for plugin in self.process.plugins}
        others = {one.kind for choice in self.process.choices for one in choice.others}
        return sorted(others - loaded)

    def _options(self, units: _Units) -> list[str]:
        """The options of the analysis: those of the units, together."""
        manifests = [one for _, one in units]
        first = manifests[0]
        roots = [one.source_root for one in manifests if one.source_root]
        excluded = dict.fromkeys(folder for one in manifests for folder in one.excluded)
        rules = dict.fromkeys(rule for one in manifests for rule in one.rules)
        return [
            f"-tpc-source-root={os.path.commonpath(roots) if roots else ''}",
            f"-tpc-profile={first.profile}",
            f"-tpc-max-seconds={self.budget.seconds}",
            f"-tpc-max-memory={self.budget.memory_mib}",
            *(f"-tpc-rules={rule}" for rule in rules),
            *(f"-tpc-exclude={folder}" for folder in excluded),
            *(["-tpc-constants"] if first.constants else []),
        ]


def _result(
    *ran: _Spent,
    failure: str | None = None,
    summary: Mapping[str, Any] | None = None,
    counts: Mapping[str, int] | None = None,
) -> dict[str, Any]:
    summary = summary or {"functions": 0, "units": (), "left_out": ()}
    # One text for each archive, whichever of its members it is.
    gone = summary["left_out"]
    files = dict.fromkeys((one["file"].partition("(")[0], one["why"]) for one in gone)
    return {
        "failure": failure,
        "count": summary["functions"],
        "functions": {one["name"]: one["functions"] for one in summary["units"]},
        "left_out": [f"{file}: {why}" for file, why in files],
        "seconds": sum(one.seconds for one in ran),
        "memory_mib": max(one.memory_mib for one in ran),
        "comparisons": 0 if counts is None else counts["comparisons"],
    }
