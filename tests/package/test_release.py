"""All parts of a release agree: versions, licences, the recipe of conda-forge, and the Pythons that are tried."""

import re
import tomllib
from importlib.util import find_spec
from itertools import chain

import yaml
from needs import missing
from packages import required
from packaging.requirements import Requirement
from places import ROOT

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
RECIPE = ROOT / ".github/recipe.yaml"
CALLED_BY_CONDA = {"matplotlib": "matplotlib-base"}


def parts(requirement):
    """Name and versions of a requirement, in conda's words."""
    name, versions = re.fullmatch(r"([\w-]+) ?(.*)", requirement).groups()
    return CALLED_BY_CONDA.get(name, name), versions


def test_one_version_everywhere():
    version = PROJECT["version"]
    assert f"\nversion: {version}\n" in (ROOT / "CITATION.cff").read_text("utf-8")
    assert f'\n  version: "{version}"\n' in RECIPE.read_text("utf-8")


def test_the_recipe_asks_for_what_the_package_asks_for():
    recipe = yaml.safe_load(RECIPE.read_text("utf-8"))
    assert f">={recipe['context']['python_min']}" == PROJECT["requires-python"]
    python, *run = recipe["requirements"]["run"]
    assert python == "python >=${{ python_min }}"
    assert dict(map(parts, run)) == dict(map(parts, PROJECT["dependencies"]))
    assert recipe["build"]["python"]["entry_points"] == [f"{k} = {v}" for k, v in PROJECT["scripts"].items()]
    assert recipe["about"]["summary"] == PROJECT["description"]


def test_the_recipe_is_one():
    """rattler-build, where it is installed, reads and renders it."""
    if find_spec("rattler_build") is None:
        missing("rattler-build", "rattler-build is missing; get it with: python -m pip install py-rattler-build")
    import rattler_build as build

    (rendered,) = build.Stage0Recipe.from_file(str(RECIPE)).render(build.VariantConfig())
    assert rendered.recipe.to_dict()["package"] == {"name": "percept-obs", "version": PROJECT["version"]}


def test_both_licences_are_shipped_and_named():
    about = yaml.safe_load(RECIPE.read_text("utf-8"))["about"]
    assert (about["license"], about["license_file"]) == (PROJECT["license"], PROJECT["license-files"])
    texts = [(ROOT / name).read_text("utf-8") for name in PROJECT["license-files"]]
    assert PROJECT["license"] == "MIT AND CC-BY-4.0"
    assert "MIT License" in texts[0]
    assert "Section 8 -- Interpretation." in texts[1], "the whole text of the licence"


def test_every_python_that_is_named_is_tried():
    workflow = yaml.safe_load((ROOT / ".github/workflows/tests.yml").read_text("utf-8"))
    matrices = [job["strategy"]["matrix"] for job in workflow["jobs"].values()]
    tried = {one["python"] for matrix in matrices for one in matrix["include"]} | set(matrices[0]["python"])
    named = [re.fullmatch(r"Programming Language :: Python :: (3\.\d+)", each) for each in PROJECT["classifiers"]]
    assert tried == {each[1] for each in named if each}


def test_binder_pins_all_that_the_course_brings_besides_its_own_jupyterlab():
    lines = (ROOT / "binder/requirements.txt").read_text("utf-8").splitlines()
    pinned = {each.name: each.specifier for each in map(Requirement, (line for line in lines if line[0] != "#"))}
    others = {"percept-obs", "pytz"} | required("jupyterlab", "ipywidgets").keys()  # only pandas 2 asks for pytz
    assert required("percept-obs[course]").keys() - others - pinned.keys() == set()
    own = map(Requirement, chain(PROJECT["dependencies"], *PROJECT["optional-dependencies"].values()))
    for each in (each for each in own if each.name in pinned):  # what others ask for changes with their versions
        (version,) = pinned[each.name]
        assert version.version in each.specifier, each.name
