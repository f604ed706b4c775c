"""JupyterLite beside the site holds what it needs; pages of notebooks lead to it and say where Python comes from."""

import json
import re
import subprocess
import sys
from zipfile import ZipFile

import jinja2
import pytest
from lab_settings import FRONT
from needs import missing
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from places import NOTEBOOKS, SUPPORT
from test_browser_python import BUILT_FOR_PYODIDE, IN_PYODIDE

import percept_obs
from percept_obs.exercises.models import notebooks
from percept_obs.site import SiteFault, _texts, lite
from percept_obs.validation import needed


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """The JupyterLite of all notebooks."""
    target = tmp_path_factory.mktemp("site")
    try:
        needed("lite", *lite.NEEDS)
    except ModuleNotFoundError as error:
        pytest.skip(str(error))
    lite.write_lite(target, notebooks())
    return target / "lite"


@pytest.mark.slow
def test_it_holds_every_notebook_with_a_cell_that_installs(built):
    assert {path.name for path in (built / "files").iterdir()} == set(notebooks())
    listed = json.loads((built / "api/contents/all.json").read_bytes())["content"]
    assert {entry["name"] for entry in listed} == set(notebooks())
    for name, original in notebooks().items():
        cells = json.loads((built / "files" / name).read_bytes())["cells"]
        note, install = cells[1:3]
        assert lite.PLACES["servers"] in note["source"]
        assert "%pip install -q percept-obs" in install["source"]
        assert ("reads films" in note["source"]) is name.startswith("16")
        assert [cells[0], *cells[3:]] == original["cells"]


@pytest.mark.slow
def test_what_stands_beside_is_what_is_installed_here(built):
    index = json.loads((built / "pypi/all.json").read_bytes())
    assert set(index) == {canonicalize_name(name) for name in ("percept_obs", *lite.BESIDE)}
    settings = json.loads((built / "jupyter-lite.json").read_bytes())["jupyter-config-data"]
    assert {each["name"] for each in settings["federated_extensions"]} == set(lite.EXTENSIONS)
    assert "./pypi/all.json" in json.dumps(settings["litePluginSettings"])
    for wheel in (built / "pypi").glob("*.whl"):
        names = ZipFile(wheel).namelist()
        assert not [name for name in names if re.search(r"\.(so|pyd|pyc)$|^/|\.\.", name)]
        assert [name for name in names if name.endswith(".dist-info/METADATA")]
    (own,) = (built / "pypi").glob("percept_obs-*.whl")
    assert f"percept_obs-{percept_obs.__version__}.dist-info/METADATA" in ZipFile(own).namelist()
    assert {f"percept_obs/notebooks/{path.name}" for path in NOTEBOOKS.glob("*.ipynb")} <= set(ZipFile(own).namelist())


@pytest.mark.slow
def test_it_is_small(built):
    size = sum(path.stat().st_size for path in built.rglob("*") if path.is_file())
    print(f"{size / 1e6:.1f} MB in {sum(path.is_file() for path in built.rglob('*'))} files")
    assert size < 40e6


def test_a_package_that_is_packed_again_can_be_installed(tmp_path):
    lite.pack("lark", tmp_path)
    (wheel,) = tmp_path.iterdir()
    install = ["pip", "install", "--quiet", "--no-deps", "--no-index", "--target"]
    subprocess.run([sys.executable, "-m", *install, tmp_path / "new", wheel], check=True)
    assert (tmp_path / "new" / "lark" / "grammars" / "python.lark").exists()


def test_what_cannot_be_built_is_said(tmp_path):
    with pytest.raises(SiteFault, match="extension no/such is in none of the folders"):
        lite._extension("no/such")
    with pytest.raises(SiteFault, match="No module named no_such_module"):
        lite._run("no_such_module", at=tmp_path)


@pytest.mark.parametrize("page", ["notebooks/02_two_observers", "notebooks/index", "guide"])
def test_the_page_of_a_notebook_leads_to_it_and_says_where_python_comes_from(page):
    theme = {"!page.html": "{% block content %}{% endblock %}{% block footer %}{% endblock %}"}
    template = jinja2.Environment(loader=jinja2.DictLoader(theme)).from_string(
        dict(_texts(False))["_templates/page.html"]
    )
    given = {"pagename": page, "pathto": lambda file, resource: f"../{file}"}
    shown, without = template.render(given, python=lite.PLACES), template.render(given, python={})
    assert "lab/index.html" not in without
    if page == "notebooks/02_two_observers":
        assert '<a href="../lite/lab/index.html?path=02_two_observers.ipynb">Run this notebook</a>' in shown
        assert "come from public servers (cdn.jsdelivr.net, pypi.org)" in shown
    else:
        assert shown == without
    fields = template.render(given, fields=True)
    assert ("exercises.js" in fields) is page.startswith("notebooks/0")
    assert "exercises.js" not in without


def test_what_the_notebooks_import_is_installed():
    own, other = map(Requirement, lite.INSTALL.splitlines()[0].split()[3:])
    assert (own.name, own.extras, other.name) == ("percept-obs", {"data", "filters"}, "xarray")
    text = json.dumps(notebooks())
    assert all(re.search(rf"(from|import) {module}\b", text) for module in ("filterpy", "pandas", "xarray"))


@pytest.mark.slow
@pytest.mark.node
def test_the_wheel_is_read_by_pyodide_s_python(node, tmp_path):
    core = FRONT / "node_modules" / "pyodide"
    if not core.exists():
        missing("pyodide", f"Pyodide is missing; get it with: npm install --no-save pyodide@314.0.6, in {FRONT}")
    has = json.loads((core / "pyodide-lock.json").read_bytes())["packages"]
    assert set(has) >= {*IN_PYODIDE, "pyodide-http"}
    assert {name: has[name]["version"] for name in BUILT_FOR_PYODIDE} == BUILT_FOR_PYODIDE
    for name in ("sympy", "mpmath"):
        lite.pack(name, tmp_path)
    lite.write_own_wheel(tmp_path)
    command = [node, SUPPORT / "on_pyodide.mjs", core, *tmp_path.iterdir()]
    answer = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    print(answer)
    assert answer["compiled"] > 250
