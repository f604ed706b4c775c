"""Recordings of cameras, from a simulation or from the world."""

from percept_obs.recording.camera import NO_NOISE, Camera, Gaussian, Noise, Scene, Uniform, seeded
from percept_obs.recording.conversion import seen_on
from percept_obs.recording.frames import Frames, render
from percept_obs.recording.plausibility import Unlikely
from percept_obs.recording.recording import Recording, Sighting
from percept_obs.recording.simulation import Scenario, record

__all__ = [
    "NO_NOISE",
    "Camera",
    "Frames",
    "Gaussian",
    "Noise",
    "Recording",
    "Scenario",
    "Scene",
    "Sighting",
    "Uniform",
    "Unlikely",
    "record",
    "render",
    "seeded",
    "seen_on",
]
