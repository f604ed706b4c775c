"""Parts of a formula by their places: a place is a path of numbers of arguments."""

from collections.abc import Iterator, Sequence
from typing import Any

import sympy as sp


def at(e: Any, path: Sequence[int]) -> Any:
    """Return the part at a place of a formula."""
    for index in path:
        e = e.args[index]
    return e


def put(formula: sp.Basic, path: Sequence[int], new: sp.Basic) -> sp.Basic:
    """Return a formula with another part at a place."""
    if not path:
        return new
    args = list(formula.args)
    args[path[0]] = put(args[path[0]], path[1:], new)
    return formula.func(*args)


def place_of(part: sp.Basic, whole: sp.Basic) -> tuple[int, ...]:
    """Return the first place of a part; that of the whole if there is none."""
    paths: list[tuple[int, ...]] = [()]
    for path in paths:
        node = at(whole, path)
        if node == part:
            return path
        paths += [(*path, k) for k in range(len(node.args))]
    return ()


def term_places(
    e: sp.Basic, path: tuple[int, ...] = (), is_term: bool = True
) -> Iterator[tuple[tuple[int, ...], sp.Expr]]:
    """Yield the places of all terms and sums outside of functions."""
    if is_term or e.is_Add:
        yield path, e
    if e.is_Add or e.is_Mul:
        for k, part in enumerate(e.args):
            yield from term_places(part, (*path, k), bool(e.is_Add))


def aligned(mine: sp.Basic, true: sp.Basic) -> tuple[tuple[int, ...], sp.Basic, sp.Basic]:
    """Return the only part in which two formulas differ: its place, my part, the true part."""
    if mine.func != true.func or not mine.args:
        return (), mine, true
    left = [k for k, part in enumerate(mine.args) if part not in true.args]
    right = [part for part in true.args if part not in mine.args]
    if not (mine.is_Add or mine.is_Mul) and len(mine.args) == len(true.args):
        left = [k for k, (a, b) in enumerate(zip(mine.args, true.args, strict=True)) if a != b]
        right = [true.args[k] for k in left]
    if len(left) != 1 or len(right) != 1:
        return (), mine, true
    path, a, b = aligned(mine.args[left[0]], right[0])
    return (left[0], *path), a, b


def leaves_apart(mine: sp.Basic, true: sp.Basic) -> list[tuple[sp.Basic, sp.Basic]]:
    """Return the letters, numbers and terms in which two formulas differ, mine and the true ones."""
    if mine == true:
        return []
    left = [part for part in mine.args if part not in true.args]
    right = [part for part in true.args if part not in mine.args]
    if mine.func != true.func or not mine.args or len(left) != len(right):
        return [(mine, true)]
    return [pair for a, b in zip(left, right, strict=True) for pair in leaves_apart(a, b)]
