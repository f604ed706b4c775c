"""Diagnosis of recordings: the usual mistakes with a camera, and the ones that explain the samples."""

from percept_obs.studies.diagnosis.diagnose import Diagnosis, Finding, diagnose

__all__ = ["Diagnosis", "Finding", "diagnose"]
