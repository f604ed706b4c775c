"""Derivations to check: every kind of target, its formulas in other forms, and formulas with slips in them."""

import random
import re
from dataclasses import dataclass
from functools import cache
from itertools import islice

import sympy as sp
from examples import BOTH, FORMS, MOTIONS, ONE

from percept_obs import PerspectiveSystem, check, instantaneous, observers
from percept_obs.checking import Target, Verdict, target_of
from percept_obs.checking.explaining import wrong_terms
from percept_obs.checking.lines import VALUE
from percept_obs.checking.places import at, put
from percept_obs.checking.slips import MISTAKES, Slip, factored, siblings_in, slips_in
from percept_obs.observers.family import Family
from percept_obs.papers import LEDGERS
from percept_obs.structure import COROLLARIES
from percept_obs.system import surfaces

LARGE = 150
"""Operations beyond which sympy is not asked to factor."""
UNREADABLE_ERRORS = ("range_identification", "integral_sliding_mode", "gpebo", "equivariant_filter")


@dataclass(frozen=True)
class Case:
    """A target, of which the first lines are taken."""

    name: str
    target: Target

    @property
    def rows(self):
        return range(min(len(self.target.lines), 9))


@cache
def cases():
    """Everything that the package derives, in examples."""
    return tuple(Case(name, target_of(thing)) for name, thing in [*_systems(), *_observers(), *_others()])


@cache
def few_cases():
    """Derivations of one system, and a teacher's own formulas."""
    return tuple(Case(name, target_of(thing)) for name, thing in [*islice(_systems(), 20), *own_formulas().items()])


def _systems():
    for kind, motion in MOTIONS.items():
        for make in surfaces.SURFACES:
            system, name = PerspectiveSystem(motion, make()), f"{kind}, {make.__name__}"
            yield from ((f"rate, {name}", system), (f"focus of expansion, {name}", system.foe))
            yield from ((f"step {k}, {name}", step) for k, step in enumerate(system.derivation(), 1) if step.values)
            if not system.surface.intermediates:
                yield f"Jacobian, {name}", system.jacobian()
            for outputs in system.output_choices:
                form = system.measure(*outputs)
                yield f"form {outputs}, {name}", form
                yield from ((f"{part} {outputs}, {name}", getattr(form, part)) for part in ("w", "phi", "g"))


def _observers():
    for family in dict.fromkeys(value for value in vars(observers).values() if isinstance(value, Family)):
        for outputs, form in FORMS.items():
            if family.objection(form) is None:
                observer = family(form)
                yield f"{family.key}, {outputs}", observer
                # the errors of some are too long to read, or have no dynamics of their own
                if form is not ONE and family.key not in UNREADABLE_ERRORS:
                    yield f"error of {family.key}, {outputs}", observer.error_dynamics()


def _others():
    yield "where an instant suffices", instantaneous(BOTH)
    yield from ((f"corollary {c.number}", c.choice()) for c in COROLLARIES)
    yield from ((f"form of corollary {c.number}", c.choice().form) for c in COROLLARIES)
    yield from ((f"step {k} of the form", step) for k, step in enumerate(BOTH.derivation(), 1) if step.values)
    for ledger in LEDGERS:
        for entry in ledger.entries:
            if entry.printed and all(isinstance(p, sp.Eq) and p.lhs.is_Symbol for p in entry.printed):
                yield f"{ledger.paper} {entry.place}", entry.printed
    yield from own_formulas().items()


def own_formulas():
    """Formulas of a teacher's own, with roots and functions."""
    y1, y2, xi, w, t, c, tau = sp.symbols("y1 y2 xi w t c tau", real=True)
    square = y1**2 + y2**2
    return {
        "unified ray": (xi + sp.sqrt(1 + (1 - xi**2) * square)) / (1 + square),
        "range": {"R": sp.sqrt(1 + square), "q": y1 / sp.sqrt(1 + square) + xi * y2},
        "rotation": sp.Matrix([y1 * sp.cos(w * t) - y2 * sp.sin(w * t), y1 * sp.sin(w * t) + y2 * sp.cos(w * t)]),
        "pendulum": {"f": y1 * sp.sin(w * t) ** 2 + y2 * sp.cos(2 * w * t), "h": sp.exp(-c * t) * sp.sin(w * t + y1)},
        "switch": {"s": c * sp.tanh(xi * (y1 - y2)) + sp.Abs(y1 - y2) * sp.sign(y1), "u": c * sp.atan(y1 / y2)},
        "window": sp.Integral(w * sp.exp(-c * tau) * tau, (tau, 0, t)) + y1,
    }


def _horner(formula, draw):
    letters = sorted(formula.free_symbols, key=str)
    return sp.horner(formula, wrt=draw.choice(letters)) if letters and formula.is_polynomial(*letters) else formula


def _collected(formula, draw):
    letters = sorted(formula.free_symbols, key=str)
    return sp.collect(sp.expand(formula), draw.choice(letters)) if letters else formula


def _functions(formula, draw):
    """Hyperbolic functions as exponentials, angles halved or sums of angles multiplied out."""
    formula = formula.replace(lambda e: isinstance(e, sp.tanh), lambda e: e.rewrite(draw.choice([sp.exp, sp.tanh])))
    if draw.random() < 0.5:
        return formula.replace(lambda e: isinstance(e, sp.cos), lambda e: 1 - 2 * sp.sin(e.args[0] / 2) ** 2)
    return formula.replace(lambda e: isinstance(e, sp.sin | sp.cos), sp.expand_trig)


def _powers(formula, draw):
    """Roots as quotients of other powers."""
    return formula.replace(
        lambda e: e.is_Pow and abs(e.exp) == sp.S.Half, lambda e: e.base ** (3 * e.exp) / e.base ** (2 * e.exp)
    )


def _renamed(formula, draw):
    return formula.xreplace({v: sp.Symbol("sigma") for e in formula.atoms(sp.Integral) for v in e.variables})


REWRITES = {
    "expand": lambda formula, draw: sp.expand(formula),
    "factor": lambda formula, draw: sp.factor(formula),
    "together": lambda formula, draw: sp.together(formula),
    "horner": _horner,
    "collect": _collected,
    "functions": _functions,
    "powers": _powers,
    "another order": lambda formula, draw: formula,
    "bound letters": _renamed,
}


def rewritten(formula, draw):
    """The name of a rewrite, and the same formula in that form; sympy is not asked to factor large ones."""
    names = list(REWRITES)
    if formula.has(sp.Integral):
        names = ["bound letters"]
    elif formula.has(sp.sin, sp.cos, sp.tanh) and draw.random() < 0.5:
        names = ["functions"]
    elif formula.has(sp.Piecewise):
        names = ["another order"]
    elif formula.count_ops() > LARGE or formula.has(sp.Abs):
        names = ["expand", "collect", "another order"]
    name = draw.choice(names)
    return name, REWRITES[name](formula, draw)


def as_text(formula, draw):
    """A formula as somebody types it: terms in any order, squares as products, a part under a new name."""
    terms, head = list(sp.Add.make_args(formula)), ""
    draw.shuffle(terms)
    sums = sorted((e for e in formula.atoms(sp.Add) if e != formula), key=str)
    if sums and draw.random() < 0.3:
        part = draw.choice(sums)
        terms, head = [term.xreplace({part: sp.Symbol("qq")}) for term in terms], f"qq = {_typed(part)}\n"
    text = " + ".join(map(_typed, terms)).replace("+ -", "- ")
    if draw.random() < 0.3:
        text = re.sub(r"\b([A-Za-z]\w*)\^2\b", r"\1*\1", text)
    return head, text.replace("*", " ") if draw.random() < 0.3 else text


def _typed(formula):
    return str(formula).replace("**", "^").replace("Abs", "abs")


def given(formula, line, draw):
    """A line as text, as LaTeX or in sympy, with its name."""
    readable = not formula.has(sp.Integral, sp.Piecewise, sp.I)
    readable = readable and all(re.fullmatch(r"[A-Za-z]\w*", s.name) for s in formula.free_symbols)
    way = draw.choice(["sympy", "text", "LaTeX"]) if readable else "sympy"
    if way == "text" and formula.count_ops() < 400:
        head, text = as_text(formula, draw)
        return f"{head}{line.name} = {text}" if line.key else head + text
    tex = sp.latex(formula)
    if way == "LaTeX" and len(tex) < 8000:
        return f"{line.name} = {tex}" if line.key else tex
    return {line.name: formula} if line.key else formula


def whole(case, row, mine):
    """All lines of a target with one of them given: lines without a name are told by their order."""
    lines = case.target.lines
    mine = {lines[row].name: mine} if lines[row].key and isinstance(mine, sp.Basic) else mine
    return [
        mine if k == row else {line.name: line.formula} if line.key else line.formula for k, line in enumerate(lines)
    ]


def differ(one, other):
    """Return True if two formulas differ in value somewhere, by floats and without the checker."""
    letters = sorted(one.free_symbols | other.free_symbols, key=str)
    for seed in range(6):
        draw = random.Random(seed)
        point = {s: sp.Float(draw.choice([-1, 1]) * draw.uniform(0.3, 1.7), 20) for s in letters}
        a, b = (sp.N(e.subs(point), 20) for e in (one, other))
        if abs(a - b) > 1e-10 * max(1, abs(a), abs(b)):
            return True
    return False


@dataclass(frozen=True)
class Mutant:
    """A formula with a slip, and the term in which it is, as it became."""

    formula: sp.Expr
    slip: Slip
    term: sp.Expr


def mutants(formula, target, draw):
    """Formulas with one slip, in any order; letters are mistaken for others of the same system."""
    letters = formula.free_symbols | (set(target.letters.values()) if target.pool else set())
    slips = list(slips_in(formula, siblings_in(letters), MISTAKES))
    slips += [] if formula.is_Add else factored(formula, MISTAKES)
    draw.shuffle(slips)
    for slip in slips:
        up = next(n for n in range(len(slip.path), -1, -1) if n == 0 or at(formula, slip.path[: n - 1]).is_Add)
        term = put(at(formula, slip.path[:up]), slip.path[up:], slip.after)
        yield Mutant(slip.formula, slip, term)


def drawn(draw, slips, among):
    """A case, a row, and a formula for it with so many slips; half of them in another form than the target's."""
    while True:
        case = draw.choice(among)
        row = draw.choice(case.rows)
        line = case.target.lines[row]
        formula = rewritten(line.formula, draw)[1] if slips == 1 and draw.random() < 0.5 else line.formula
        made = []
        for _ in range(slips):
            # where only zeros count, signs, factors and exponents change nothing
            found = (m for m in mutants(formula, case.target, draw) if line.kind == VALUE or m.slip.kind == "letter")
            mutant = next((m for m in found if differ(m.formula, line.formula) and differ(m.formula, formula)), None)
            if mutant is None:
                break
            made.append(mutant)
            formula = mutant.formula
        if len(made) == slips and (slips == 1 or line.kind == VALUE):
            return case, row, made


def is_found(term, marked):
    """Return True if a term is marked, or inside of one that is where few are."""
    inside = len(marked) <= 2 and any(term in sp.preorder_traversal(m) for m in marked)
    wanted = sp.expand(term)
    return inside or any(
        sp.expand(m) in (wanted, -wanted) or sp.expand(m).as_coeff_Mul()[1] == wanted.as_coeff_Mul()[1] for m in marked
    )


@dataclass(frozen=True)
class Found:
    """Result of a review of a formula with slips."""

    refused: bool
    line: bool
    term: bool
    slip: bool
    about: str


AS_FOUND = {"dropped": ("missing", "replaced"), "exponent": ("exponent", "letter")}
"""Kinds of mends that answer to a kind of slip, where there are others than of the same name."""


def reviewed(seed, slips, among):
    """The review of a random formula with so many slips."""
    draw = random.Random(f"{slips} {seed}")
    case, row, made = drawn(draw, slips, among)
    mine = whole(case, row, made[-1].formula) if len(case.target.lines) > 1 else made[-1].formula
    review = check(mine, case.target)
    str(review.hint(3))
    wrong = [k for k, line in enumerate(review.lines) if line.verdict in (Verdict.WRONG, Verdict.CARRIED)]
    at_line = wrong == [row if len(case.target.lines) > 1 else 0]
    term = slip = False
    about = f"{seed}: {case.name}, line {row}"
    if at_line and wrong[0] in review.explanations:
        explanation = review.explanations[wrong[0]]
        marked = [term for _, term in wrong_terms(explanation, review.lines[wrong[0]].mine)]
        kinds = [mend.kind for mend in explanation.slips]
        lost = any(kind in AS_FOUND["dropped"] for kind in kinds)
        # the first of two slips may be in a term that the second one changed again
        there = {m.term for m in made[:-1] if m.term == 0 or m.term in sp.preorder_traversal(made[-1].formula)} | {
            made[-1].term
        }
        terms = [lost if m.slip.kind == "dropped" else is_found(m.term, marked) for m in made if m.term in there]
        term = all(terms)
        slip = len(kinds) == 1 and kinds[0] in AS_FOUND.get(made[0].slip.kind, (made[0].slip.kind,))
        about += f": {[(m.slip.kind, m.slip.before, m.slip.after) for m in made]}, found {kinds} in {marked}"
    return Found(review.right is False, at_line, term, slip, about)


def equivalent(seed, among):
    """The name of a rewrite, a formula given in that form, and its target."""
    draw = random.Random(seed)
    case = draw.choice(among)
    row = draw.choice(case.rows)
    line = case.target.lines[row]
    how, formula = rewritten(line.formula, draw)
    mine = given(formula, line, draw)
    return how, mine if line.key or len(case.target.lines) == 1 else whole(case, row, mine), case
