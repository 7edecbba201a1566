"""Every command of the docs does what its page says, with the output that the page shows."""

from __future__ import annotations

import shutil
from importlib.util import find_spec
from itertools import groupby

import pytest
from flown import need_cpp_half

from docs_commands import Command, commands, not_run, pages
from docs_world import Reader, World

if shutil.which("roslaunch") is None:
    pytest.skip("ROS is not installed", allow_module_level=True)
need_cpp_half()


def of(page: str) -> list[Command]:
    """The commands of a page that are run."""
    left_out = not_run().get(page, {})
    found = [each for each in commands(page) if isinstance(each, Command)]
    if find_spec("rerun") is None:  # It needs Python 3.11.
        found = [each for each in found if "--rerun" not in each.text]
    return [each for each in found if each.text not in left_out]


@pytest.fixture(scope="session")
def world(tmp_path_factory: pytest.TempPathFactory) -> World:
    made = World(tmp_path_factory.mktemp("docs"))
    made.build()
    return made


@pytest.mark.parametrize("page", [page for page in pages() if of(page)])
def test_the_commands_of(page: str, world: World):
    found = of(page)
    world.prepare(found)
    with Reader(world) as reader:
        for _, block in groupby(found, key=lambda command: command.block):
            reader.read(list(block))
