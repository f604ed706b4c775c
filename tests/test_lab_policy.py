"""The labs under the strict content policy that README states: scripts from `blob:`, inline styles, nothing else."""

import pytest
from lab_alone import DRAWN, opened, stated_policy

from percept_obs.labs import derivation_desk, observer_lab, points_lab, structure_lab

pytestmark = [pytest.mark.browser, pytest.mark.slow]

LABS = {"observer": observer_lab, "structure": structure_lab, "points": points_lab, "desk": derivation_desk}


@pytest.mark.parametrize("name", LABS)
def test_a_lab_works_under_the_policy_that_readme_states(browser, name):
    page = opened(browser, LABS[name]())
    page.wait_for_function(DRAWN)
    assert page.locator("canvas").count() + page.locator(".sheet input").count() > 2
    assert page.evaluate("window.refused") == []
    page.close()


def test_a_policy_that_forbids_blobs_is_named_in_the_lab(browser):
    page = opened(browser, observer_lab("ma2005_eq35"), stated_policy().replace(" blob:", ""))
    page.wait_for_function("() => window.refused.length")
    page.locator(".problem:not([hidden])").first.wait_for()
    assert "must allow scripts from blob:" in page.locator(".problem:not([hidden])").first.inner_text()
    page.close()
