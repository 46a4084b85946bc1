"""The examples in the docstrings and in the conventions run."""

import doctest

import pytest

from house.rooms import PROJECT, load, module_names


@pytest.mark.parametrize("name", module_names())
def test_examples_of_a_module(name):
    failed, _ = doctest.testmod(load(name))
    assert failed == 0


def test_examples_of_the_conventions():
    failed, tried = doctest.testfile(str(PROJECT / "CONVENTIONS.md"), module_relative=False)
    assert tried > 5
    assert failed == 0


def test_a_wrong_example_fails(tmp_path):
    (tmp_path / "wrong.md").write_text(">>> 1 + 1\n3\n")
    failed, _ = doctest.testfile(str(tmp_path / "wrong.md"), module_relative=False, verbose=False)
    assert failed == 1
