"""Docstrings of public functions are numpydoc: all parameters, returns and errors described, examples that run."""

from __future__ import annotations

import doctest
import importlib
import inspect

import pytest

import symrender as sr

STUDIES = ("anchor", "budget", "convergence", "pitfalls", "timing", "weights")
NAMES = [
    *(f"symrender.{name}" for name in sr.__all__ if inspect.isfunction(getattr(sr, name))),
    *(f"symrender.studies.{name}.{name}" for name in STUDIES),
]
CHECKS = {"GL03", "GL07", "GL08", "SS01", "SS03", "SS05", "PR01", "PR02", "PR03", "PR04", "PR07", "PR08", "PR09"}
CHECKS |= {"PR10", "RT01", "RT03", "RT04", "RT05", "YD01"}
"""numpydoc's checks: sections in order, a summary with an infinitive, every parameter with type and description."""
RUN = ("truth", "render", "probe", "gradient", "hessian", "compare", "load", "export", "expression")
"""Functions whose examples take seconds at most; those of fit and audit are on pages that run."""


def function(name: str) -> object:
    module, _, attribute = name.rpartition(".")
    return getattr(importlib.import_module(module), attribute)


def test_there_are_public_functions() -> None:
    assert len(NAMES) >= 20
    assert {name.rpartition(".")[2] for name in NAMES} >= {*RUN, "fit", "audit", "simulator"}


@pytest.mark.parametrize("name", NAMES)
def test_a_docstring_is_numpydoc(name: str) -> None:
    validate = pytest.importorskip("numpydoc.validate")
    found = function(name)
    assert inspect.isfunction(found)
    errors = validate.validate(f"{found.__module__}.{found.__qualname__}")["errors"]
    assert not [f"{code}: {message}" for code, message in errors if code in CHECKS]


@pytest.mark.parametrize("name", RUN)
def test_examples_run(name: str) -> None:
    found = getattr(sr, name)
    test = doctest.DocTestFinder(recurse=False).find(found, name, module=False, globs={})[0]
    assert test.examples
    assert doctest.DocTestRunner().run(test).failed == 0
