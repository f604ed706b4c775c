"""Diagnosis of recordings: the usual mistakes with a camera, and the one that explains the samples."""

from percept_obs.studies.diagnosis.diagnose import Diagnosis, Finding, diagnose
from percept_obs.studies.diagnosis.explaining import explain

__all__ = ["Diagnosis", "Finding", "diagnose", "explain"]
