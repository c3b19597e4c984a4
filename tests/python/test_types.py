"""The types that editors and mypy see are those that there are."""

import ast
import importlib.util
import inspect
import subprocess
import sys
from pathlib import Path

import pytest

import kappaflow
from kappaflow import _core

PACKAGE = Path(kappaflow.__file__).parent


def public(names):
    return {name for name in names if not name.startswith("_")}


def declared(body):
    """The names that a stub declares, with the bodies of its classes."""
    names = {}
    for node in body:
        if isinstance(node, ast.ClassDef):
            names[node.name] = declared(node.body)
        elif isinstance(node, ast.FunctionDef):
            names[node.name] = {}
        elif isinstance(node, ast.AnnAssign):
            names[node.target.id] = {}
    return names


def test_the_stub_declares_what_the_module_has():
    stub = declared(ast.parse((PACKAGE / "_core.pyi").read_text()).body)
    assert stub.keys() == public(vars(_core))
    for name, members in stub.items():
        if inspect.isclass(getattr(_core, name)):
            assert public(members) == public(vars(getattr(_core, name))), name


def test_mypy_finds_nothing(tmp_path):
    if importlib.util.find_spec("mypy") is None:
        pytest.skip("mypy is not installed")
    command = [sys.executable, "-m", "mypy", "--strict", "--allow-any-generics", "-p", "kappaflow", "--cache-dir", tmp_path]
    checked = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert checked.returncode == 0, checked.stdout


def test_everything_that_is_public_says_what_it_is():
    assert (PACKAGE / "py.typed").exists()
    for name in kappaflow.__all__:
        thing = getattr(kappaflow, name)
        if not inspect.isclass(thing) and not inspect.isfunction(thing):
            continue
        assert inspect.getdoc(thing), name
        if inspect.isclass(thing) and thing.__module__ != "kappaflow._core":
            undocumented = [member for member, value in vars(thing).items()
                            if not member.startswith("_") and inspect.isfunction(value) and not value.__doc__]
            assert not undocumented, name
