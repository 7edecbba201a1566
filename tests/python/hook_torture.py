"""Runs test files of the standard library, with every comparison in them reporting, or plain.

    python hook_torture.py [--plain] ROOT NAME...

Instrumented are the test files and those modules of the library that are written in Python and that
they are about. Prints a JSON object: test file -> [run, failed, errors, skipped], and "reports".
"""

from __future__ import annotations

import ast
import importlib
import importlib.machinery
import json
import os
import sys
import unittest
from pathlib import Path

MODULES = (
    "_pydecimal", "bisect", "calendar", "configparser", "contextlib", "copy", "csv", "dataclasses",
    "difflib", "fractions", "graphlib", "heapq", "html.parser", "ipaddress", "json.decoder",
    "json.encoder", "json.scanner", "numbers", "queue", "random", "sched", "shlex", "statistics",
    "string", "textwrap",
)  # fmt: skip


class Loader(importlib.machinery.SourceFileLoader):
    """Rewrites every comparison."""

    def get_code(self, fullname):
        # Not there in a plain run.
        from hook_places import comparisons  # noqa: PLC0415

        from pytpc.python_runtime.rewrite import rewrite  # noqa: PLC0415
        from pytpc.python_runtime.sites import Reported  # noqa: PLC0415

        path = self.get_filename(fullname)
        data = self.get_data(path)
        listed = tuple(comparisons(ast.parse(data)))
        rewritten = rewrite(data, path, listed, lambda place: Reported("key", 1, place.swapped))
        assert not rewritten.missing, rewritten.missing
        assert rewritten.instrumented == len(listed)
        return rewritten.code


class Finder:
    """Finds what is to be instrumented."""

    @staticmethod
    def find_spec(fullname, path=None, target=None):
        if not fullname.startswith("test.test_") and fullname not in MODULES:
            return None
        # setuptools has a finder of its own for the tests of distutils.
        others = (finder for finder in sys.meta_path if finder.find_spec is not Finder.find_spec)
        specs = (finder.find_spec(fullname, path, target) for finder in others)
        spec = next((spec for spec in specs if spec is not None), None)
        if spec is not None and type(spec.loader) is importlib.machinery.SourceFileLoader:
            spec.loader = Loader(fullname, spec.origin)
        return spec


def main(words):
    reports = [0]
    if words[0] == "--plain":
        words.pop(0)
    else:
        sys.path.insert(0, words[0])
        from pytpc.python_runtime import quiet, sites  # noqa: PLC0415

        def take(*_):
            reports[0] += 1

        sites.set_take(take)
        quiet.watch()
        sys.meta_path.insert(0, Finder())
        for name in MODULES:
            if name in sys.modules:
                importlib.reload(sys.modules[name])
    answer = {}
    for name in words[1:]:
        suite = unittest.defaultTestLoader.loadTestsFromName(f"test.{name}")
        with Path(os.devnull).open("w") as nowhere:
            result = unittest.TextTestRunner(stream=nowhere).run(suite)
        failed = [str(case) for case, _ in [*result.failures, *result.errors]]
        answer[name] = [result.testsRun, sorted(failed), len(result.skipped)]
    answer["reports"] = reports[0]
    print(json.dumps(answer))


if __name__ == "__main__":
    main(sys.argv[1:])
