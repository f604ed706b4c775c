"""Find what is wrong with a whole line: it belongs elsewhere, or one change in all terms mends it."""

import re
from collections.abc import Iterator
from itertools import chain, combinations, takewhile

import sympy as sp

from percept_obs.checking.deciding import proportional
from percept_obs.checking.lines import INEQUALITY, VALUE
from percept_obs.checking.places import place_of, put
from percept_obs.checking.search import Search, close
from percept_obs.checking.slips import MENDS, Slip, factored, family, siblings_in, slips_in, symbols_in
from percept_obs.checking.target import Target

ANGLES = (sp.sin, sp.cos, sp.tan)
TWINS = (("v_c", "v_p"), ("y", "yhat"))
"""Letters that are mistaken for each other index by index."""

Candidate = tuple[str, sp.Basic, sp.Basic, sp.Expr]


def confusion(search: Search, row: int, target: Target) -> str:
    """Return a sentence on what a line was confused with: another line, surface, direction or unit; else ""."""
    line, mine = search.line, search.mine
    if line.kind == INEQUALITY:
        turned = proportional(mine, -line.formula, positive=True)
        return "the inequality is the other way round" if turned else ""
    if line.kind != VALUE:
        return ""
    values = search.values(mine)
    for other, sister in enumerate(target.lines):
        # a line of a step before is a step left out, which is told as such
        beside = other != row and (row not in target.result or other in target.result)
        if beside and mine.is_Add and sister.kind == VALUE and close(search.values(sister.formula), values):
            return f"this is the formula of {sister.name or f'entry {other + 1}'}"
    for surface, lines in target.elsewhere().items() if target.elsewhere else ():
        for sister in lines:
            if sister.name == line.name and close(search.values(sister.formula), values):
                return f"this is the formula of the {surface} surface"
    true = search.values(line.formula)
    if mine.has(*ANGLES):
        for factor in (sp.pi / 180, 180 / sp.pi):
            changed = mine.replace(lambda e: isinstance(e, ANGLES), lambda e, f=factor: e.func(f * e.args[0]))
            if close(search.values(changed), true):
                return "an angle is in degrees, and must be in radians"
    return ""


def change_of_all_terms(search: Search) -> Slip | None:
    """Return the change in all terms that mends a line: a transpose, signs, a letter for another, or two swapped."""
    true = search.values(search.line.formula)
    for kind, before, after, changed in takewhile(lambda _: not search.over, _changes_of_all_terms(search)):
        if close(search.values(changed), true):
            return Slip(kind, before, after, (), search.mine, changed)
    return None


def _changes_of_all_terms(search: Search) -> Iterator[Candidate]:
    mine = search.mine
    used = sorted(mine.free_symbols, key=str)
    # a transposed matrix is likelier than several wrong indices, so it is tried first
    flips = {a: b for a in used if (b := _transposed(a, search.letters))}
    if len(flips) > 1:
        yield "transpose", *next(iter(flips.items())), mine.xreplace(flips)
    for one, other in TWINS:
        here, there = _pairs(one, other, search.letters), _pairs(other, one, search.letters)
        for kind, pairs in (("twins", here | there), ("twin", here), ("twin", there)):
            if len(set(pairs) & set(used)) > (2 if pairs == here | there else 1):
                first, second = (other, one) if pairs is there else (one, other)
                yield kind, sp.Symbol(first), sp.Symbol(second), mine.xreplace(pairs)
    by_family: dict[object, list[sp.Symbol]] = {}
    for a in used:
        by_family.setdefault(family(a), []).append(a)
    for group in by_family.values():
        if len(group) > 1:
            turned = mine.xreplace({a: -a for a in group})
            yield "signs", sp.Tuple(*group), sp.Tuple(*(-a for a in group)), turned
    for a in used:
        yield "sign throughout", a, -a, mine.xreplace({a: -a})
        for b in sorted(search.letters - {a}, key=str):
            if family(a) == family(b):
                yield "throughout", a, b, mine.xreplace({a: b})
                if b in mine.free_symbols and str(a) < str(b):
                    yield "swapped", a, b, mine.xreplace({a: b, b: a})


def swap_in_a_bracket(search: Search) -> Slip | None:
    """Return the swap of two letters, or of a sine and a cosine, in one bracket that mends a line."""
    for spot in takewhile(lambda _: not search.over, search.spots):
        if not spot.node.is_Add:
            continue
        letters = sorted(spot.node.free_symbols, key=str)
        pairs: list[tuple[sp.Basic, sp.Basic]] = [(a, b) for a, b in combinations(letters, 2) if family(a) == family(b)]
        pairs += [(e, sp.cos(*e.args)) for e in spot.node.atoms(sp.sin) if spot.node.has(sp.cos(*e.args))]
        for a, b in pairs:
            node = spot.node.xreplace({a: b, b: a})
            values = search.values(node)
            if values is not None and close((values - spot.value) * spot.outer, search.lacking):
                return Slip("swapped", a, b, spot.path, spot.node, put(search.mine, spot.path, node))
    return None


def slip_in_all_copies(search: Search) -> tuple[Slip, ...]:
    """Return a slip in a part that stands in several places, as a letter of one's own does, mended in all of them."""
    siblings = siblings_in(search.letters | symbols_in(search.mine))
    true = search.values(search.line.formula)
    counts: dict[sp.Basic, int] = {}
    for node in sp.preorder_traversal(search.mine):
        if node.is_Add or node.is_Function:
            counts[node] = counts.get(node, 0) + 1
    for part in (part for part, count in counts.items() if count > 1):
        root = [Slip("replaced", part, sp.sqrt(part), (), part, sp.sqrt(part))] if part.is_Add else []
        signs = [
            Slip("sign", term, -term, (k,), term, put(part, (k,), -term))
            for k, term in enumerate(part.args if part.is_Add else ())
        ]
        for slip in takewhile(
            lambda _: not search.over, chain(root, signs, factored(part, MENDS), slips_in(part, siblings, MENDS))
        ):
            changed = search.mine.xreplace({part: slip.formula})
            if close(search.values(changed), true):
                path = place_of(part, search.mine)
                term = part if not slip.path else slip.term
                return (Slip(slip.kind, slip.before, slip.after, (*path, *slip.path), term, changed),)
    return ()


def _pairs(one: str, other: str, letters: frozenset[sp.Symbol]) -> dict[sp.Symbol, sp.Symbol]:
    """Return letters of one name by those of the other with the same index."""
    named = {s.name: s for s in letters}
    found = ((s, re.fullmatch(rf"{one}(\d*)", s.name)) for s in letters)
    return {s: named[other + m[1]] for s, m in found if m and other + m[1] in named}


def _transposed(letter: sp.Symbol, letters: frozenset[sp.Symbol]) -> sp.Symbol | None:
    """Return the letter with its two indices swapped: a21 for a12."""
    name = letter.name
    if len(name) < 3 or not name[-2:].isdigit() or name[-1] == name[-2]:
        return None
    return next((s for s in letters if s.name == name[:-2] + name[-1] + name[-2]), None)
