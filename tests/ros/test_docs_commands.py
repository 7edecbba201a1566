"""Every command of the docs does what its page says, with the output that the page shows.

Those of the pages that watch a graph are in test_docs_graphs.py.
"""

from __future__ import annotations

import shutil

import pytest
from flown import need_cpp_half

from docs_commands import WATCH_A_GRAPH, pages, run_of
from docs_world import World, read_page

if shutil.which("roslaunch") is None:
    pytest.skip("ROS is not installed", allow_module_level=True)
need_cpp_half()


@pytest.mark.parametrize(
    "page", [page for page in pages() if page not in WATCH_A_GRAPH and run_of(page)]
)
def test_the_commands_of(page: str, world: World):
    read_page(world, run_of(page))
