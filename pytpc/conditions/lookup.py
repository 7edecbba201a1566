"""The conditions of many TPCs: each file is parsed once, and again only when something changed."""

from __future__ import annotations

import hashlib
import json
import os
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from pytpc.base.atomic import write_atomic
from pytpc.base.errors import InputError, TpcError
from pytpc.base.paths import home
from pytpc.build.reconcile import recorded_units
from pytpc.conditions.compile_flags import Flags, flags_for
from pytpc.conditions.cpp_conditions import (
    Condition,
    Macro,
    Parsed,
    libclang,
    parse_conditions,
    precompile,
)
from pytpc.conditions.python_conditions import PythonSource
from pytpc.static.link_unit import LinkUnit
from pytpc.static.places import Tpc
from pytpc.static.static_info import StaticInfo, python_unit_file

_FORMAT = 1
# How often progress is reported while nothing is finished.
_TICK_S = 1.0
# A parsed file takes a quarter of a GiB.
_AT_ONCE = 4
# Precompiled headers take as long as a file does, and make each file four times as fast.
_WORTH_IT = 3
_SYSTEM = "/usr/"

GONE = "the source file is not on this machine"
CHANGED = "the source file has changed since the build"
NO_LIBCLANG = "libclang 19 is not on this machine (apt-get install libclang1-19)"
NOT_FOUND = "clang finds no condition here"
NOT_IN_PYTHON = "there is no condition here"
NEWER = "the source file is newer than the build; only the line of the comparison is certain"
WITHOUT_FLAGS = "parsed without the flags of the build"

Place = tuple[int, int]


@dataclass(frozen=True, slots=True)
class Answer:
    """The condition of a TPC; if there is none, ``note`` says why only the line is known.

    With one, ``note`` is empty, or says what makes it less than certain.
    """

    condition: Condition | None
    note: str = ""


@dataclass(frozen=True, slots=True)
class _Job:
    """A file to be looked at, and where."""

    file: str
    data: bytes
    flags: Flags
    places: tuple[Place, ...]

    @property
    def digest(self) -> str:
        """The digest of all that the answer depends on, except included files."""
        parts = (str(_FORMAT), self.file, *self.flags.arguments)
        return hashlib.sha256("\0".join(parts).encode() + b"\0" + self.data).hexdigest()


def look_up_conditions(
    static: StaticInfo,
    tpcs: Iterable[Tpc],
    on_progress: Callable[[int, int], None] | None = None,
    cache: Path | None = None,
) -> dict[str, Answer]:
    """The whole condition of each TPC, by its (nearest) key.

    A file in C++ is parsed with the flags that it was built with; that takes seconds for one that
    includes ROS, so answers are kept, and used again while the file, its flags and the headers
    outside of /usr stay as they are. A file in Python is parsed by Python.

    Args:
        static: where the TPCs are from.
        tpcs: any of its TPCs.
        on_progress: called with (files parsed, files to parse), at least each second.
        cache: folder of the answers; ``pytpc`` in the user's cache by default.
    """
    tpcs = list(tpcs)
    answers = _of_python(static, (tpc for tpc in tpcs if static.unit_of(tpc.key).is_python))
    contents: dict[str, bytes | None] = {}
    by_file: dict[str, list[Tpc]] = {}
    for tpc in tpcs:
        if tpc.key in answers:
            continue
        data = contents.setdefault(tpc.file, _read(tpc.file))
        why_not = _why_only_line(data, tpc, static.comparisons[tpc.key].source_code)
        if why_not:
            answers[tpc.key] = Answer(None, why_not)
        else:
            by_file.setdefault(tpc.file, []).append(tpc)
    wanted: dict[tuple[str, Flags], list[Tpc]] = {}
    for file, found in by_file.items():
        for key, several in _by_unit(found).items():
            flags = flags_for(file, static.unit_of(key))
            wanted.setdefault((file, flags), []).extend(several)
    jobs = [
        _Job(file, contents[file] or b"", flags, tuple(dict.fromkeys(map(_place, found))))
        for (file, flags), found in wanted.items()
    ]
    solved = _solve(jobs, cache if cache is not None else _default_cache(), on_progress)
    built = {(unit.package, unit.link_unit): _built_ns(unit) for unit in static.units}
    for (file, flags), conditions, found in zip(wanted, solved, wanted.values(), strict=True):
        for tpc in found:
            condition = conditions[_place(tpc)]
            notes = [] if condition is not None else [NOT_FOUND]
            notes += [] if flags.of_build else [WITHOUT_FLAGS]
            # The comparison's own line was checked above: the analysis keeps it.
            at = built[tpc.keys[0].package, tpc.keys[0].link_unit]
            notes += [NEWER] if _is_newer(condition, file, at) else []
            answers[tpc.key] = Answer(condition, "; ".join(notes))
    return answers


def _of_python(static: StaticInfo, tpcs: Iterable[Tpc]) -> dict[str, Answer]:
    """The conditions of comparisons in Python; finding them takes milliseconds, so none is kept."""
    sources: dict[str, PythonSource | str] = {}
    answers: dict[str, Answer] = {}
    for tpc in tpcs:
        source = sources.get(tpc.file)
        if source is None:
            source = sources[tpc.file] = _python_source(tpc.file)
        found = static.comparisons[tpc.key]
        if isinstance(source, str):
            answers[tpc.key] = Answer(None, source)
        elif not 1 <= tpc.lineno <= len(source.lines) or (
            found.source_code is not None
            and source.lines[tpc.lineno - 1].strip() != found.source_code.strip()
        ):
            answers[tpc.key] = Answer(None, CHANGED)
        else:
            place = (tpc.lineno, tpc.column, found.end_lineno, found.end_column)
            condition = source.condition(place)
            newer = _is_newer(condition, tpc.file, _built_ns(static.unit_of(tpc.key)))
            note = NEWER if newer else ""
            answers[tpc.key] = Answer(condition, note if condition else NOT_IN_PYTHON)
    return answers


def _python_source(file: str) -> PythonSource | str:
    """The file parsed, or why that is not possible."""
    data = _read(file)
    if data is None:
        return GONE
    try:
        return PythonSource(data)
    except ValueError:
        return CHANGED


def _is_newer(condition: Condition | None, file: str, built: int | None) -> bool:
    """Whether lines of the condition that the analysis did not keep may have changed."""
    if condition is None or condition.lineno == condition.end_lineno or built is None:
        return False
    return _changed_ns(file) > built


def _by_unit(tpcs: Iterable[Tpc]) -> dict[str, list[Tpc]]:
    """The TPCs of a file, by a key of the link unit whose flags are used: as few units as possible.

    Targets may compile one file with different macros, so each TPC needs flags that it exists with.
    """
    tpcs = list(tpcs)
    units = Counter((each.package, each.link_unit) for tpc in tpcs for each in tpc.keys)
    order = sorted(units, key=lambda unit: (-units[unit], unit))
    keys: dict[tuple[str, str], str] = {}
    found: dict[str, list[Tpc]] = {}
    for tpc in tpcs:
        own = {(each.package, each.link_unit): each.key for each in tpc.keys}
        unit = next(unit for unit in order if unit in own)
        found.setdefault(keys.setdefault(unit, own[unit]), []).append(tpc)
    return found


def _place(tpc: Tpc) -> Place:
    return tpc.lineno, tpc.column


def _why_only_line(data: bytes | None, tpc: Tpc, line: str | None) -> str:
    if data is None:
        return GONE
    lines = data.split(b"\n")
    if not 1 <= tpc.lineno <= len(lines):
        return CHANGED
    now = lines[tpc.lineno - 1].decode("utf-8", "replace").strip()
    if line is not None and now != line.strip():
        return CHANGED
    return "" if libclang() else NO_LIBCLANG


def _solve(
    jobs: Sequence[_Job], cache: Path, on_progress: Callable[[int, int], None] | None
) -> list[Mapping[Place, Condition | None]]:
    """The conditions of each job, in their order."""
    solved = [_kept(cache / f"{job.digest}.json", job) for job in jobs]
    todo = [number for number, known in enumerate(solved) if known is None]
    alike = Counter(jobs[number].flags for number in todo)
    with (
        TemporaryDirectory(prefix="tpc-") as folder,
        ThreadPoolExecutor(min(_AT_ONCE, os.cpu_count() or 1)) as pool,
    ):
        precompiled = {
            flags: pool.submit(_precompiled, flags, Path(folder, f"{number}.pch"))
            for number, flags in enumerate(alike)
            if alike[flags] >= _WORTH_IT
        }
        running = {
            pool.submit(_parse, jobs[number], precompiled.get(jobs[number].flags)): number
            for number in todo
        }
        pending = set(running)
        try:
            while pending:
                finished, pending = wait(pending, _TICK_S, FIRST_COMPLETED)
                for future in finished:
                    job, parsed = jobs[running[future]], future.result()
                    found = parsed.conditions if parsed is not None else (None,) * len(job.places)
                    solved[running[future]] = dict(zip(job.places, found, strict=True))
                    if parsed is not None:
                        _keep(cache / f"{job.digest}.json", job, parsed)
                if on_progress is not None:
                    on_progress(len(running) - len(pending), len(running))
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return [known or {} for known in solved]


def _precompiled(flags: Flags, target: Path) -> str | None:
    return str(target) if precompile(flags.arguments, target) else None


def _parse(job: _Job, precompiled: Future[str | None] | None) -> Parsed | None:
    """Parse a file, with the precompiled headers of its flags if that finds all conditions."""
    # The pool takes jobs in their order, so the job that is awaited here has begun.
    header = precompiled.result() if precompiled is not None else None
    arguments = job.flags.arguments
    if header is not None:
        parsed = parse_conditions(
            job.file, job.data, (*arguments, "-include-pch", header), job.places
        )
        if parsed is not None and None not in parsed.conditions:
            return parsed
    return parse_conditions(job.file, job.data, arguments, job.places)


def _kept(path: Path, job: _Job) -> dict[Place, Condition | None] | None:
    """The cached answers, if all are there and no header has changed since."""
    try:
        data: Any = json.loads(path.read_bytes())
        if any(_stamp(name) != stamp for name, stamp in data["included"].items()):
            return None
        conditions = data["conditions"]
        return {place: _condition(conditions[f"{place[0]}:{place[1]}"]) for place in job.places}
    except (OSError, ValueError, LookupError, TypeError, AttributeError):
        return None


def _keep(path: Path, job: _Job, parsed: Parsed) -> None:
    data = {
        "included": {
            name: _stamp(name) for name in parsed.included if not name.startswith(_SYSTEM)
        },
        "conditions": {
            f"{place[0]}:{place[1]}": None if found is None else asdict(found)
            for place, found in zip(job.places, parsed.conditions, strict=True)
        },
    }
    try:
        write_atomic(path, json.dumps(data, ensure_ascii=False).encode("utf-8", "replace"))
    except TpcError:
        # A cache that cannot be written costs time in the next run only.
        return


def _condition(data: dict[str, Any] | None) -> Condition | None:
    if data is None:
        return None
    macro = Macro(**data["macro"]) if data["macro"] is not None else None
    return Condition(**{**data, "macro": macro})


def _built_ns(unit: LinkUnit) -> int | None:
    """When a link unit was linked last; None where nothing says so."""
    if unit.build_folder is None:
        return None
    folder = Path(unit.build_folder)
    if unit.is_python:
        return _changed_ns(str(python_unit_file(folder, unit.link_unit))) or None
    try:
        recorded = {each.name: each.static_info for each in recorded_units(folder) or ()}
    except InputError:
        recorded = {}
    path = recorded.get(unit.link_unit, folder / "tpc" / f"{unit.link_unit}.json")
    return _changed_ns(str(path)) or None


def _changed_ns(file: str) -> int:
    """When a file was written last; 0 where it is not there."""
    return next(iter(_stamp(file)), 0)


def _stamp(file: str) -> list[int]:
    try:
        status = Path(file).stat()
    except OSError:
        return []
    return [status.st_mtime_ns, status.st_size]


def _read(file: str) -> bytes | None:
    try:
        return Path(file).read_bytes()
    except OSError:
        return None


def _default_cache() -> Path:
    base = os.environ.get("XDG_CACHE_HOME") or str(home() / ".cache")
    return Path(base) / "pytpc" / "conditions"
