"""Widths of windows, from a telephone to a large screen, and the law that a page keeps at each."""

from sample_sizes import sampled

WIDTHS = sampled((360, 768, 1024, 1920), (360, 390, 768, 1024, 1280, 1440, 1920))


def assert_fits(page, name, drawers=True):
    """Hold the law at all widths, in the drawers of labs too if asked, and return the number of controls reached."""
    looked = 0
    for width in WIDTHS:
        page.set_viewport_size({"width": width, "height": 800})
        found = page.evaluate("(drawers) => tests.fits(drawers)", drawers)
        assert found["wrong"] == [], f"{name}, {width} px wide: {found['wrong']}"
        looked += found["looked"]
    return looked
