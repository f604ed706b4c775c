"""Sample sizes of studies: enough to notice what breaks, and all of them with ALL_SAMPLES=1."""

import os
from itertools import product

import pytest


def sampled(few, everything):
    """The smaller number, or with the environment variable ALL_SAMPLES the larger one."""
    return everything if os.environ.get("ALL_SAMPLES") else few


def across(*lists):
    """Cases in which each value of each list occurs once at least, or with ALL_SAMPLES all combinations."""
    few = [tuple(values[k % len(values)] for values in lists) for k in range(max(map(len, lists)))]
    return sampled(few, list(product(*lists)))


def slow_but(*quick, among):
    """The names of cases as parameters, slow but for those that show the law quickly."""
    return [pytest.param(name, marks=[pytest.mark.slow] * (name not in quick)) for name in among]
