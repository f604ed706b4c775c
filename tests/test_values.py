"""Every public value pickles into another process and copies, and is then equal in its parts and all that it computes."""

import contextlib
import copy
import dataclasses
import doctest
import enum
import inspect
import io
import pickle
import subprocess
import sys
from functools import cache, cached_property, partial
from types import FunctionType, MappingProxyType

import numpy as np
import pandas as pd
import pytest
import sympy as sp
from ipywidgets import Widget

from percept_obs.site.pages import public

KINDS = {
    names[0]: value
    for module in public().values()
    for names, value in module
    if inspect.isclass(value)
    and not issubclass(value, Widget)  # a lab lives in a page
    and not inspect.isabstract(value)
    and not getattr(value, "_is_protocol", False)
}
