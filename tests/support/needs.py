"""Finds programs that some tests need, and skips or fails a test that lacks one, with how to get it."""

import os
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

BROWSERS = (
    "chromium-headless-shell",  # the same engine without windows: two thirds of the time
    "chromium",
    "chromium-browser",
    "google-chrome",
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    "/Applications/Chromium.app/Contents/MacOS/Chromium",
    r"C:\Program Files\Google\Chrome\Application\chrome.exe",
)


def found_chromium():
    """The path of Chromium or Chrome, if there is one."""
    return next(filter(None, map(shutil.which, BROWSERS)), None) or playwright_chromium()


def playwright_chromium():
    import browsers  # which looks here

    with browsers.playwright() as playwright:
        path = playwright.chromium.executable_path
    return path if Path(path).exists() else None


@cache
def playwright_lacks():
    """Why Playwright's own Node.js does not start, in its last words; empty where it does."""
    said = subprocess.run([sys.executable, "-m", "playwright", "--version"], capture_output=True, text=True)
    return (said.stderr.strip() or f"it ends with {said.returncode}").rpartition("\n")[2] if said.returncode else ""


def missing(need, advice):
    """Skip a test that needs something which is not here, or fail it where PERCEPT_OBS_MUST_RUN names the need.

    The variable holds words separated by spaces, such as utias, node, chromium, or the module of a front end.
    """
    if need in os.environ.get("PERCEPT_OBS_MUST_RUN", "").split():
        pytest.fail(advice)
    pytest.skip(advice)
