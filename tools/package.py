"""Writes the wheel and the Debian package of TPC from what is installed in prefixes.

The wheel carries the C++ half in ``pytpc/native/llvm-RELEASE``, one folder for each release of
LLVM, laid out as it is installed. It has no extension module of Python: its tag is that of the
platform.

The Debian package holds a virtual environment in /usr/lib/pytpc: the system's Python with the
locked wheels of the libraries, which Debian 12 lacks or has too old, and the wheel of TPC.
"""

from __future__ import annotations

import argparse
import gzip
import hashlib
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Sequence
from importlib import metadata
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LOCK = ROOT / "tools/requirements.lock"
PLATFORM = "linux_x86_64"
HOME = Path("usr/lib/pytpc")
SITE = HOME / "lib/python3.11/site-packages"
# What `make setup` installs to build TPC; a user of the Debian package does not build it.
BUILDS_TPC = {"llvm-19-dev", "ninja-build", "python3-venv"}
CONTROL = """\
Package: pytpc
Version: {version}
Architecture: amd64
Maintainer: The TPC developers <tpc@localhost>
Section: science
Priority: optional
Depends: {depends}
Recommends: libclang1-19
Suggests: clang-22, lld-22, llvm-22
Installed-Size: {size}
Description: finds the parameter that makes a robot misbehave
 TPC finds the comparisons through which the parameters of ROS nodes act, has them report their
 values while the robot runs, and ranks the parameters when somebody marks an error. This package
 has the command pytpc, the plugins for clang, and the library that nodes report through.
"""
LAUNCHER = """\
#!/bin/sh
# A PYTHONHOME of another Python would keep the system's from starting.
unset PYTHONHOME
exec /usr/lib/pytpc/bin/python3 -P -s -m pytpc "$@"
"""
COPYRIGHT = """\
Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: pytpc
Comment:
 /{site} has Python libraries of others:
{libraries}
 The text of each license is in the library's folder NAME-VERSION.dist-info there.

Files: *
Copyright: the TPC developers
License: Apache-2.0
 On Debian systems, the text of this license is in /usr/share/common-licenses/Apache-2.0.
"""
VENV = """\
home = /usr/bin
include-system-site-packages = true
version = {version}
"""


def main() -> None:
    """Write what was asked for, and say where it is."""
    parser = argparse.ArgumentParser(description="writes the wheel and the Debian package of TPC")
    parser.add_argument("--from", dest="prefixes", type=Path, action="append", required=True)
    parser.add_argument("--out", type=Path, default=ROOT / "out")
    parser.add_argument("--only", choices=["wheel", "deb"])
    given = parser.parse_args()
    prefixes = {release_of(path): path.resolve() for path in given.prefixes}
    given.out.mkdir(parents=True, exist_ok=True)
    version = (ROOT / "VERSION").read_text("ascii").strip()
    wheel = given.out / f"pytpc-{version}-py3-none-{PLATFORM}.whl"
    package = given.out / f"pytpc_{version}_amd64.deb"
    seen = digest_of([*sources(), *(path for each in prefixes.values() for path in files_in(each))])
    if not is_made(wheel, seen):
        write_wheel(wheel, prefixes)
        mark_made(wheel, seen)
    print(wheel)
    if given.only != "wheel":
        if not is_made(package, seen):
            write_debian_package(package, wheel, version, given.out / "wheels")
            mark_made(package, seen)
        print(package)


def release_of(prefix: Path) -> str:
    """The release of LLVM that a prefix is for."""
    file = prefix / "share/tpc/clang-version"
    if not file.is_file():
        sys.exit(f"package: error: {file}: missing; run `make setup` again")
    return file.read_text("ascii").strip()


def files_in(folder: Path) -> list[Path]:
    """The files below a folder, in order, without what Python compiled."""
    found = (path for path in folder.rglob("*") if path.is_file())
    return sorted(path for path in found if "__pycache__" not in path.parts)


def sources() -> list[Path]:
    """What goes into the packages besides the C++ half, and what makes them."""
    places = (
        "pyproject.toml",
        "README.md",
        "VERSION",
        "LICENSE",
        "CHANGELOG.md",
        "cmake/colcon/tpc.mixin.in",
    )
    return [
        *(ROOT / each for each in places),
        ROOT / "tools/debian-packages.txt",
        LOCK,
        Path(__file__),
        *files_in(ROOT / "pytpc"),
    ]


def digest_of(files: Iterable[Path]) -> str:
    """One number for the names and the content of files."""
    digest = hashlib.sha256()
    for path in files:
        digest.update(f"{path}\0{hashlib.sha256(path.read_bytes()).hexdigest()}\n".encode())
    return digest.hexdigest()


def is_made(file: Path, seen: str) -> bool:
    """True if the file was made from just this."""
    note = file.with_name(f".{file.name}.made")
    return file.is_file() and note.is_file() and note.read_text("ascii") == seen


def mark_made(file: Path, seen: str) -> None:
    """Remember what a file was made from."""
    file.with_name(f".{file.name}.made").write_text(seen, "ascii")


def write_wheel(wheel: Path, prefixes: dict[str, Path]) -> None:
    """Build the wheel from a copy of the sources, because setuptools leaves files beside them."""
    with tempfile.TemporaryDirectory(prefix="tpc-wheel-") as name:
        copy = Path(name, "source")
        copy.mkdir()
        for each in ("pyproject.toml", "README.md", "VERSION", "LICENSE"):
            shutil.copy(ROOT / each, copy)
        ignored = shutil.ignore_patterns("__pycache__", "native")
        shutil.copytree(ROOT / "pytpc", copy / "pytpc", ignore=ignored)
        for release, prefix in prefixes.items():
            place = copy / "pytpc/native" / f"llvm-{release}"
            # A wheel has no links: each name of the compiler becomes a file.
            shutil.copytree(prefix, place)
            # `pytpc toolchain colcon` fills in where the wheel was installed.
            shutil.copy(ROOT / "cmake/colcon/tpc.mixin.in", place / "share/tpc/colcon/tpc.mixin")
        made = Path(name, "made")
        tag = f"--config-settings=--build-option=--plat-name={PLATFORM}"
        pip("wheel", "--no-deps", "--no-index", "--no-build-isolation", tag, "-w", made, copy)
        (built,) = made.glob("*.whl")
        if built.name != wheel.name:
            sys.exit(f"package: error: setuptools made {built.name}, and not {wheel.name}")
        move(built, wheel)


def write_debian_package(package: Path, wheel: Path, version: str, cache: Path) -> None:
    """Build the Debian package. The wheels of the libraries are downloaded once."""
    if sys.version_info[:2] != (3, 11):
        sys.exit("package: error: the Debian package needs Python 3.11; run make setup")
    with tempfile.TemporaryDirectory(prefix="tpc-deb-") as name:
        root = Path(name, "root")
        write_home(root, wheel, libraries_in(cache))
        pack(root, package, version)


def pack(root: Path, package: Path, version: str) -> None:
    """Add what a Debian package has besides the virtual environment, and build it."""
    with tempfile.TemporaryDirectory(prefix="tpc-deb-") as name:
        launcher = root / "usr/bin/pytpc"
        launcher.parent.mkdir(parents=True)
        launcher.write_text(LAUNCHER, "ascii")
        launcher.chmod(0o755)
        papers = root / "usr/share/doc/pytpc"
        papers.mkdir(parents=True)
        libraries = "\n".join(f" {each}" for each in licenses(root / SITE))
        copyright_text = COPYRIGHT.format(site=SITE, libraries=libraries)
        (papers / "copyright").write_text(copyright_text, "utf-8")
        changes = (ROOT / "CHANGELOG.md").read_bytes()
        (papers / "changelog.gz").write_bytes(gzip.compress(changes, mtime=0))
        (root / "DEBIAN").mkdir()
        (root / "DEBIAN/md5sums").write_text(md5sums(root), "utf-8")
        size = sum(path.stat().st_size for path in installed_files(root)) // 1024
        (root / "DEBIAN/control").write_text(
            CONTROL.format(version=version, depends=", ".join(depends()), size=size), "ascii"
        )
        run("chmod", "-R", "u=rwX,go=rX", root)
        built = Path(name, package.name)
        run("dpkg-deb", "--build", "--root-owner-group", "-Zzstd", root, built)
        move(built, package)


def libraries_in(cache: Path) -> Sequence[str | Path]:
    """Pip's arguments for the locked libraries, which are downloaded into a folder once."""
    known = cache / f".{digest_of([LOCK])}"
    if not known.is_file():
        shutil.rmtree(cache, ignore_errors=True)
        pip("download", "--no-deps", "--require-hashes", "-r", LOCK, "-d", cache)
        known.touch()
    return ("--find-links", cache, "--require-hashes", "-r", LOCK)


def write_home(root: Path, wheel: Path, libraries: Sequence[str | Path]) -> None:
    """/usr/lib/pytpc: the virtual environment, with compiled files that never look at times."""
    home = root / HOME
    (home / "bin").mkdir(parents=True)
    (home / "bin/python3").symlink_to("/usr/bin/python3")
    version = ".".join(map(str, sys.version_info[:3]))
    (home / "pyvenv.cfg").write_text(VENV.format(version=version), "ascii")
    site = root / SITE
    into = ("install", "--no-deps", "--no-index", "--no-compile", "--target", site)
    if libraries:
        pip(*into, *libraries)
    pip(*into, wheel)
    shutil.rmtree(site / "bin", ignore_errors=True)
    compiled = ("-m", "compileall", "-q", "--invalidation-mode", "unchecked-hash")
    python = Path(sys.executable)
    run(python, *compiled, "-j2", "-s", root, "-p", "/", site, check=False)


def installed_files(root: Path) -> list[Path]:
    """The files of the package. A link is none: what it leads to belongs to another package."""
    found = (path for path in root.rglob("*") if path.is_file() and not path.is_symlink())
    return sorted(path for path in found if path.relative_to(root).parts[0] != "DEBIAN")


def md5sums(root: Path) -> str:
    """By these, `dpkg --verify` finds files that were changed."""
    lines = (
        f"{hashlib.md5(path.read_bytes(), usedforsecurity=False).hexdigest()}"
        f"  {path.relative_to(root)}\n"
        for path in installed_files(root)
    )
    return "".join(lines)


def licenses(site: Path) -> list[str]:
    """Name, version and license of each library, as it says itself."""
    found = []
    for one in metadata.distributions(path=[str(site)]):
        about = one.metadata
        classified = [
            each.rpartition(" :: ")[2]
            for each in about.get_all("Classifier") or ()
            if each.startswith("License :: ")
        ]
        # Some have the whole text as their license.
        stated = (about.get("License") or "").strip().partition("\n")[0]
        named = about.get("License-Expression") or ", ".join(classified) or stated
        if about["Name"] != "pytpc":
            found.append(f"{about['Name']} {about['Version']}: {named or 'see its license files'}")
    return sorted(found, key=str.lower)


def depends() -> list[str]:
    """What the Debian package needs: Debian 12's libc and Python, and the list of `make setup`."""
    text = (ROOT / "tools/debian-packages.txt").read_text("utf-8")
    lines = (line.partition("#")[0].strip() for line in text.splitlines())
    wanted = [line for line in lines if line and line not in BUILDS_TPC]
    return ["libc6 (>= 2.36)", "python3 (>= 3.11)", "python3 (<< 3.12)", *wanted]


def pip(*words: str | Path) -> None:
    """Run pip; with hashes required, it does not matter which index has a file."""
    quiet = ("--disable-pip-version-check", "--quiet")
    run(sys.executable, "-m", "pip", *quiet, *words)


def run(*words: str | Path, check: bool = True) -> None:
    """Run a program; show what it says if it fails."""
    command = [str(word) for word in words]
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
    if check and ran.returncode != 0:
        sys.stderr.write(ran.stdout + ran.stderr)
        sys.exit(f"package: error: {shown(command)} ends with status {ran.returncode}")


def shown(command: Sequence[str]) -> str:
    """The beginning of a command, for a message."""
    return " ".join(command[:6])


def move(made: Path, target: Path) -> None:
    """Put a finished file in place in one step."""
    beside = target.with_name(f".{target.name}.new")
    shutil.copy(made, beside)
    beside.replace(target)


if __name__ == "__main__":
    main()
