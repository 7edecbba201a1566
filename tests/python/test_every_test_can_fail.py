"""A test that cannot fail is a defect: each asserts something, by itself or through a helper."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

TESTS = Path(__file__).parents[1]
# Of pytest, selenium and the product: they raise when what they are asked for is not so.
JUDGES = {"check_rules", "fail", "raises", "until", "warns"}


def called(function: ast.AST) -> set[str]:
    """Names of what a function calls, also as `with` and by the fixtures that it takes."""
    names = {
        node.func.attr if isinstance(node.func, ast.Attribute) else node.func.id
        for node in ast.walk(function)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute | ast.Name)
    }
    if isinstance(function, ast.FunctionDef):
        names |= {argument.arg for argument in function.args.args}
    return names


def functions(tree: ast.Module) -> Iterator[ast.FunctionDef]:
    return (node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef))


def cannot_fail(texts: dict[str, str]) -> list[str]:
    """The tests of these files that assert nothing: `file::test`."""
    trees = {name: ast.parse(text) for name, text in texts.items()}
    every = [(name, function) for name, tree in trees.items() for function in functions(tree)]
    calls = {id(function): called(function) for _, function in every}
    judges = set(JUDGES)
    judging: set[int] = set()
    before = -1
    while before != len(judging):
        before = len(judging)
        for _, function in every:
            asserts = any(isinstance(node, ast.Assert) for node in ast.walk(function))
            if asserts or calls[id(function)] & judges:
                judging.add(id(function))
                judges.add(function.name)
    return [
        f"{name}::{function.name}"
        for name, function in every
        if Path(name).name.startswith("test_") and function.name.startswith("test_")
        if id(function) not in judging
    ]


def test_each_test_of_this_project_can_fail():
    files = [path for path in TESTS.rglob("*.py") if "workspaces" not in path.parts]
    assert len(files) > 150
    assert cannot_fail({str(path): path.read_text("utf-8") for path in files}) == []


@pytest.mark.parametrize(
    ("body", "found"),
    [
        ("assert works()", []),
        ("works()", ["test_it.py::test_it"]),
        ("with pytest.raises(ValueError):\n        works()", []),
        ("judge(works())", []),
        ("judge_later(works())", []),
        ("print(works())", ["test_it.py::test_it"]),
    ],
)
def test_what_counts_as_asserting(body, found):
    helpers = "def judge(one):\n    assert one\ndef judge_later(one):\n    judge(one)\n"
    text = f"def test_it():\n    {body}\n"
    assert cannot_fail({"helpers.py": helpers, "test_it.py": text}) == found


def test_a_fixture_may_judge():
    fixture = "@pytest.fixture\ndef whole():\n    yield\n    assert nothing_left()\n"
    test = "def test_it(whole):\n    works()\n"
    assert cannot_fail({"conftest.py": fixture, "test_it.py": test}) == []
