"""The desk in JupyterLab: what is typed reaches the kernel, and its answer is shown."""

import pytest
from jupyter_harness import jupyterlab, lab_page, log_entries
from lab_browser import assert_python_has, open_lab, rested
from test_desk import RIGHT

pytestmark = [pytest.mark.browser, pytest.mark.slow]


def test_python_answers_what_is_typed(chromium, tmp_path_factory):
    folder, server_home, home = (tmp_path_factory.mktemp(name) for name in ("notebooks", "server", "browser"))
    with jupyterlab(folder, server_home) as server, lab_page(chromium, server, home) as page:
        page.set_default_timeout(15_000)
        open_lab(page, folder, lab="derivation_desk", arguments="step=6")
        page.locator('[data-control="line rate 6 y1\'"]').press_sequentially(RIGHT, delay=5)
        page.locator(".mark.right").wait_for()
        rested(page)
        assert_python_has(folder, {"typed": {"rate 6 y1'": RIGHT}})
        assert log_entries(page) == ""
