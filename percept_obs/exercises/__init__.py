"""Exercises of the notebooks: answers that are checked, copies for each student and for teachers, and their marks."""

from percept_obs.exercises.answers import Attempt, choose, derive, reach
from percept_obs.exercises.attempts import tally
from percept_obs.exercises.copies import COPIES, stub, students_copy
from percept_obs.exercises.graders import GRADERS
from percept_obs.exercises.individual import individual
from percept_obs.exercises.models import model_answer
from percept_obs.exercises.needs import NotInstalled, needs

__all__ = [
    "COPIES",
    "GRADERS",
    "Attempt",
    "NotInstalled",
    "choose",
    "derive",
    "individual",
    "model_answer",
    "needs",
    "reach",
    "stub",
    "students_copy",
    "tally",
]
