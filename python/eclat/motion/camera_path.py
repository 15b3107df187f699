# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Paths of a camera: positions and targets at key times, from a JSON file or a dict."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from eclat.errors import EclatError, did_you_mean, shown
from eclat.files.arrays import read_file
from eclat.motion.animation import Joined, Motion, Pose
from eclat.motion.tracks import Track, smooth_track
from eclat.scene import Camera, Scene, look_at
from eclat.typed import typed

INTERPOLATIONS = ("smooth", "linear", "step")
_MEMBERS = ("name", "interpolation", "size", "keys")
_VECTORS: dict[str, tuple[float, float, float] | None] = {"from": None, "to": None, "up": (0.0, 1.0, 0.0)}
_NUMBERS: dict[str, float] = {"fov": 45.0, "focus_distance": 1.0, "aperture_radius": 0.0}
MOST_KEYS = 1_000_000


@typed
def with_camera_path(scene: Scene, path: str | os.PathLike[str] | Mapping[str, Any]) -> Scene:
    """Return the scene with a camera that follows a path. It becomes the first camera of the scene.

    Parameters
    ----------
    path : a JSON file, or a dict of the same form. `keys` is a list of objects with the `time` in seconds, the position
        `from` and the target `to` in metres, and optionally the direction `up` of the picture, the vertical field of view
        `fov` in degrees, `focus_distance` and `aperture_radius` in metres. What a key leaves out is as in the key before
        it. `interpolation` is "smooth" (the default; the camera passes all keys without a jerk), "linear" or "step".
        `name` is the name of the camera, and `size` the width and height of its pictures in pixels.

    Raises
    ------
    EclatError : the file cannot be read, a member is unknown, missing or invalid, times do not increase, or `from` and
        `to` coincide at a key.

    Examples
    --------
    >>> import eclat
    >>> keys = [{"time": 0, "from": [0, 1, 4], "to": [0, 1, 0]}, {"time": 2, "from": [4, 1, 0]}]
    >>> scene = with_camera_path(eclat.load("cornell-box"), {"keys": keys, "interpolation": "linear"})
    >>> scene.at(1.0).cameras[0].to_world[:3, 3].tolist()
    [2.0, 1.0, 2.0]
    """
    where = "camera path" if isinstance(path, Mapping) else os.fspath(path)
    data = path if isinstance(path, Mapping) else _parsed(where)
    camera_at, times, name = _read(data, scene, where)
    rest = camera_at(float(times[0]))

    def pose(time: float) -> Pose:
        moved = camera_at(time)
        return Pose(cameras={"path": moved})

    motion = Motion(Pose(cameras={"path": rest}), pose, float(times[0]), float(times[-1]), cameras=(name,))
    animation = motion if scene.animation is None else Joined(scene.animation, motion)
    return replace(scene, cameras=(rest, *scene.cameras), animation=animation)


def _parsed(where: str) -> Mapping[str, Any]:
    try:
        data = json.loads(read_file(where, where=where))
    except (ValueError, RecursionError) as error:
        if isinstance(error, EclatError):
            raise
        raise EclatError(f"{where}: expected a camera path as JSON, got an error: {error}") from None
    if not isinstance(data, dict):
        raise EclatError(f"{where}: expected a JSON object with a list 'keys', got {shown(data)}")
    return data


def _read(data: Mapping[str, Any], scene: Scene, where: str) -> tuple[Callable[[float], Camera], np.ndarray, str]:
    """Return the camera as a function of the time in seconds, the times of the keys (K,), and its name."""
    _refuse_unknown(data, _MEMBERS, where)
    interpolation = data.get("interpolation", "smooth")
    if interpolation not in INTERPOLATIONS:
        raise EclatError(
            f"{where}, interpolation: expected one of {', '.join(INTERPOLATIONS)}, got {shown(interpolation)}"
        )
    keys = data.get("keys")
    if not isinstance(keys, list | tuple) or not 1 <= len(keys) <= MOST_KEYS:
        raise EclatError(f"{where}: expected a list 'keys' of 1 to {MOST_KEYS:,} keys, got {shown(keys)}")
    rows = _rows(keys, scene, where)
    times = np.array([row["time"] for row in rows], np.float64)
    tracks: dict[str, Track] = {}
    for name in (*_VECTORS, *_NUMBERS):
        values = np.array([np.atleast_1d(row[name]) for row in rows], np.float64)
        try:
            # Fields of view and lengths of lenses must not overshoot.
            smooth = interpolation == "smooth" and name in ("from", "to")
            kind = "step" if interpolation == "step" else "linear"
            tracks[name] = smooth_track(times, values) if smooth else Track(times, values, kind)  # type: ignore[arg-type]
        except EclatError as error:
            raise EclatError(f"{where}, keys: {error}") from None
    size = _size(data.get("size"), where)
    name = data.get("name", "path")
    if not isinstance(name, str):
        raise EclatError(f"{where}, name: expected a string, got {shown(name)}")

    def camera_at(time: float) -> Camera:
        at = {key: track.at(time) for key, track in tracks.items()}
        origin, target, up = (tuple(map(float, at[key])) for key in _VECTORS)
        try:
            matrix = look_at(origin, target, up)  # type: ignore[arg-type]
        except ValueError as error:
            raise EclatError(f"{where}, at {time:g} s: {error}") from None
        return Camera(
            matrix, float(at["fov"][0]), "y", aperture_radius=float(at["aperture_radius"][0]),
            focus_distance=float(at["focus_distance"][0]), size=size, name=name,
        )  # fmt: skip

    for time in times:
        camera_at(float(time))
    return camera_at, times, name


def _rows(keys: list[Any] | tuple[Any, ...], scene: Scene, where: str) -> list[dict[str, Any]]:
    """Return all members of all keys. What a key leaves out is that of the key before it."""
    rows: list[dict[str, Any]] = []
    last: dict[str, Any] = _VECTORS | {"up": scene.up} | _NUMBERS
    for number, key in enumerate(keys):
        place = f"{where}, keys[{number}]"
        if not isinstance(key, Mapping):
            raise EclatError(f"{place}: expected an object with 'time', 'from' and 'to', got {shown(key)}")
        _refuse_unknown(key, ("time", *_VECTORS, *_NUMBERS), place)
        row = last | dict(key)
        for name in ("time", *_NUMBERS):
            row[name] = _number(row.get(name), f"{place}, {name}")
        for name in _VECTORS:
            row[name] = _vector(row[name], f"{place}, {name}")
        if not 0 < row["fov"] < 180:
            raise EclatError(f"{place}, fov: expected degrees between 0 and 180, got {row['fov']:g}")
        if row["focus_distance"] <= 0 or row["aperture_radius"] < 0:
            raise EclatError(f"{place}: expected a focus_distance above 0 and an aperture_radius of at least 0")
        last = {name: value for name, value in row.items() if name != "time"}
        rows.append(row)
    return rows


def _number(value: Any, where: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < 1e30:
        raise EclatError(f"{where}: expected a finite number, got {shown(value)}")
    return float(value)


def _vector(value: Any, where: str) -> tuple[float, float, float]:
    if not isinstance(value, list | tuple) or len(value) != 3:
        raise EclatError(f"{where}: expected three numbers, got {shown(value)}")
    x, y, z = (_number(part, where) for part in value)
    return x, y, z


def _size(value: Any, where: str) -> tuple[int, int] | None:
    if value is None:
        return None
    good = isinstance(value, list | tuple) and len(value) == 2 and all(type(part) is int and part > 0 for part in value)
    if not good:
        raise EclatError(f"{where}, size: expected a width and a height in pixels, got {shown(value)}")
    return value[0], value[1]


def _refuse_unknown(data: Mapping[str, Any], known: tuple[str, ...], where: str) -> None:
    for name in data:
        if name not in known:
            raise EclatError(
                f"{where}: expected members among {', '.join(known)}, got {shown(name)}{did_you_mean(str(name), known)}"
            )
