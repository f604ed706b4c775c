"""Which of the cases that Chwa (2019) states a choice is; the laws of choices and the page are held against it."""

from dataclasses import replace
from itertools import permutations

from percept_obs.structure import COROLLARIES


def corollary_of(choice):
    """The corollary that states a choice, with its axes in any order; None for a choice that the paper does not state.

    Whether the known camera's velocity was estimated earlier makes no difference, unlike d_s.
    """
    return STATED.get(pattern(choice))


def pattern(case):
    return replace(case, earlier=tuple(n for n in case.earlier if n == "d_s"), scale=None)


STATED = {
    pattern(corollary.choice("".join(axes))): corollary
    for corollary in reversed(COROLLARIES)  # the first of two with the same pattern counts
    for axes in permutations("123")
}
