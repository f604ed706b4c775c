"""Widths of windows, from a telephone to a large screen, and the law that a page keeps at each."""

WIDTHS = (360, 390, 768, 1024, 1280, 1440, 1920)


def assert_fits(page, name):
    """Hold the law at all widths, and return the number of controls that were reached."""
    looked = 0
    for width in WIDTHS:
        page.set_viewport_size({"width": width, "height": 800})
        found = page.evaluate("tests.fits()")
        assert found["wrong"] == [], f"{name}, {width} px wide: {found['wrong']}"
        looked += found["looked"]
    return looked
