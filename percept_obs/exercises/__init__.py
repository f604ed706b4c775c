"""Exercises of the notebooks: answers that are checked, and copies for students and for teachers."""

from percept_obs.exercises.answers import Attempt, choose, derive, reach
from percept_obs.exercises.copies import COPIES, stub, students_copy

__all__ = ["COPIES", "Attempt", "choose", "derive", "reach", "stub", "students_copy"]
