"""The packages, installed where no checkout is: the wheel builds, runs and diagnoses a workspace.

The libraries are those of this virtual environment. `make test-package` does the same with those
from PyPI, and with the Debian package in a new Debian.
"""

from __future__ import annotations

import gzip
import os
import runpy
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import package
from pytpc.base.paths import prefix

ROOT = Path(__file__).parents[2]
HOUR = runpy.run_path(str(ROOT / "tests/package/first_hour.py"), run_name="first_hour")


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    program = [sys.executable, ROOT / "tools/package.py", "--only", "wheel", "--out", folder]
    subprocess.run([*program, "--from", prefix()], check=True, timeout=300)
    (found,) = folder.glob("*.whl")
    return found


@pytest.fixture(scope="module")
def program(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """``pytpc`` of a new virtual environment, beside links to the libraries of this one."""
    folder = tmp_path_factory.mktemp("venv")
    subprocess.run(["/usr/bin/python3", "-m", "venv", "--without-pip", folder / "venv"], check=True)
    (site,) = (folder / "venv/lib").glob("python3*/site-packages")
    into = ["--no-deps", "--no-index", "--quiet", "--disable-pip-version-check"]
    pip = [sys.executable, "-m", "pip", "--python", folder / "venv/bin/python", "install"]
    subprocess.run([*pip, *into, wheel], check=True, timeout=300)
    for path in (Path(each) for each in sys.path if each.startswith(sys.prefix)):
        for entry in path.iterdir() if path.name == "site-packages" else ():
            if "pytpc" not in entry.name and not (site / entry.name).exists():
                (site / entry.name).symlink_to(entry)
    return folder / "venv/bin/pytpc"


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    HOUR["write_workspace"](tmp_path / "ws")
    return tmp_path / "ws"


def run(program: Path, *words: object, path: str = "/usr/bin:/bin") -> str:
    environment = {"PATH": path, "HOME": os.environ["HOME"], "COLUMNS": "200", "LANG": "C.UTF-8"}
    ran = subprocess.run(
        [program, *map(str, words)],
        cwd="/",
        env=environment,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return ran.stdout


def test_the_wheel_builds_a_workspace_with_another_python_first_on_path(program, workspace):
    shims = workspace.parent / "pyenv/shims"
    shims.mkdir(parents=True)
    (workspace.parent / "pyenv/versions").mkdir()
    # A Python of pyenv has no module of catkin.
    (shims / "python3").write_text("#!/bin/sh\nexit 1\n")
    (shims / "python3").chmod(0o755)
    path = f"{shims}:/usr/bin:/bin"
    doctor = run(program, "doctor", workspace, path=path)
    assert "the first python3 on PATH is pyenv's" in doctor
    assert "make setup" not in doctor
    assert "catkin_pkg" not in doctor
    built = run(program, "build", workspace, path=path)
    assert "3 comparisons in 2 link units" in built
    listed = run(program, "list", workspace)
    for parameter in ("~stop_distance", "~max_distance", "~min_range"):
        assert parameter in listed
    (driver,) = workspace.glob(".tpc/install/**/lib/patrol/driver")
    linked = subprocess.run(["ldd", driver], capture_output=True, text=True, check=True).stdout
    carried = program.parents[1] / "lib"
    assert f"libtpc_log.so.0 => {carried}/" in linked


@pytest.mark.parametrize("include", ["/usr/include", "/nowhere/include"])
def test_the_log_library_is_built_again_from_what_the_wheel_carries(program, tmp_path, include):
    if shutil.which("ninja") is None:
        pytest.skip("no ninja")
    # The package files of Debian 13 name a folder that does not exist.
    places = ["pkg-config", "--variable=pcfiledir", "roscpp"]
    (place,) = subprocess.run(places, check=True, capture_output=True, text=True).stdout.split()
    lines = (Path(place) / "roscpp.pc").read_text().splitlines()
    others = [line for line in lines if not line.startswith("Cflags:")]
    (tmp_path / "roscpp.pc").write_text("\n".join([*others, f"Cflags: -I{include}", ""]))
    (sources,) = program.parents[1].glob("lib/*/site-packages/pytpc/native/*/share/tpc/runtime_log")
    configure = ["cmake", "-S", sources, "-B", tmp_path / "build", "-G", "Ninja"]
    configure += [f"-DCMAKE_INSTALL_PREFIX={tmp_path / 'there'}"]
    environment = {**os.environ, "PATH": "/usr/bin:/bin", "PKG_CONFIG_PATH": str(tmp_path)}
    subprocess.run(configure, check=True, env=environment, timeout=900, capture_output=True)
    plan = subprocess.run(
        ["ninja", "-C", tmp_path / "build", "-n"],
        env=environment,
        check=True,
        capture_output=True,
        text=True,
    )
    assert "libtpc_log_ros1.so" in plan.stdout


def test_a_first_hour_with_the_wheel_ends_with_a_mended_robot(program, tmp_path, monkeypatch):
    # No virtual environment, no checkout: only the programs of the system.
    monkeypatch.setenv("PATH", "/usr/bin:/bin")
    for name in ("PYTHONPATH", "VIRTUAL_ENV", "ROS_MASTER_URI"):
        monkeypatch.delenv(name, raising=False)
    # It exits with a message where the verdict, the value or the mended file is not right.
    assert HOUR["main"](program, tmp_path) == "~stop_distance"


@pytest.fixture(scope="module")
def debian_package(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The Debian package without the libraries, which would be downloaded."""
    folder = tmp_path_factory.mktemp("debian")
    root = folder / "root"
    package.write_home(root, wheel, libraries=())
    # A library that says its license, as those from PyPI do.
    about = root / package.SITE / "kinematics-1.2.dist-info/METADATA"
    about.parent.mkdir()
    about.write_text(
        "Metadata-Version: 2.1\nName: kinematics\nVersion: 1.2\nLicense: MIT License\n\n"
    )
    made = folder / "pytpc_0.0.1_amd64.deb"
    package.pack(root, made, "0.0.1")
    return made


@pytest.fixture(scope="module")
def installed(debian_package: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An empty prefix, into which dpkg has installed the package."""
    root = tmp_path_factory.mktemp("installed")
    (root / "var/lib/dpkg/info").mkdir(parents=True)
    (root / "var/lib/dpkg/status").touch()
    subprocess.run([*dpkg(root), "--install", debian_package], check=True, capture_output=True)
    return root


def dpkg(root: Path) -> list[str]:
    """Not even as another user does it touch this machine's packages."""
    forced = "--force-not-root,depends,script-chrootless"
    return ["dpkg", f"--root={root}", f"--log={root}/dpkg.log", forced]


def test_dpkg_finds_each_file_of_the_package_as_it_was_built(installed):
    verify = [*dpkg(installed), "--verify", "pytpc"]
    assert subprocess.run(verify, check=True, capture_output=True, text=True).stdout == ""
    launcher = installed / "usr/bin/pytpc"
    launcher.write_text(launcher.read_text() + "#\n")
    changed = subprocess.run(verify, check=False, capture_output=True, text=True).stdout
    assert changed.split() == ["??5??????", "/usr/bin/pytpc"]


def test_the_debian_package_suggests_what_a_user_of_clang_22_needs(debian_package):
    field = ["dpkg-deb", "--field", debian_package, "Suggests"]
    said = subprocess.run(field, check=True, capture_output=True, text=True).stdout
    assert said == "clang-22, lld-22, llvm-22\n"


def test_the_debian_package_names_the_licenses_of_its_libraries(installed):
    papers = installed / "usr/share/doc/pytpc"
    text = (papers / "copyright").read_text()
    assert "\n kinematics 1.2: MIT License\n" in text
    assert "/usr/share/common-licenses/Apache-2.0" in text
    changes = gzip.decompress((papers / "changelog.gz").read_bytes())
    assert changes == (ROOT / "CHANGELOG.md").read_bytes()


def test_the_installed_package_starts_with_the_python_of_the_system(installed, tmp_path):
    # The launcher names /usr/lib/pytpc; what it starts there is the same.
    python = installed / "usr/lib/pytpc/bin/python3"
    libraries = os.pathsep.join(each for each in sys.path if each.endswith("-packages"))
    said = subprocess.run(
        [python, "-P", "-s", "-m", "pytpc", "toolchain", "cmake"],
        cwd=tmp_path,
        env={"PATH": "/usr/bin:/bin", "HOME": str(tmp_path), "PYTHONPATH": libraries},
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    assert f"{installed}/usr/lib/pytpc/lib/python3.11/site-packages/pytpc/native/" in said
    launcher = (installed / "usr/bin/pytpc").read_text()
    assert "exec /usr/lib/pytpc/bin/python3 -P -s -m pytpc" in launcher
