"""A motion's coefficients are the numbers it was given, at all times, and wrong ones are refused."""

import numpy as np
import pytest
import sympy as sp
from refusals import refuses

from percept_obs import affine, rigid
from percept_obs.system.motion import TIME, Motion
from percept_obs.system.signal import Signal

A = np.arange(9.0).reshape(3, 3)
b = np.array([1.0, 2, 3])
TIMES = np.array([0.0, 1.0, 3.0])


def test_symbols_have_no_numbers():
    motion = affine()
    assert " ".join(map(str, motion.parameters)) == "a11 a12 a13 a21 a22 a23 a31 a32 a33 b1 b2 b3"
    with pytest.raises(ValueError, match="no values for a11"):
        motion.known(0.0)


def test_constant_coefficients_are_kept():
    assert affine(A, b).known([0, 5]).tolist() == [[*A.ravel(), *b]]
    assert affine(A, b).values[sp.Symbol("b2", real=True)] == 2


def test_sampled_coefficients_are_linear_between_samples():
    motion = affine(np.stack([A, 2 * A, 4 * A]), b, times=TIMES)
    np.testing.assert_allclose(motion.known([0.5, 2.0])[:, :9], [1.5 * A.ravel(), 3 * A.ravel()])
    np.testing.assert_allclose(motion.known([0.5, 2.0])[:, 9:], [b, b])
    assert motion.values == {}


def test_functions_of_time_are_called():
    motion = affine(lambda t: A * np.cos(t), b)
    np.testing.assert_allclose(motion.known([0.0, 2.0])[:, :9], [A.ravel(), A.ravel() * np.cos(2.0)])


def test_expressions_are_put_into_the_matrices():
    k = sp.Symbol("k", real=True)
    motion = affine(k * sp.eye(3), [0, 0, 1])
    assert k * sp.eye(3) == motion.A
    assert motion.parameters == (k,)
    assert "k" in motion._repr_latex_()


def test_sympy_columns_of_numbers_are_vectors():
    column = sp.Matrix([1, 2, 3])
    np.testing.assert_array_equal(affine(sp.Matrix(A), column).known(0.0), affine(A, b).known(0.0))
    np.testing.assert_array_equal(affine(A, lambda t: t * column).known(2.0), affine(A, 2 * b).known(0.0))
    assert rigid(camera_angular_velocity=column).values[sp.Symbol("w_c3", real=True)] == 3


def test_a_point_turns_against_the_camera():
    motion = rigid(camera_angular_velocity=(0.1, 0.2, 0.3), camera_velocity=(1, 2, 3), point_velocity=(4, 5, 6))
    point = np.array([0.5, -1, 2])
    numbers = {s: v for s, v in motion.values.items()}
    rate = np.array(motion.A.subs(numbers) @ sp.Matrix(point) + motion.b.subs(numbers), dtype=float).ravel()
    np.testing.assert_allclose(rate, -np.cross([0.1, 0.2, 0.3], point) + 3.0)


def test_columns_of_a_rigid_signal_are_in_the_order_of_its_parameters():
    names = ["w_c1", "w_c2", "w_c3", "v_c1", "v_c2", "v_c3", "v_p1", "v_p2", "v_p3"]
    motion = rigid(camera_angular_velocity=(0.1, 0.2, 0.3), camera_velocity=(1, 2, 3), point_velocity=(4, 5, 6))
    assert [(str(s), v) for s, v in motion.values.items()] == [*zip(names, (0.1, 0.2, 0.3, *range(1, 7)), strict=True)]


test_wrong_coefficients_are_refused = refuses(
    lambda arguments: affine(**arguments),
    ({"A": A}, "all of its coefficients or none"),
    ({"A": A[:2], "b": b}, r"shape \(2, 3\); expected \(3, 3\)"),
    ({"A": A, "b": [1, 2]}, r"expected \(3,\)"),
    ({"A": A, "b": [1, 2, np.nan]}, "not finite"),
    ({"A": np.stack([A, A]), "b": b, "times": TIMES}, r"or \(3, 3, 3\)"),
    ({"A": np.stack([A] * 3), "b": b, "times": [0, 2, 1]}, "strictly increasing"),
    ({"A": np.stack([A] * 3), "b": b, "times": [0, 1, 1]}, "strictly increasing"),
)


def test_times_outside_the_samples_are_refused():
    motion = affine(np.stack([A] * 3), b, times=TIMES)
    with pytest.raises(ValueError, match="known from 0 to 3 s, but is asked for from 2 to 4 s"):
        motion.known([2.0, 4.0])


@pytest.mark.parametrize(
    ("late", "message"),
    [([1.0, np.nan, 3], "not finite"), ([1.0, 2], r"shape \(2,\)"), (["1", "2", "3"], "real numbers")],
)
def test_a_function_that_goes_wrong_at_one_of_many_times_is_refused(late, message):
    motion = affine(A, lambda t: late if t > 2 else [1.0, 2, t])
    assert motion.known([0.0, 2.0])[:, -1].tolist() == [0, 2]
    with pytest.raises(ValueError, match=message):
        motion.known([0.0, 1.0, 3.0])


def test_a_signal_of_another_shape_is_refused():
    with pytest.raises(ValueError, match="as many times"):
        Signal(np.zeros((2, 3)))
    symbolic = affine()
    motion = Motion("affine", symbolic.A, symbolic.b, symbolic.parameters, Signal([1.0, 2.0]))
    with pytest.raises(ValueError, match="12 parameters, not 2"):
        motion.known(0.0)


def test_expressions_of_time_alone_are_known_at_all_times():
    t, free = TIME, sp.Symbol("k", real=True)
    motion = affine(sp.diag(sp.sin(t), 0, 2), [t, 0, 1])
    np.testing.assert_array_equal(motion.known([0.0, 0.5]), [[0.0], [0.5]])
    assert motion.parameters == (t,)
    assert motion.values == {}
    with pytest.raises(ValueError, match="has no values for k, t"):
        affine(sp.diag(sp.sin(t), 0, free), [t, 0, 1]).known(0.0)
