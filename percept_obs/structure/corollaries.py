"""Corollaries of Chwa (2019), as choices of known and unknown quantities."""

from __future__ import annotations

from dataclasses import dataclass

from percept_obs.structure.choice import StructureAndMotion
from percept_obs.validation import checked


@checked
@dataclass(frozen=True)
class Corollary:
    """Corollary of the paper (Chwa 2019, sections IV to VI, pp. 6-9).

    Parameters
    ----------
    number : int
    section : str
    camera, object : str
        Motions of the camera and the object, its cell of Table 1.
    unknown, zero, earlier : tuples of str
        As in `StructureAndMotion`, with the axes i, j, k for 1, 2, 3.

    See Also
    --------
    percept_obs.StructureAndMotion : The choice of unknowns that it makes.

    Examples
    --------
    >>> from percept_obs.structure import COROLLARIES
    >>> print(COROLLARIES[0])
    corollary 1, section IV.A: dynamic camera, object in semigeneral motion
    >>> COROLLARIES[0].choice("123").unknown
    ('d_s', 'v_c2', 'v_c3')
    """

    number: int
    section: str
    camera: str
    object: str
    unknown: tuple[str, ...]
    zero: tuple[str, ...] = ()
    earlier: tuple[str, ...] = ()

    def choice(self, axes: str = "123", scale: float | None = None) -> StructureAndMotion:
        """Choice of the corollary with the axes i, j, k in the given order, "123" in the paper's section VII."""
        if sorted(axes) != ["1", "2", "3"]:
            raise ValueError(f"the axes {axes!r} must be 1, 2 and 3 in some order")
        order = str.maketrans("ijk", axes)
        unknown, zero, earlier = (
            tuple(name.translate(order) for name in group) for group in (self.unknown, self.zero, self.earlier)
        )
        return StructureAndMotion(unknown, zero, earlier, scale)

    def __str__(self) -> str:
        return f"corollary {self.number}, section {self.section}: {self.camera} camera, object in {self.object} motion"


_STILL = ("v_pi", "v_pj", "v_pk")
_DYNAMIC, _GENERAL = "dynamic", "general"

COROLLARIES = (
    Corollary(1, "IV.A", _DYNAMIC, "semigeneral", ("d_s", "v_cj", "v_ck"), zero=_STILL),
    Corollary(2, "IV.B", _DYNAMIC, "semigeneral", _STILL, earlier=("d_s", "v_cj", "v_ck")),
    Corollary(3, "V.A", _DYNAMIC, _GENERAL, ("d_s", "v_pi", "v_pj"), zero=("v_pk",)),
    Corollary(4, "V.B", _DYNAMIC, _GENERAL, ("d_s", "v_ck", "v_pi"), zero=("v_pj", "v_pk")),
    Corollary(5, "VI.A", _GENERAL, _GENERAL, _STILL),
    Corollary(6, "VI.B", _GENERAL, _GENERAL, ("v_ck", "v_pi", "v_pj"), zero=("v_pk",)),
    Corollary(7, "VI.C", _GENERAL, _GENERAL, ("v_cj", "v_ck", "v_pi"), zero=("v_pj", "v_pk")),
)
"""The seven corollaries, in the paper's order."""
