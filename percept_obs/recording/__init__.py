"""Recordings: what a camera leaves behind, from a simulation or from the world."""

from percept_obs.recording.recording import Recording, halves, step_grid
from percept_obs.recording.simulation import (
    NO_NOISE,
    PLANT_STEP,
    Camera,
    Gaussian,
    Noise,
    Scenario,
    Seed,
    Uniform,
    record,
    seeded,
)

__all__ = [
    "NO_NOISE",
    "PLANT_STEP",
    "Camera",
    "Gaussian",
    "Noise",
    "Recording",
    "Scenario",
    "Seed",
    "Uniform",
    "halves",
    "record",
    "seeded",
    "step_grid",
]
