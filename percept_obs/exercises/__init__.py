"""Exercises of the notebooks: answers that are checked, copies for each student and for teachers, and their marks."""

from percept_obs.exercises.answers import Attempt, choose, derive, reach
from percept_obs.exercises.attempts import tally
from percept_obs.exercises.copies import COPIES, stub, students_copy
from percept_obs.exercises.graders import GRADERS, nbgrader_copy, otter_copy
from percept_obs.exercises.individual import individual
from percept_obs.exercises.models import model_answer

__all__ = [
    "COPIES",
    "GRADERS",
    "Attempt",
    "choose",
    "derive",
    "individual",
    "model_answer",
    "nbgrader_copy",
    "otter_copy",
    "reach",
    "stub",
    "students_copy",
    "tally",
]
