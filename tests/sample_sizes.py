"""Sample sizes of studies: enough to notice what breaks, and all of them with ALL_SAMPLES=1."""

import os

import pytest


def sampled(few, everything):
    """The smaller number, or with the environment variable ALL_SAMPLES the larger one."""
    return everything if os.environ.get("ALL_SAMPLES") else few


def slow_but(*quick, among):
    """The names of cases as parameters, slow but for those that show the law quickly."""
    return [pytest.param(name, marks=[pytest.mark.slow] * (name not in quick)) for name in among]
