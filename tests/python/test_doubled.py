"""Source files that are linked into two link units of one process."""

from dataclasses import replace
from pathlib import Path

import pytest
from file_api import reply, target
from mission_samples import comparison, link_unit

from pytpc.build.doubled import doubled_sources
from pytpc.cli.console import tell_left_out
from pytpc.static.link_unit import Doubled
from pytpc.static.static_info import StaticInfo

BUFFER = "src/buffer.cpp"


def built(folder: Path, *targets: dict) -> None:
    # The last target is of another project.
    reply(folder, [*targets, target("other", "EXECUTABLE")])
    for each in targets:
        artifact = folder / each["artifacts"][0]["path"]
        artifact.parent.mkdir(exist_ok=True)
        artifact.touch()


def unit(folder: Path, name: str, *lines: int):
    numbers = {"core": 0, "layers": 10, "node": 20}
    found = [comparison(numbers[name] + line, "limit", file=BUFFER, lineno=line) for line in lines]
    plain = link_unit(found, source_root=str(folder / "source"))
    return replace(plain, link_unit=name, package="face")


def test_the_plugins_comparisons_do_not_report(tmp_path):
    built(
        tmp_path,
        target("core", "SHARED_LIBRARY", sources=(BUFFER, "src/core.cpp")),
        target("layers", "SHARED_LIBRARY", sources=(BUFFER,), needs=("core",)),
    )
    units = [unit(tmp_path, "core", 3), unit(tmp_path, "layers", 3, 4, 5)]
    # Of the three, one is known in the library that is loaded first.
    file = str(tmp_path / "source" / BUFFER)
    expected = [Doubled("face", "layers", "core", file, 2)]
    assert doubled_sources([tmp_path], units) == expected


@pytest.mark.parametrize(("needs", "found"), [(("core",), ["core"]), ((), [])])
def test_a_program_comes_before_the_libraries_that_it_links(tmp_path, needs, found):
    built(
        tmp_path,
        target("core", "SHARED_LIBRARY", sources=(BUFFER,)),
        target("node", "EXECUTABLE", sources=(BUFFER,), needs=needs),
    )
    units = [unit(tmp_path, "core", 3), unit(tmp_path, "node")]
    assert [each.link_unit for each in doubled_sources([tmp_path], units)] == found


def test_two_programs_and_what_is_known_in_both_are_fine(tmp_path):
    built(
        tmp_path,
        target("core", "EXECUTABLE", sources=(BUFFER,)),
        target("node", "EXECUTABLE", sources=(BUFFER,)),
        target("layers", "SHARED_LIBRARY", sources=(BUFFER,), needs=("core",)),
    )
    units = [unit(tmp_path, name, 3, 4) for name in ("core", "node", "layers")]
    assert doubled_sources([tmp_path], units) == []


def test_it_is_kept_and_said(tmp_path, capsys):
    doubled = Doubled("face", "layers", "core", "/ws/src/buffer.cpp", 2)
    static = StaticInfo.of([link_unit([])], doubled=[doubled])
    static.save(tmp_path / "static.json")
    tell_left_out(StaticInfo.load(tmp_path / "static.json"))
    assert capsys.readouterr().err == (
        "face/layers: 2 comparisons in /ws/src/buffer.cpp may not report: core has the file, too,"
        " and a process that loads that first runs its functions\n"
    )
