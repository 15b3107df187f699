# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Pictures that can be continued: their layers hold the sums of the samples, to which later samples are added.

Sample n of a pixel depends only on the seed, the pixel and n. Therefore, 4 samples continued by 12 give the same bits
as 16 samples at once, if the records are the same and a pass ends at the first number: with adaptive sampling this is
so for powers of two, and otherwise for any number. Other numbers give a different picture, but always the same one.
"""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eclat import _core
from eclat.bridge.compiled import fingerprint
from eclat.errors import EclatError
from eclat.images.image import Image
from eclat.sampling.convergence import Sampling
from eclat.sampling.halves import Halves
from eclat.scene import Camera, Scene

FORMAT = 1
"""Version of the layers and metadata, which is incremented whenever they change."""

KEY = "continuable"
"""The key of the metadata of such a picture."""

FROM_PICTURE = ("size", "crop", "max_depth", "seed", "filter", "adaptive", "halves")
"""The arguments of `render` that a continued picture determines."""

GATHERED = "gathered_"
"""What the names of the layers begin with that hold the samples of a final gather (`gathered_picture`)."""

Layers = dict[str, NDArray[np.float32]]


@dataclass(frozen=True, eq=False)
class Begun:
    """A picture that is to be continued. `state` is the part of its metadata that continuing needs, and `name` is its
    name in messages.
    """

    image: Image
    state: dict[str, Any]
    name: str

    @staticmethod
    def of(picture: Image | str | os.PathLike[str]) -> Begun:
        """Prepare an Image for continuing, or read one from an .exr file.

        Raises EclatError if it cannot be read or continued, or if the layers that continuing needs are missing or
        damaged.
        """
        image, name = (
            (picture, "continued") if isinstance(picture, Image) else (Image.load(picture), os.fspath(picture))
        )
        state = image.metadata.get(KEY)
        if not isinstance(state, dict):
            raise EclatError(
                f"{name}: expected a picture that can be continued, got one without the samples of each pixel; render it with "
                "--continuable to an .exr file, or with continuable=True"
            )
        if state.get("format") != FORMAT:
            raise EclatError(f"{name}: expected a continuable picture of format {FORMAT}, got {state.get('format')!r}")
        if checksum_of(image.layers) != state.get("checksum"):
            raise EclatError(f"{name}: expected the layers of samples as Éclat wrote them, got damaged ones")
        return Begun(image, state, name)

    def settings(self, defaults: tuple[Any, ...], given: tuple[Any, ...]) -> tuple[Any, ...]:
        """Return the arguments in `FROM_PICTURE` with the values of the picture. Raises EclatError if a different value
        was given for one of them.
        """
        settings = []
        for name, default, value in zip(FROM_PICTURE, defaults, given, strict=True):
            own = self.state[name]
            settings.append(tuple(own) if isinstance(own, list) else own)
            if value not in (default, settings[-1]):
                raise EclatError(
                    f"{self.name}: {name} cannot change when a picture is continued, expected {settings[-1]}, got {value}"
                )
        return tuple(settings)

    @property
    def samples(self) -> int:
        """The number of samples per pixel that the picture has."""
        return int(self.image.metadata["statistics"]["samples"])

    def require_match(self, scene: Scene, camera: Camera, method: str, samples: int | None) -> None:
        """Raise EclatError if the picture has another scene, camera or method, or already has the requested number of
        samples.
        """
        if self.state["scene"] != fingerprint(scene):
            raise EclatError(
                f"{self.name}: expected a picture of the same scene, got one with other geometry, materials or lights; "
                "render it anew"
            )
        if self.state["camera"] != fingerprint_of_camera(camera):
            raise EclatError(
                f"{self.name}: expected a picture with the same position, direction and lens of the camera, got another"
            )
        if self.image.metadata.get("method") != method:
            raise EclatError(f"{self.name}: expected the method {self.image.metadata.get('method')}, got {method}")
        if samples is not None and samples <= self.samples:
            raise EclatError(f"samples: expected more than the {self.samples} that {self.name} has, got {samples}")

    def restore(self, sampling: Sampling, kind: str = "") -> None:
        """Copy the sums of the picture into the empty films of `sampling`, and restore the state of `sampling`. `kind` is "" or
        `GATHERED`; a picture without samples of that kind changes nothing.
        """
        layers = {name.removeprefix(kind): v for name, v in self.image.layers.items() if name.startswith(kind)}
        if "sums_0_00" not in layers:
            return
        for number, film in enumerate(_films(sampling)):
            parts = [layers[name] for name in sorted(layers) if name.startswith(f"sums_{number}_")]
            film.restore(np.ascontiguousarray(np.concatenate(parts, axis=2)))
        if sampling.adaptive is not None:
            begun = {name.removeprefix("sample_"): v for name, v in layers.items() if name.startswith("sample_")}
            sampling.adaptive.restore(begun, sampling.film.radiance)
        sampling.take_up(int(self.image.metadata["statistics"][f"{kind}samples"]))

    def add_bad_samples(self, image: Image) -> None:
        """Add the samples of the previous run that were not finite to the count; the first of them stays the first."""
        before, after = (picture.metadata.get("bad_samples") for picture in (self.image, image))
        if before:
            more = after["count"] if after else 0
            image.metadata["bad_samples"] = {"count": before["count"] + more, "first": before["first"]}


def make_continuable(
    image: Image,
    begun: Begun | None,
    samplings: tuple[Sampling, Sampling | None],
    scene: Scene,
    camera: Camera,
    settings: tuple[Any, ...],
) -> None:
    """Add layers and metadata to a finished picture, so that it can be continued.

    `begun` is the picture that was continued, if it was one, `samplings` are its samples and those of its final gather, if it has
    one, and `settings` are those of `FROM_PICTURE`.
    """
    if begun is not None:
        begun.add_bad_samples(image)
    layers: Layers = {}
    for kind, sampling in zip(("", GATHERED), samplings, strict=True):
        if sampling is not None:
            layers |= {kind + name: layer for name, layer in _layers_of(sampling).items()}
    image.layers.update({name: np.ascontiguousarray(layer, np.float32) for name, layer in layers.items()})
    image.metadata[KEY] = {
        "format": FORMAT, "scene": fingerprint(scene), "camera": fingerprint_of_camera(camera),
        "checksum": checksum_of(image.layers),
        **{name: list(v) if isinstance(v, tuple) else v for name, v in zip(FROM_PICTURE, settings, strict=True)},
    }  # fmt: skip


def _layers_of(sampling: Sampling) -> Layers:
    layers: Layers = {}
    for number, film in enumerate(_films(sampling)):
        sums = np.asarray(film.sums(), np.float32)
        for first in range(0, sums.shape[2], 3):
            layers[f"sums_{number}_{first // 3:02}"] = sums[..., first : first + 3]
    if sampling.adaptive is not None:
        layers |= {f"sample_{name}": layer for name, layer in sampling.adaptive.state().items()}
    return layers


def fingerprint_of_camera(camera: Camera) -> str:
    """Compute a hash of the properties of a camera that affect the picture, which excludes its name and preferred size."""
    seen = {name: getattr(camera, name) for name in camera.__dataclass_fields__ if name not in ("name", "size")}
    seen["to_world"] = np.asarray(camera.to_world, np.float64).tolist()
    return hashlib.sha256(repr(sorted(seen.items())).encode()).hexdigest()[:32]


def _films(sampling: Sampling) -> list[_core.Film]:
    film = sampling.film
    return [film.even, film.odd] if isinstance(film, Halves) else [film]


def checksum_of(layers: Layers) -> str:
    """Compute a hash of those layers by which a picture can be continued."""
    return _checksum(_state_of(layers))


def _state_of(layers: Layers) -> Layers:
    return {name: layer for name, layer in layers.items() if name.startswith(("sums_", "sample_", GATHERED))}


def _checksum(layers: Layers) -> str:
    digest = hashlib.sha256()
    for name in sorted(layers):
        digest.update(f"{name} {layers[name].shape}".encode())
        digest.update(np.ascontiguousarray(layers[name]).tobytes())
    return digest.hexdigest()[:32]
