"""Files of cameras in YAML: those of OpenCV, ROS and VINS, Kalibr's camchains, and EuRoC's sensors."""

from __future__ import annotations

import reprlib
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from percept_obs.compile import Array
from percept_obs.recording.text_table import PathLike, existing
from percept_obs.validation import checked, needed

__all__ = ["Mount", "read_mount"]

LARGEST = 1_000_000
"""Bytes in the largest file of a camera; others have a few thousand."""

LENSES = ("", "none", "radtan", "radial-tangential", "plumb_bob", "rational_polynomial", "equidistant", "fisheye")
"""Names of lenses in the files that name them; the last two are fisheyes."""


class Mount(NamedTuple):
    """Where a camera sits on its body, and how far their clocks differ.

    Parameters
    ----------
    position : array_like, shape (3,)
        Place of the camera in the body's coordinates, in metres.
    orientation : array_like, shape (3, 3)
        Rotation from the camera's axes to the body's.
    shift : float
        Seconds by which the body's clock is ahead of the camera's: Kalibr's timeshift_cam_imu.

    See Also
    --------
    read_mount : Reads it.

    Examples
    --------
    >>> mount = Mount((0.1, 0, 0.2), ((1, 0, 0), (0, 1, 0), (0, 0, 1)))
    >>> mount.shift
    0.0
    """

    position: Array
    orientation: Array
    shift: float = 0.0


def fields_of_camera(path: PathLike, camera: str | None) -> dict[str, Any]:
    """Fields of the `PixelCamera` in a file; see `PixelCamera.from_yaml`."""
    file, found = _camera(path, camera)
    numbers = found.get("projection_parameters")
    if isinstance(numbers, dict) and {"fx", "fy", "cx", "cy"} <= numbers.keys():  # of VINS
        found["intrinsics"] = [numbers[key] for key in ("fx", "fy", "cx", "cy")]
        found["distortion_coeffs"] = [*(found.get("distortion_parameters") or {}).values()]
    lens = str(found.get("distortion_model") or "").lower()
    if found.get("camera_model", "pinhole") != "pinhole" or lens not in LENSES:
        raise ValueError(
            f"{file} has a camera with the model {found.get('camera_model', 'pinhole')!r} and the lens {lens!r}; a "
            f"PixelCamera is a pinhole behind one of {', '.join(LENSES[1:])}: rectify the images"
        )
    if "intrinsics" in found:
        fx, fy, cx, cy = _numbers(file, found, "intrinsics", 4).tolist()
    elif "camera_matrix" not in found:
        there = ", ".join(found) or "nothing"
        raise ValueError(f"{file} has {there}; a camera needs camera_matrix, or intrinsics, with its focal lengths")
    else:
        matrix = _numbers(file, found, "camera_matrix", 9)
        fx, _, cx, _, fy, cy, *_ = matrix
        if (matrix[[1, 3, 6, 7]] != 0).any() or matrix[8] != 1:
            raise ValueError(f"{file} has the camera_matrix {matrix.tolist()}; expected fx 0 cx, 0 fy cy, 0 0 1")
    key = next((key for key in ("distortion_coefficients", "distortion_coeffs") if key in found), None)
    if not key and lens not in LENSES[:2]:
        raise ValueError(f"{file} has the lens {lens!r} and no distortion_coefficients; there are {', '.join(found)}")
    distortion = _numbers(file, found, key).tolist() if key else []
    while len(distortion) > 8 and not distortion[-1]:  # a thin prism or a tilt that is none
        distortion.pop()
    size = found.get("resolution") or [found.get(f"image_{side}") for side in ("width", "height")]
    size = None if None in size else size
    if size is not None:
        _numbers(file, {"size": size}, "size", 2)
    kind = "equidistant" if lens in LENSES[-2:] else "radtan"
    return {"focal": (fx, fy), "centre": (cx, cy), "size": size, "distortion": distortion, "lens": kind}


@checked
def read_mount(path: PathLike, camera: str | None = None) -> Mount:
    """Return where a camera sits on its body, and its clock, for ``poses.mounted(*read_mount(file))``.

    Parameters
    ----------
    path : path
        EuRoC's sensor.yaml with T_BS, or Kalibr's camchain with T_cam_imu.
    camera : str, optional
        Name of a camera, such as "cam0", in a file with several.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it is no such file, or says nothing of a mount.

    See Also
    --------
    PixelCamera.from_yaml : Its focal lengths and its lens.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = pathlib.Path(folder) / "sensor.yaml"
    ...     _ = file.write_text("T_BS: {data: [1, 0, 0, 0.1, 0, 1, 0, 0, 0, 0, 1, 0.2, 0, 0, 0, 1]}")
    ...     read_mount(file)[0].tolist()
    [0.1, 0.0, 0.2]
    """
    file, found = _camera(path, camera)
    for key, backwards in (("t_bs", False), ("t_imu_cam", False), ("t_cam_imu", True)):
        if key in found:
            mount = _numbers(file, found, key, 16).reshape(4, 4)
            place, turn = mount[:3, 3], mount[:3, :3]
            turned = np.allclose(turn @ turn.T, np.eye(3), atol=1e-3) and np.linalg.det(turn) > 0
            if not turned or (mount[3] != (0, 0, 0, 1)).any():
                raise ValueError(f"{file} has {key} = {mount.tolist()}; expected a rotation beside p, above 0 0 0 1")
            shift = float(_numbers(file, {"shift": [found.get("timeshift_cam_imu", 0.0)]}, "shift", 1)[0])
            return Mount(-turn.T @ place, turn.T, shift) if backwards else Mount(place, turn, shift)
    raise ValueError(f"{file} has {', '.join(found)}; it needs T_BS, T_imu_cam or T_cam_imu for a mount")


def _camera(path: PathLike, camera: str | None) -> tuple[str, dict[str, Any]]:
    """Name of the file, and what it says of a camera, by names in small letters."""
    needed("data", "yaml")
    import yaml  # type: ignore[import-untyped, unused-ignore]

    file = existing(path, "a YAML file of a camera")

    class Loader(yaml.SafeLoader):
        """Safe, and knows the matrices of OpenCV."""

    Loader.add_constructor("tag:yaml.org,2002:opencv-matrix", lambda loader, node: loader.construct_mapping(node, True))
    try:
        if Path(path).stat().st_size > LARGEST:
            raise ValueError(f"more than {LARGEST} bytes")
        text = Path(path).read_text(encoding="utf-8-sig")
        # OpenCV's first line is no directive of YAML
        whole = yaml.load(text.partition("\n")[2] if text.startswith("%YAML:") else text, Loader)
        if not isinstance(whole, dict):
            raise ValueError("no names of values")
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise ValueError(f"{file} is no YAML file of a camera ({' '.join(str(error).split())})") from None
    cameras = {str(name): each for name, each in whole.items() if isinstance(each, dict) and "intrinsics" in each}
    if camera is not None or len(cameras) > 1:
        if camera not in cameras:
            known = ", ".join(cameras)
            advice = f"the cameras {known}; give one of these names" if cameras else "one camera; leave camera= out"
            raise ValueError(f"{file} has {advice}, not {camera!r}")
        whole = cameras[camera]
    elif cameras:
        (whole,) = cameras.values()
    return file, {str(name).lower(): value for name, value in whole.items()}


def _numbers(file: str, found: dict[str, Any], name: str, count: int | None = None) -> Array:
    """Return the numbers of a list, a list of rows, or a matrix with its data."""
    value: Any = found.get(name)
    try:
        rows = value["data"] if isinstance(value, dict) else value
        values = np.array([float(cell) for row in rows for cell in (row if isinstance(row, list) else [row])])
        if not np.isfinite(values).all() or count not in (None, len(values)):
            raise ValueError
    except (KeyError, TypeError, ValueError):
        wanted = f"{count or 'a list of'} finite numbers"
        raise ValueError(f"{file} has {name} = {reprlib.repr(value)}; expected {wanted}") from None
    return values
