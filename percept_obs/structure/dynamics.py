"""Dynamics of the scaled inverse depth, and the symbols of all choices."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import sympy as sp

from percept_obs.system.motion import rigid
from percept_obs.system.perspective import PerspectiveSystem
from percept_obs.system.surfaces import pinhole

y1, y2, ybar3 = OUTPUTS = sp.symbols("y1 y2 ybar3", real=True)
d_s = sp.Symbol("d_s", real=True)
ROTATION, CAMERA, OBJECT = (rigid().parameters[k : k + 3] for k in (0, 3, 6))


@dataclass(frozen=True)
class ScaledDynamics:
    """Rate of ybar = (y1, y2, ybar3), with ybar3 = y3 / d_s (Chwa 2019, (5)-(7), p. 4).

        ybar' = Omega1 v_c d_s + Omega2 + Omega3 v_p d_s

    The matrices are `camera` for Omega1, `rotation` for that which multiplies w_c in Omega2 (Chwa's w is
    -w_c), and `object` for Omega3.
    """

    camera: sp.ImmutableMatrix
    rotation: sp.ImmutableMatrix
    object: sp.ImmutableMatrix

    @property
    def rate(self) -> sp.ImmutableMatrix:
        """Time derivative of ybar."""
        translation = self.camera * sp.ImmutableMatrix(CAMERA) + self.object * sp.ImmutableMatrix(OBJECT)
        return (self.rotation * sp.ImmutableMatrix(ROTATION) + d_s * translation).expand()

    def _repr_latex_(self) -> str:
        names = (r"\Omega_1", r"\Omega_2 = \Omega_w w_c,\quad \Omega_w", r"\Omega_3")
        matrices = map(sp.latex, (self.camera, self.rotation, self.object))
        return r"$\displaystyle " + r",\quad ".join(map(" = ".join, zip(names, matrices, strict=True))) + "$"


@lru_cache(maxsize=1)
def scaled_dynamics() -> ScaledDynamics:
    """Return the dynamics of the scaled inverse depth, from a rigid motion seen by a pinhole.

    See Also
    --------
    percept_obs.StructureAndMotion : Divides it by what is known.

    Examples
    --------
    >>> from percept_obs.structure import scaled_dynamics
    >>> scaled_dynamics().rate[2]
    d_s*v_c3*ybar3**2 - d_s*v_p3*ybar3**2 + w_c1*y2*ybar3 - w_c2*y1*ybar3
    """
    system = PerspectiveSystem(rigid(), pinhole())
    inverse_depth = system.coordinates[-1]
    scale = sp.diag(1, 1, 1 / d_s)
    rate = (scale * system.rate.subs(inverse_depth, d_s * ybar3)).expand()
    camera, rotation, object_ = (rate.jacobian(symbols) for symbols in (CAMERA, ROTATION, OBJECT))
    return ScaledDynamics((camera / d_s).expand(), rotation, (object_ / d_s).expand())
