"""What a camera's owner gets wrong: each mistake as an experiment, and the one that explains the samples."""

from percept_obs.studies.diagnosis.diagnose import Diagnosis, Finding, diagnose
from percept_obs.studies.diagnosis.explaining import explain

__all__ = ["Diagnosis", "Finding", "diagnose", "explain"]
