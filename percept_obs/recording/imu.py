"""IMUs: their files, and samples of a simulated one with noise and with biases that walk."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from percept_obs.compile import Array
from percept_obs.recording.camera import Seed, _Noise, seeded
from percept_obs.recording.plausibility import Unlikely
from percept_obs.recording.text_table import NANOSECONDS, Clock, PathLike, Repeated, read_table
from percept_obs.system.inertial import b_a, b_w, imu
from percept_obs.system.motion import Motion
from percept_obs.validation import checked, limit, positive, warn

NAMES = ("t", "w_x", "w_y", "w_z", "a_x", "a_y", "a_z")
EXAMPLE = "1403636579758555392,-0.0991,0.1472,0.0272,8.1476,-0.3759,-2.4026"


@checked
@dataclass(frozen=True)
class Imu(_Noise):
    """Errors of an IMU: noise and biases, the same in each axis.

    The defaults are those of the Bosch BMI160 of many telephones, as the TUM VI benchmark gives them (Schubert et al.
    2018), and biases that are left after a calibration.

    Parameters
    ----------
    turning_noise, force_noise : float
        Densities of the noise, in rad/s and m/s^2 per root of Hz.
    turning_bias, force_bias : float
        Standard deviations of the biases at the beginning, in rad/s and m/s^2.
    turning_walk, force_walk : float
        How fast biases walk, in rad/s and m/s^2 per root of a second.
    rate : float
        Samples a second.

    See Also
    --------
    percept_obs.recording.scenarios.held_phone : Has one.

    Examples
    --------
    >>> Imu().turning_noise
    0.00016
    """

    turning_noise: float = 1.6e-4
    force_noise: float = 2.8e-3
    turning_bias: float = 0.01
    force_bias: float = 0.1
    turning_walk: float = 2.2e-5
    force_walk: float = 8.6e-4
    rate: float = 200.0

    def __post_init__(self) -> None:
        super().__post_init__()
        positive(rate=self.rate)

    def measured(self, motion: Motion, duration: float, seed: Seed) -> tuple[Motion, Callable[[Array], Array]]:
        """Return an IMU's motion as this one measures it, and its true biases as a function of times, shape (K, 6)."""
        positive(duration=duration)
        if len(motion.parameters) != 6:
            raise ValueError(f"an IMU measures a motion of imu(), not the {motion.name} motion")
        limit(24 * duration * self.rate, f"numbers of {duration:g} s", "lower the rate or shorten the duration")
        draw = seeded(seed)
        times = np.arange(np.ceil(duration * self.rate) + 2) / self.rate
        pairs = (
            (self.turning_noise, self.force_noise),
            (self.turning_bias, self.force_bias),
            (self.turning_walk, self.force_walk),
        )
        noise, bias, walk = (np.repeat(pair, 3) for pair in pairs)
        steps = draw.normal(size=(len(times), 6)) * walk / np.sqrt(self.rate)
        biases = draw.normal(size=6) * bias + np.cumsum(steps, axis=0)
        samples = motion.known(times) + biases + draw.normal(size=(len(times), 6)) * noise * np.sqrt(self.rate)

        def at(instants: Array) -> Array:
            return np.stack([np.interp(instants, times, column) for column in biases.T], axis=-1)

        known = imu(samples[:, :3], samples[:, 3:], times)
        names = (symbol.name for symbol in (*known.parameters, *b_w, *b_a))
        return replace(known, densities=dict(zip(names, (np.append(noise, walk) ** 2).tolist(), strict=True))), at


@checked
def read_imu(path: PathLike, clock: Clock = NANOSECONDS, repeated: Repeated = "refuse") -> Motion:
    r"""Return the samples of an IMU in a file of EuRoC or TUM VI, ``imu0/data.csv``, in the IMU's axes.

    Parameters
    ----------
    path : path
        Rows of nanoseconds, angular velocity x, y, z in rad/s and specific force x, y, z in m/s^2, separated by commas.
    clock : Clock
        Of the file, as for `read_euroc`.
    repeated : "refuse" or "drop"
        As for `read_euroc`.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it is another kind of file, has too few columns, a cell is not a finite number, times do not increase or
        cannot be, or a spreadsheet has rounded them until steps are lost.

    See Also
    --------
    percept_obs.read_euroc : Poses of the same benchmark.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = pathlib.Path(folder) / "data.csv"
    ...     _ = file.write_text("0,0,0,0.1,0,-9.8,0\n5000000,0,0,0.1,0,-9.8,0\n")
    ...     read_imu(file).known(0.005).tolist()
    [[0.0, 0.0, 0.1, 0.0, -9.8, 0.0]]
    """
    table = read_table(path, NAMES, ",", EXAMPLE, kind="IMU")
    columns = np.stack([table.numbers(name, gaps=False) for name in NAMES[1:]], axis=-1)
    time, kept = table.steps(NAMES[0], clock, repeated)
    force = float(np.median(np.linalg.norm(columns[kept, 3:], axis=1)))
    if not 3 < force < 20:
        said = f"{table.file} has a specific force of typically {force:.3g} m/s^2, and at rest it is 9.8"
        warn(Unlikely(f"{said}: are its columns {', '.join(NAMES)}, in rad/s and m/s^2?"))
    return imu(columns[kept, :3], columns[kept, 3:], time)
