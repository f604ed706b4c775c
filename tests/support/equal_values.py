"""Values compared in their parts and in all that they compute; as a program, those that come from another process.

It reads pickled values, and writes each with what its properties give.  Functions stand here for those of users.
"""

import inspect
import io
import math
import pickle
import sys
import warnings
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from functools import cached_property, partial
from types import MappingProxyType, MethodType

import numpy as np
from scipy.interpolate import PPoly


def swinging(time):
    """A velocity of a user's."""
    return [0.3 * math.cos(time), 0.1, 0.2]


def kept(state, sample, seconds, known):
    """A step of a user's observer, which takes the samples and keeps the rest."""
    return state if sample is None else np.array([*sample, *state[len(sample) :]])


def computed(value):
    """What the public properties of a value of ours give, or the words in which they refuse."""
    found = {}
    for name, member in inspect.getmembers_static(type(value)):
        if isinstance(member, property | cached_property) and name[0] != "_" and is_ours(type(value)):
            try:
                found[name] = getattr(value, name)
            except Exception as error:  # what a run has no truth or covariance for
                found[name] = str(error)
            if isinstance(found[name], MappingProxyType):  # by itself it does not pickle
                found[name] = dict(found[name])
            if type(found[name]).__module__.startswith("cv2"):  # nor does this
                found[name] = str(type(found[name]))
    return found


def is_ours(kind):
    return kind.__module__.startswith("percept_obs")


def difference(one, other, place="it"):
    """Where two values differ, in words; empty if nowhere."""
    if one is other:
        return ""
    if type(one) is not type(other):
        return f"{place}: a {type(other).__name__}, not a {type(one).__name__}"
    if isinstance(one, np.ndarray):
        if one.flags.writeable != other.flags.writeable:
            return f"{place}: {'not ' * other.flags.writeable}read-only"
        same = one.dtype == other.dtype and one.shape == other.shape
        same = same and (one.tobytes() == other.tobytes() if one.dtype != object else (one == other).all())
        return "" if same else f"{place}: other numbers"
    if (mine := parts(one)) is not None:
        others = parts(other)
        if mine.keys() != others.keys():
            return f"{place}: {set(mine) ^ set(others)}"
        return next(filter(None, (difference(v, others[key], f"{place}.{key}") for key, v in mine.items())), "")
    if hasattr(one, "equals") and hasattr(one, "columns"):
        return "" if one.equals(other) else f"{place}: another table"
    same = one == other or hasattr(one, "get_figure")  # parts of a figure are compared in its picture
    return "" if same is True or pickle.dumps(one) == pickle.dumps(other) else f"{place}: {other!r}, not {one!r}"


def parts(value):
    """What a value is made of, by name; None if it has no parts."""
    if is_dataclass(value):
        return {field.name: getattr(value, field.name) for field in fields(value)}
    if isinstance(value, PPoly):
        return {name: getattr(value, name) for name in ("c", "x", "axis", "extrapolate")}
    if isinstance(value, BaseException):
        return vars(value) | {"args": value.args}
    if isinstance(value, Mapping):
        return dict(value)
    if isinstance(value, list | tuple):
        return dict(enumerate(value))
    if isinstance(value, partial):
        return {"func": value.func, "args": value.args, "keywords": value.keywords}
    if isinstance(value, MethodType):
        return {"func": value.__func__, "self": value.__self__}
    if hasattr(value, "savefig"):
        value.savefig(picture := io.BytesIO(), format="rgba")
        return {"picture": picture.getvalue()}
    return None


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    for text in pickle.load(sys.stdin.buffer):
        value = pickle.loads(text)
        for part in (value, computed(value)):
            pickle.dump(part, sys.stdout.buffer)
