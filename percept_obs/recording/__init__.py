"""Recordings: what a camera leaves behind, from a simulation or from the world."""

from percept_obs.recording.camera import NO_NOISE, Camera, Gaussian, Noise, Scene, Seed, Uniform, seeded
from percept_obs.recording.grid import halves, step_grid
from percept_obs.recording.recording import Recording, Sighting
from percept_obs.recording.simulation import PLANT_STEP, Scenario, record

__all__ = [
    "NO_NOISE",
    "PLANT_STEP",
    "Camera",
    "Gaussian",
    "Noise",
    "Recording",
    "Scenario",
    "Scene",
    "Seed",
    "Sighting",
    "Uniform",
    "halves",
    "record",
    "seeded",
    "step_grid",
]
