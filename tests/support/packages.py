"""Packages of this environment that one asks for, and a Python that finds these and no others."""

import importlib.metadata
import sys
import tomllib
from functools import cache

from places import ROOT

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]


def required(*asked, **platform):
    """What requirements bring, by their own names too: the versions asked for, by the canonical names of packages.

    This package's own requirements are those of pyproject.toml, not those that it was installed with.
    """
    from packaging.requirements import Requirement  # only here, for notebooks' kernels import this module, too
    from packaging.utils import canonicalize_name

    found, seen = {}, set()

    def add(text, extras=("",)):
        wanted = Requirement(text)
        if wanted.marker and not any(wanted.marker.evaluate({**platform, "extra": extra}) for extra in extras):
            return
        name = canonicalize_name(wanted.name)
        found.setdefault(name, wanted.specifier)
        fresh = {"", *wanted.extras} - {extra for known, extra in seen if known == name}
        seen.update((name, extra) for extra in fresh)
        if not fresh:
            return
        if name == PROJECT["name"]:
            own = [PROJECT["dependencies"], *(PROJECT["optional-dependencies"][extra] for extra in wanted.extras)]
            texts = [text for texts in own for text in texts]
        else:
            texts = importlib.metadata.requires(name) or ()
        for each in texts:
            add(each, fresh)

    for text in asked:
        add(text)
    return found


@cache
def modules():
    """Modules of this environment, and the canonical names of the packages that bring them."""
    from packaging.utils import canonicalize_name

    return {
        module: set(map(canonicalize_name, names))
        for module, names in importlib.metadata.packages_distributions().items()
    }


def outside(*asked, **platform):
    """Modules of this environment that none of the packages brings which requirements bring."""
    there = set(required(*asked, **platform))
    return {module for module, names in modules().items() if not names & there}


class Among:
    """A finder of modules that does not know some."""

    def __init__(self, finder, absent):
        self.finder, self.absent = finder, absent

    def __getattr__(self, name):
        return getattr(self.finder, name)

    def find_spec(self, name, path=None, target=None):
        return None if name.partition(".")[0] in self.absent else self.finder.find_spec(name, path, target)


def hide(absent):
    """Let modules look as if they were not installed, those too that were imported already."""
    sys.meta_path[:] = [Among(finder, absent) for finder in sys.meta_path]
    anew = {*absent, "xarray"}  # which remembers whether there was a dask
    for name in [name for name in sys.modules if name.partition(".")[0] in anew]:
        del sys.modules[name]
