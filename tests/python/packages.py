"""Packages for tests: real folders with a package.xml that catkin_pkg takes."""

from pathlib import Path

MANIFEST = """<?xml version="1.0"?>
<package format="3">
  <name>{name}</name>
  <version>0.1.0</version>
  <description>d</description>
  <maintainer email="a@b.org">a</maintainer>
  <license>x</license>
  {more}
</package>
"""


def add_package(
    folder: Path, name: str | None = None, *, more: str = "", cmakelists: bytes | None = None
) -> Path:
    """Make ``folder`` a package, called as the folder is or as ``name`` says; returns it."""
    folder.mkdir(parents=True, exist_ok=True)
    text = MANIFEST.format(name=name or folder.name, more=more)
    (folder / "package.xml").write_text(text, encoding="utf-8")
    if cmakelists is not None:
        (folder / "CMakeLists.txt").write_bytes(cmakelists)
    return folder


def install_prefix(folder: Path) -> Path:
    """Make ``folder`` look like the installed C++ half; returns tpc.cmake."""
    places = ("lib/tpc/TpcPasses.so", "lib/libtpc_log.so", "share/tpc/flags")
    for place in (*places, "share/tpc/cmake/tpc.cmake"):
        (folder / place).parent.mkdir(parents=True, exist_ok=True)
        (folder / place).touch()
    return folder / "share/tpc/cmake/tpc.cmake"


def make_workspace(folder: Path) -> Path:
    """Two packages, one with CRLF and one without a final newline; returns ``folder``."""
    add_package(folder / "src/arm", cmakelists=b"project(arm)\r\n")
    add_package(folder / "src/face", cmakelists=b"project(face)")
    return folder


def contents(folder: Path) -> dict[str, bytes]:
    """Every file with its bytes, the hidden ones too."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }
