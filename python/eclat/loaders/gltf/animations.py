# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Read animations [glTF 2.0, 3.11; KHR_animation_pointer], and change the JSON of a file to its values at a time.

A channel that is invalid or not supported is left out with a warning: a scene that can be shown at rest is loaded.
"""

from __future__ import annotations

import copy
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, warn
from eclat.loaders.gltf.accessors import Accessors
from eclat.loaders.gltf.container import Document
from eclat.loaders.gltf.element import Element
from eclat.loaders.parts import MOST_NAMED
from eclat.motion.tracks import Interpolation, Track

_POINTER = "KHR_animation_pointer"
_MODES: dict[str, Interpolation] = {"LINEAR": "linear", "STEP": "step", "CUBICSPLINE": "cubic"}
_LIGHTS = ("extensions", "KHR_lights_punctual", "lights")
_OF_NODES = ("translation", "rotation", "scale", "weights")
_WIDTHS = {"translation": 3, "rotation": 4, "scale": 3}
_SCALARS = ("SCALAR", "VEC2", "VEC3", "VEC4")

Steps = tuple[str | int, ...]


@dataclass(frozen=True, eq=False)
class Channel:
    """One animated property: the way to it in the JSON of the file, and its value over time.

    `scalar` says whether the property is a number and not a list of numbers.
    """

    steps: Steps
    track: Track
    scalar: bool = False


@dataclass(frozen=True, eq=False)
class Channels:
    """The animated properties of a file."""

    channels: tuple[Channel, ...]

    @property
    def start(self) -> float:
        """The time of the first key in seconds."""
        return min(float(c.track.times[0]) for c in self.channels)

    @property
    def end(self) -> float:
        """The time of the last key in seconds."""
        return max(float(c.track.times[-1]) for c in self.channels)

    def of(self, *kind: str, among: tuple[str, ...] = ()) -> set[int]:
        """Return the indices of the elements of a list, such as "nodes", of which a property changes.

        `among` limits this to properties of these names.
        """
        count = len(kind)
        return {
            cast(int, c.steps[count])
            for c in self.channels
            if c.steps[:count] == kind and c.track.moves and (not among or c.steps[-1] in among)
        }

    def at(self, root: dict[str, Any], time: float) -> dict[str, Any]:
        """Return the JSON of the file with the values at a time in seconds. The given JSON is not changed."""
        kinds = {cast(str, c.steps[0]) for c in self.channels}
        changed = root | {kind: copy.deepcopy(root[kind]) for kind in kinds}
        for channel in self.channels:
            value = channel.track.at(time).tolist()
            _set(changed, channel.steps, value[0] if channel.scalar else value)
        return changed


def read_animations(document: Document, accessors: Accessors) -> Channels | None:
    """Read all animations of a file, which play at the same time; None if there are none that can be used.

    Of several channels for one property, the first one is used.
    """
    channels: dict[Steps, Channel] = {}
    errors: list[str] = []
    twice = 0
    try:
        found = [(sampler, channel) for sampler, channel in _channels(document, errors)]
    except EclatError as error:
        errors.append(str(error))
        found = []
    for sampler, element in found:
        try:
            channel = _read_channel(document, accessors, element, sampler)
        except EclatError as error:
            errors.append(str(error))
            continue
        if channel is not None:
            twice += channel.steps in channels
            channels.setdefault(channel.steps, channel)
    for text in errors[:MOST_NAMED]:
        warn(f"{text}; this channel of the animation is left out")
    if len(errors) > MOST_NAMED:
        warn(f"{len(errors) - MOST_NAMED} more channels of animations are left out, because they are invalid too")
    if twice:
        warn(
            f"{document.name}: {twice} channels animate a property that an earlier channel animates, as in files with several "
            "animations of one object; the first channel of each property is used"
        )
    return Channels(tuple(channels.values())) if channels else None


def _channels(document: Document, errors: list[str]) -> list[tuple[Element, Element]]:
    """Return the sampler and the channel of all channels whose sampler exists; the others go to `errors`."""
    found = []
    for animation in document.elements("animations"):
        try:
            samplers, channels = animation.children("samplers"), animation.children("channels")
        except EclatError as error:
            errors.append(str(error))
            continue
        for channel in channels:
            try:
                index = channel.index("sampler", len(samplers), "samplers")
                if index is None:
                    raise EclatError(
                        f"{channel.where}: expected the index of a sampler as 'sampler', but it is missing"
                    )
                found.append((samplers[index], channel))
            except EclatError as error:
                errors.append(str(error))
    return found


def _read_channel(document: Document, accessors: Accessors, element: Element, sampler: Element) -> Channel | None:
    """Read a channel. A channel without a target has no effect, and the result is None, as the specification requires."""
    target = element.child("target")
    if target is None:
        raise EclatError(f"{element.where}: expected an object as 'target', but it is missing")
    steps = _steps(document, target)
    if steps is None:
        return None
    mode = sampler.text("interpolation", "LINEAR")
    if mode not in _MODES:
        raise EclatError(f"{sampler.at('interpolation')}: expected one of {', '.join(_MODES)}, got {mode[:20]!r}")
    times = accessors.floats(sampler, "input", ("SCALAR",))
    values = accessors.floats(sampler, "output", _SCALARS)
    if times is None or values is None:
        missing = "input" if times is None else "output"
        raise EclatError(f"{sampler.where}: expected the index of an accessor as {missing!r}, but it is missing")
    old = _get(document.root.data, steps, element)
    scalar = isinstance(old, int | float) if old is not None else values.shape[1] == 1 and steps[-1] != "weights"
    shaped = _shaped(times, values, _MODES[mode], steps, sampler)
    width = shaped.shape[-1]
    expected = _WIDTHS.get(str(steps[-1])) if steps[0] == "nodes" else len(old) if isinstance(old, list) else None
    if expected not in (None, width) or (scalar and width != 1):
        raise EclatError(f"{sampler.where}: expected {expected or 1} numbers a key for {_pointer(steps)}, got {width}")
    rotation = steps[0] == "nodes" and steps[-1] == "rotation"
    try:
        track = Track(times[:, 0].astype(np.float64), shaped, _MODES[mode], rotation)
    except EclatError as error:
        raise EclatError(f"{sampler.where}: {error}") from None
    return Channel(steps, track, scalar)


def _shaped(
    times: NDArray[np.float32], values: NDArray[np.float32], mode: Interpolation, steps: Steps, sampler: Element
) -> NDArray[np.float64]:
    """Return the values of the keys in the shape that `Track` takes."""
    rows = len(times) * (3 if mode == "cubic" else 1)
    if rows == 0 or len(values) % rows or (len(values) != rows and steps[-1] != "weights"):
        raise EclatError(
            f"{sampler.where}: expected as many values as {len(times)} keys need for {mode} interpolation, got {len(values)}"
        )
    with np.errstate(invalid="ignore"):  # NaN, which Track refuses
        wide = values.astype(np.float64)
    # The weights of one key follow each other in an accessor of single numbers.
    return wide.reshape(len(times), 3, -1) if mode == "cubic" else wide.reshape(len(times), -1)


def _steps(document: Document, target: Element) -> Steps | None:
    """Return the way to the property that a channel animates, or None if the channel has no target."""
    path = target.text("path")
    if path == "pointer":
        extension = target.extension(_POINTER)
        if extension is None:
            raise EclatError(f"{target.where}: expected the extension {_POINTER} for the path 'pointer', got none")
        return _parsed(extension.text("pointer"), extension)
    if path not in _OF_NODES:
        raise EclatError(f"{target.at('path')}: expected one of {', '.join(_OF_NODES)} or pointer, got {path[:20]!r}")
    index = target.index("node", len(document.elements("nodes")), "nodes")
    return None if index is None else ("nodes", index, path)


def _parsed(pointer: str, where: Element) -> Steps:
    """Parse a JSON pointer [RFC 6901] to a property that can be animated."""
    texts = [text.replace("~1", "/").replace("~0", "~") for text in pointer.split("/")[1:]]
    steps: Steps = tuple(int(text) if text.isdecimal() and len(text) < 10 else text for text in texts)
    count = 3 if steps[:3] == _LIGHTS else 1
    known = steps[:count] == _LIGHTS or (len(steps) > 2 and steps[0] in ("nodes", "materials", "cameras", "meshes"))
    if not pointer.startswith("/") or not known or len(steps) < count + 2 or not isinstance(steps[count], int):
        raise EclatError(
            f"{where.at('pointer')}: expected a property of a node, a mesh, a material, a camera or a light, got "
            f"{pointer[:80]!r}, whose animation is not supported"
        )
    if (steps[0] == "nodes" and steps[2] not in _OF_NODES) or (steps[0] == "meshes" and steps[2:] != ("weights",)):
        raise EclatError(f"{where.at('pointer')}: the animation of {pointer[:80]!r} is not supported")
    return steps


def _pointer(steps: Steps) -> str:
    return "/" + "/".join(map(str, steps))


def _get(root: Any, steps: Steps, where: Element) -> Any:
    """Return the value of a property, or None if it is absent. Raises EclatError if the object that has it is missing."""
    for number, step in enumerate(steps):
        if isinstance(root, list) and isinstance(step, int) and step < len(root):
            root = root[step]
        elif isinstance(root, dict) and isinstance(step, str):
            if step not in root and number == len(steps) - 1:
                return None
            root = root.get(step)
        else:
            raise EclatError(f"{where.where}: expected a property that exists, got {_pointer(steps)!r}")
    return root


def _set(root: dict[str, Any], steps: Steps, value: Any) -> None:
    owner: Any = root
    for step in steps[:-1]:
        owner = owner[step]
    owner[steps[-1]] = value
    if steps[0] == "nodes":
        # A matrix would hide the animated parts. The specification excludes it for animated nodes.
        owner.pop("matrix", None)
