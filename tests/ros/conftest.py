"""What the tests on a real graph share: the example, built once; a quiet machine."""

from __future__ import annotations

import fcntl
import os
from pathlib import Path

import pytest
from rich.console import Console

from docs_world import World
from pytpc.build.build import BuildResult, build_workspace
from pytpc.workspace.colcon import BuildOptions
from pytpc_evaluation.demo.demo_examples import IMAGE_CAPTURE, WATER_SAMPLER, link_package
from pytpc_evaluation.demo.demo_show import Built, build
from pytpc_evaluation.study.system import system_folder


def build_example(folder: Path, build_type: str = "RelWithDebInfo") -> BuildResult:
    """The example built in a workspace of its own."""
    link_package(IMAGE_CAPTURE, folder)
    return build_workspace(folder, BuildOptions(build_type=build_type))


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory) -> BuildResult:
    return build_example(tmp_path_factory.mktemp("ws"))


@pytest.fixture(scope="session")
def study_out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A study's folder."""
    return tmp_path_factory.mktemp("study")


@pytest.fixture(scope="session")
def water(study_out: Path) -> Built:
    """The robot in two languages, built where the study looks for it."""
    return build(WATER_SAMPLER, Console(quiet=True), system_folder(WATER_SAMPLER, study_out))


@pytest.fixture(scope="session")
def world(tmp_path_factory: pytest.TempPathFactory) -> World:
    """The home of the reader of the docs, with a robot that is built and recorded."""
    made = World(tmp_path_factory.mktemp("docs"))
    made.build()
    return made


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """What needs a quiet machine comes last."""
    items.sort(key=lambda item: item.get_closest_marker("quiet") is not None)


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Wait until this machine is ours, where a test needs that.

    ``tools/test`` holds a lock for as long as it does anything else; TPC_TEST_BUSY names it.
    """
    busy = os.environ.get("TPC_TEST_BUSY")
    if busy and item.get_closest_marker("quiet"):
        with Path(busy).open("rb") as lock:
            fcntl.flock(lock, fcntl.LOCK_SH)
