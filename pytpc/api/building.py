"""Questions about a build: how a workspace is built, and what the analysis found in it."""

from __future__ import annotations

from pytpc.build.build import BuildResult
from pytpc.build.build import build_workspace as build
from pytpc.workspace.colcon import BuildOptions

__all__ = ["BuildOptions", "BuildResult", "build"]
