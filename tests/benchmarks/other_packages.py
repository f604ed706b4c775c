"""The same right-hand side in other packages: each gives a function that makes so many runs, and returns final states.

A package that is not installed, or no compiler, gives none.  All integrate point and observer as one system; those with
a step of their own choosing are asked for the samples of the camera, at a relative error of 1e-8.
"""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import sympy as sp
from scipy.integrate import solve_ivp

from percept_obs import record, with_point
from percept_obs.compile import Table

BATCH = 16
ERROR = 1e-8
"""Relative error of those that choose their steps."""


@dataclass(frozen=True)
class Work:
    """What is to be done: a flow in states and one gain that varies, from a start, over times."""

    state: tuple
    gain: sp.Symbol
    flow: tuple
    start: np.ndarray
    gains: np.ndarray
    times: np.ndarray

    @property
    def step(self):
        return float(self.times[1])

    def function(self, modules):
        return sp.lambdify([self.state, self.gain], self.flow, modules, cse=True)


def together_of(scenario, observer, gains, duration, step):
    """Point and observer as one system, the work that others do on it with its first gain varied, and its table."""
    together, steps = with_point(observer), round(duration / step)
    varied = observer.gains[0].symbol
    values = scenario.motion.values | {each.symbol: each.value for each in together.gains if each.symbol != varied}
    flow = tuple(e.subs(values) for e in together.equations.flow)
    start = np.array([*record(scenario, 1).truth[0], 0.0, 0.0, 0.0])
    work = Work(together.equations.state, varied, flow, start, gains, step * np.arange(steps + 1))
    known = scenario.motion.known(0.0)
    return together, work, Table(np.full(steps, step), np.zeros((steps, 3, 0)), known, np.zeros((steps + 1, 0)))


def runge_kutta(flow, state, step, steps):
    """The classical method, for a flow of arrays."""
    for _ in range(steps):
        a = flow(state)
        b = flow(state + step / 2 * a)
        c = flow(state + step / 2 * b)
        d = flow(state + step * c)
        state = state + step / 6 * (a + 2 * b + 2 * c + d)
    return state


def vectorised_numpy(work):
    """All runs together; a twentieth of the steps, for it takes so long."""
    flow, several = work.function("numpy"), np.repeat(work.start[:, None], len(work.gains), axis=1)
    steps = (len(work.times) - 1) // 20
    return lambda: runge_kutta(lambda s: np.array(flow(s, work.gains)), several, work.step, steps), 20


def scipy_rk45(work):
    flow, gain = work.function("math"), work.gains[0]

    def run():
        found = solve_ivp(lambda t, s: flow(s, gain), (0, work.times[-1]), work.start, "RK45", work.times, rtol=ERROR)
        return found.y[:, -1:]

    return run, len(work.gains)


def heyoka(work):
    """heyoka: Taylor series, as many runs beside each other as the processor's vectors hold."""
    import heyoka as package

    width = package.recommended_simd_size()
    names = {symbol.name: package.make_vars(f"s{k}") for k, symbol in enumerate(work.state)}
    own = names | {work.gain.name: package.par[0]}
    system = [(names[s.name], package.from_sympy(e, {sp.Symbol(n): v for n, v in own.items()}))
              for s, e in zip(work.state, [plain(e) for e in work.flow], strict=True)]  # fmt: skip
    start = np.repeat(work.start[:, None], width, axis=1)
    solver = package.taylor_adaptive_batch(system, start, tol=ERROR, pars=work.gains[None, :width].copy())
    times = np.repeat(work.times[:, None], width, axis=1)

    def run():
        solver.set_time(0.0)
        solver.state[:] = start
        solver.propagate_grid(times)
        return solver.state.copy()

    return run, len(work.gains) / width


def plain(expression):
    """An expression in symbols without assumptions."""
    return expression.xreplace({symbol: sp.Symbol(symbol.name) for symbol in expression.free_symbols})


def diffrax(work):
    """diffrax: Dormand and Prince's method of order 5 with constant steps, all runs together."""
    import diffrax as package
    import jax
    import jax.numpy as jnp

    jax.config.update("jax_enable_x64", True)
    flow = work.function("jax")
    term = package.ODETerm(lambda t, s, gain: jnp.stack(flow(s, gain)))
    start, gains = jnp.array(work.start), jnp.array(work.gains)

    def one(gain):
        return package.diffeqsolve(
            term, package.Dopri5(), 0.0, work.times[-1], work.step, start, gain, max_steps=len(work.times) + 1
        ).ys[0]

    several = jax.jit(jax.vmap(one))
    return lambda: np.asarray(several(gains)).T, 1


def c_program(work, batch):
    """Text of the classical method for so many batch at once."""
    n, names = len(work.state), {symbol: sp.Symbol(f"x{k}") for k, symbol in enumerate(work.state)}
    names[work.gain] = sp.Symbol("gain")
    shared, rates = sp.cse([e.xreplace(names) for e in work.flow])
    inner = [f"double x{k} = s[{k}][i] + c*h*d[{k}][i];" for k in range(n)]
    inner += ["double gain = gains[i];", *(f"double {symbol} = {sp.ccode(e)};" for symbol, e in shared)]
    inner += [f"double r{k} = {sp.ccode(rate)};" for k, rate in enumerate(rates)]
    inner += [f"d[{k}][i] = r{k}; q[{k}][i] += w*r{k};" for k in range(n)]
    stage = "\n".join(inner)
    return f"""
#include <math.h>
void run(double *start, double *gains, long runs, long steps, double h, double *end) {{
  for (long b = 0; b < runs; b += {batch}, gains += {batch}) {{
    double s[{n}][{batch}], d[{n}][{batch}], q[{n}][{batch}];
    static const double cs[4] = {{0, 0.5, 0.5, 1}}, ws[4] = {{1.0/6, 1.0/3, 1.0/3, 1.0/6}};
    for (int k = 0; k < {n}; k++) for (int i = 0; i < {batch}; i++) s[k][i] = start[k];
    for (long t = 0; t < steps; t++) {{
      for (int k = 0; k < {n}; k++) for (int i = 0; i < {batch}; i++) d[k][i] = q[k][i] = 0;
      for (int j = 0; j < 4; j++) {{
        double c = cs[j], w = ws[j];
        #pragma omp simd
        for (int i = 0; i < {batch}; i++) {{ {stage} }}
      }}
      for (int k = 0; k < {n}; k++) for (int i = 0; i < {batch}; i++) s[k][i] += h*q[k][i];
    }}
    for (int k = 0; k < {n}; k++) for (int i = 0; i < {batch}; i++) end[(b + i)*{n} + k] = s[k][i];
  }}
}}
"""


def in_c(work, folder, batch, share):
    """Generated C, by gcc with all that makes it fast."""
    source, library = (Path(folder) / f"batch{batch}.{end}" for end in ("c", "so"))
    source.write_text(c_program(work, batch))
    flags = ["-O3", "-march=native", "-ffast-math", "-fopenmp-simd", "-shared", "-fPIC"]
    subprocess.run(["gcc", *flags, str(source), "-o", str(library), "-lm"], check=True)
    call, pointer = ctypes.CDLL(str(library)).run, ctypes.POINTER(ctypes.c_double)
    call.argtypes = [pointer, pointer, ctypes.c_long, ctypes.c_long, ctypes.c_double, pointer]
    ends = np.empty((len(work.gains) // share, len(work.start)))

    def run():
        start, gains, end = (array.ctypes.data_as(pointer) for array in (work.start, work.gains, ends))
        call(start, gains, len(ends), len(work.times) - 1, work.step, end)
        return ends.T

    return run, share


def contenders(work, folder):
    """Functions by what they are, each with the share of all runs' time that it takes; and what is not installed."""
    found = {"vectorised numpy": vectorised_numpy(work), "scipy, RK45": scipy_rk45(work)}
    if shutil.which("gcc"):
        found |= {"C, OpenMP SIMD": in_c(work, folder, BATCH, 1), "C, one lane": in_c(work, folder, 1, 16)}
    others = {"heyoka, Taylor series": ("heyoka", heyoka), "diffrax, Dopri5": ("diffrax", diffrax)}
    found |= {name: make(work) for name, (module, make) in others.items() if find_spec(module)}
    return found, [module for module, _ in others.values() if not find_spec(module)]
