"""The log library needs no ROS: an instrumented program starts where there is none."""

from __future__ import annotations

import subprocess

from pytpc.base.paths import log_library

# Those of the C and C++ compilers, and the dynamic linker.
_USUAL = ("linux-vdso", "libstdc++", "libm.", "libgcc_s", "libc.", "ld-linux")


def test_the_log_library_needs_nothing_but_the_languages_own_libraries():
    ran = subprocess.run(["ldd", log_library()], capture_output=True, text=True, check=True)
    names = [line.split()[0].rsplit("/", 1)[-1] for line in ran.stdout.splitlines()]
    assert [name for name in names if not name.startswith(_USUAL)] == []
    assert any(name.startswith("libstdc++") for name in names)
