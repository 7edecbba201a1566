"""The commands of the pages that watch a graph, like those in test_docs_commands.py."""

from __future__ import annotations

import shutil

import pytest
from flown import need_cpp_half

from docs_commands import WATCH_A_GRAPH, run_of
from docs_world import World, read_page

if shutil.which("roslaunch") is None:
    pytest.skip("ROS is not installed", allow_module_level=True)
need_cpp_half()


@pytest.mark.parametrize("page", WATCH_A_GRAPH)
def test_the_commands_of(page: str, world: World):
    read_page(world, run_of(page))
