"""Sample sizes of studies: enough to notice what breaks, and all of them with ALL_SAMPLES=1."""

import os


def sampled(few, everything):
    """The smaller number, or with the environment variable ALL_SAMPLES the larger one."""
    return everything if os.environ.get("ALL_SAMPLES") else few
