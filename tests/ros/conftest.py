"""What the tests on a real graph share: the example, built once."""

from __future__ import annotations

from pathlib import Path

import pytest

from pytpc.build import BuildResult, build_workspace
from pytpc.demo_examples import IMAGE_CAPTURE, link_package


def build_example(folder: Path, build_type: str = "RelWithDebInfo") -> BuildResult:
    """The example built in a workspace of its own."""
    link_package(IMAGE_CAPTURE, folder)
    return build_workspace(folder, build_type=build_type)


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory) -> BuildResult:
    return build_example(tmp_path_factory.mktemp("ws"))
