"""Targets of relations as a paper prints them, in letters of matrices."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import sympy as sp
from sympy.core.relational import Relational

from percept_obs.checking.deciding import entries_of
from percept_obs.checking.lines import Line, primed, relation_lines
from percept_obs.checking.matrices import in_entries
from percept_obs.checking.points import key
from percept_obs.checking.target import Target


def matrix_target(relations: Iterable[Relational]) -> Target:
    """Return a target whose matrices can be typed by their letters, "xi' = G A xi", and are compared entry by entry.

    The inverse of a letter has entries of its own, for written out it is too long.  A matrix in several forms may be
    typed in each of them.  Bounds of matrices are compared as quadratic forms, and integrals as they stand.
    """
    relations = tuple(relations)
    symbols = sp.Tuple(*relations).atoms(sp.MatrixSymbol)
    sizes = _sizes(relations, symbols)
    names = {m: m.name for m in symbols} | {m.inv(): f"{m.name}inv" for m in symbols if m.is_square}
    matrices: dict[sp.Basic, Any] = sizes | {
        m: entries_of(m.xreplace(sizes), "{}_{}{}", 1, name) for m, name in names.items()
    }
    for identity in sp.Tuple(*relations).atoms(sp.Identity):
        matrices |= {sp.MatrixSymbol("I", *identity.shape): sp.ImmutableMatrix(sp.eye(identity.rows.xreplace(sizes)))}
    lines: list[Line] = []
    blocks: dict[str, tuple[int, ...]] = {}
    for relation in relations:
        left, right = relation.args
        if isinstance(relation, sp.Eq) and isinstance(left, sp.MatrixSymbol):
            entries = in_entries(right, matrices)
            columns = getattr(entries, "cols", 1)
            places = [
                f"entry ({k // columns + 1}, {k % columns + 1})" if columns > 1 else f"row {k + 1}"
                for k in range(len(entries))
            ]
            rows = [Line(f"{primed(left.name)}, {place}", e) for place, e in zip(places, entries, strict=True)]
            name = key(left.name)
            blocks[f"{name}, another form" if name in blocks else name] = tuple(
                range(len(lines), len(lines) + len(rows))
            )
            lines += rows
        else:
            lines += relation_lines(in_entries(relation, matrices))
    # w_cross = [0, -w3, w2; ...] says what its letter is
    named = [relation.lhs.name for relation in relations if isinstance(relation.lhs, sp.MatrixSymbol)]
    defines = len(named) == len(relations) and not any(name.endswith("dot") for name in named)
    return Target(tuple(lines), blocks=blocks, matrices=matrices, defines=defines)


def _sizes(relations: Iterable[Relational], symbols: Iterable[sp.MatrixSymbol]) -> dict[sp.Symbol, sp.Integer]:
    """Return numbers for letters that are sizes: what written-out matrices ask, else 2 or 3; 1 for p of 2p, 3p."""
    shapes = [size for m in symbols for size in m.shape]
    letters = sorted({s for size in shapes for s in size.free_symbols}, key=str, reverse=True)
    asked = {}
    for one, other in (relation.args for relation in relations):
        for a, b in zip(getattr(one, "shape", ()), getattr(other, "shape", ()), strict=False):
            gap = sp.sympify(a - b)
            if len(gap.free_symbols) == 1:
                (letter,) = gap.free_symbols
                asked[letter] = sp.Integer(-gap.subs(letter, 0) / gap.coeff(letter))
    alone = [s for s in letters if s in shapes]
    numbers = dict.fromkeys(letters, sp.S.One) | {s: sp.Integer(2 + k % 2) for k, s in enumerate(alone)}
    return numbers | {s: size for s, size in asked.items() if size > 0}
