"""Relations between matrices as something that a formula is compared with."""

from collections.abc import Callable, Iterable

import sympy as sp
from sympy.core.relational import Relational

from percept_obs.checking.deciding import sizes_of, written_out
from percept_obs.checking.points import key
from percept_obs.checking.target import Line, Target, primed, relation_lines


def in_letters_of_matrices(relations: Iterable[Relational]) -> Target:
    """Relations whose matrices can be typed by their letters, "xi' = G A xi"; they are compared entry by entry.

    The inverse of a letter has entries of its own, for written out it is too long.

    Raises
    ------
    ValueError
        If a matrix is given in several forms, or is an integral: entries do not tell whether those are the same.
    """
    relations = tuple(relations)
    named = [r.lhs for r in relations if isinstance(r.lhs, sp.MatrixSymbol)]
    integrals = sp.Tuple(*relations).atoms(sp.Integral)
    if len(set(named)) < len(named) or any(isinstance(i.function, sp.MatrixExpr) for i in integrals):
        raise ValueError("matrices in several forms, or integrals of them, are not compared; name one of the formulas")
    given = sp.Tuple(*relations).atoms(sp.MatrixSymbol)
    sizes = sizes_of(*given)
    names = {m: m.name for m in given} | {m.inv(): f"{m.name}inv" for m in given if m.is_square}
    shapes = {m: [size.xreplace(sizes) for size in m.shape] for m in names}
    matrices = {m: sp.ImmutableMatrix(*shapes[m], _entry(name)) for m, name in names.items()}
    lines: list[Line] = []
    blocks = {}
    for relation in relations:
        left, right = relation.args
        if isinstance(relation, sp.Eq) and isinstance(left, sp.MatrixSymbol):
            rows = [Line(f"{primed(left.name)}, row {k}", e) for k, e in enumerate(written_out(right, matrices), 1)]
            blocks[key(left.name)] = tuple(range(len(lines), len(lines) + len(rows)))
            lines += rows
        else:
            lines += relation_lines(written_out(relation, matrices))
    return Target(tuple(lines), blocks=blocks, matrices=matrices)


def _entry(name: str) -> Callable[[int, int], sp.Symbol]:
    return lambda i, j: sp.Symbol(f"{name}_{i + 1}{j + 1}", real=True)
