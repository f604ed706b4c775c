"""Finds programs that some tests need, and skips or fails a test that lacks one, with how to get it."""

import os
import shutil
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
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        path = playwright.chromium.executable_path
    return path if Path(path).exists() else None


def missing(need, advice):
    """Skip a test that needs something which is not here, or fail it where PERCEPT_OBS_MUST_RUN names the need.

    The variable holds words separated by spaces: utias, node, chromium, firefox, lighthouse, or a front end's module.
    """
    if need in os.environ.get("PERCEPT_OBS_MUST_RUN", "").split():
        pytest.fail(advice)
    pytest.skip(advice)
