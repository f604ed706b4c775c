"""The equations that the lab shows in matrices are those of the observers, entry by entry."""

import pytest
import sympy as sp

from percept_obs import PerspectiveSystem, affine, pinhole, rigid
from percept_obs.labs.shared.equations import cascade_equations, equations_of, kalman_equations
from percept_obs.observers import OBSERVERS, extended_kalman, linear_approximation
from percept_obs.observers.parts import hats


@pytest.fixture(params=[("y1", "y2"), ("y1",)], ids="+".join)
def form(request):
    return PerspectiveSystem(affine(), pinhole()).measure(*request.param)


def put(equation, found):
    """An explicit matrix for a matrix equation in which letters like k stand for what has been found."""
    return sp.Matrix(sp.sympify(equation).xreplace(found).doit())


def upper(matrix):
    return [matrix[i, j] for i in range(matrix.rows) for j in range(i, matrix.cols)]


def assert_same(one, other):
    assert [sp.expand(sp.together(a - b)) for a, b in zip(one, other, strict=True)] == [0] * len(one)


def test_the_extended_kalman_filter_in_matrices_is_the_observer(form):
    observer = extended_kalman(form)
    gains = {gain.name: gain.symbol for gain in observer.gains}
    x = (*form.x1, *form.x2)
    size, state = len(x), observer.equations.state
    estimate = sp.ImmutableMatrix(hats(x))
    P = sp.ImmutableMatrix(observer.covariance.extract(*2 * [[form.coordinates.index(s) for s in x]]))
    rate = sp.ImmutableMatrix(form.rate.xreplace(dict(zip(x, estimate, strict=True))))
    hidden_only = [*(0 for _ in form.x1), *(gains["hidden_process_noise"] for _ in form.x2)]
    doubt = sp.ImmutableMatrix(gains["process_noise"] * sp.eye(size) + sp.diag(*hidden_only))
    moved = PerspectiveSystem(rigid(), form.view).partition(*form.measured)
    G = moved.rate.jacobian(moved.parameters[:6]).xreplace(dict(zip(x, estimate, strict=True)))
    noises = [gains["turning_noise"]] * 3 + [gains["velocity_noise"]] * 3
    doubt += G * sp.diag(*noises) * G.T
    for j, y in enumerate(form.x1):
        c = sp.ImmutableMatrix(sp.eye(size)[:, j])
        R = sp.ImmutableMatrix([[gains["noise_variance"]]])
        rows = kalman_equations(
            *(estimate, P, rate.jacobian(list(estimate)), rate, c, sp.ImmutableMatrix([[y]])), *(doubt, R)
        )
        k, e, s = (sp.MatrixSymbol(n, *shape) for n, shape in (("k", (size, 1)), ("e", (1, 1)), ("s", (1, 1))))
        found = {e: sp.ImmutableMatrix(rows["e"]), s: sp.ImmutableMatrix(rows["s"])}
        found[k] = sp.ImmutableMatrix(put(rows["k"], found))
        update = [*put(rows["x+"], found), *upper(put(rows["P+"], found))]
        assert_same(update, observer.equations.update[j])
    assert_same([*rows["x'"], *upper(sp.Matrix(rows["P'"]))], observer.equations.flow)
    assert len(update) == len(state)


def test_the_cascade_in_matrices_is_the_linear_approximation_observer(form):
    iterates = 2
    observer = linear_approximation(form, iterates=iterates)
    gains = {gain.name: gain.symbol for gain in observer.gains}
    x, n1 = (*form.x1, *form.x2), len(form.x1)
    size = len(x)
    at_zero = dict.fromkeys(form.x2, 0)
    J = form.g.jacobian(form.x2)
    C, y = sp.ImmutableMatrix(sp.eye(size)[:n1, :]), sp.ImmutableMatrix(form.x1)
    offset = sp.ImmutableMatrix([*form.phi, *form.g.subs(at_zero)])
    block, before = len(observer.equations.state) // iterates, at_zero
    for i in range(iterates):
        state = observer.equations.state[i * block : (i + 1) * block]
        estimate, entries = sp.ImmutableMatrix(state[:size]), iter(state[size:])
        P = sp.zeros(size)
        for row in range(size):
            for column in range(row, size):
                P[row, column] = P[column, row] = next(entries)
        frozen = (J.subs(at_zero) + J.subs(before, simultaneous=True)) / 2
        F = sp.Matrix.vstack(
            sp.Matrix.hstack(sp.zeros(n1), form.w.T), sp.Matrix.hstack(sp.zeros(size - n1, n1), frozen)
        )
        weights = sp.diag(*[1] * n1, *[gains["hidden_weight"]] * (size - n1))
        rows = cascade_equations(
            *(estimate, sp.ImmutableMatrix(P), sp.ImmutableMatrix(F), offset, C, y, weights),
            *(gains["process_weight"], gains["measurement_weight"]),
        )
        K, e = sp.MatrixSymbol("K", size, n1), sp.MatrixSymbol("e", n1, 1)
        found = {K: sp.ImmutableMatrix(rows["K"]), e: sp.ImmutableMatrix(rows["e"])}
        flow = [*put(rows["x'"], found), *upper(put(rows["P'"], found))]
        assert_same(flow, observer.equations.flow[i * block : (i + 1) * block])
        before = dict(zip(form.x2, estimate[n1:], strict=True))


@pytest.mark.slow
def test_a_reset_tells_its_condition_once():
    for make in OBSERVERS:
        for variant in equations_of(make):
            assert sum(line.count("<mtext>&nbsp;when&nbsp;") for line in variant["lines"]) <= 1
