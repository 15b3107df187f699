# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A light map, and its files: a glTF scene, an EXR image, and a description of both in JSON."""

from __future__ import annotations

import hashlib
import io
import json
import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np
from numpy.typing import NDArray
from PIL import Image as PillowImage

import eclat
from eclat.errors import EclatError
from eclat.files.atomic_file import check_writable, write_file, write_files
from eclat.gltf_export import LIGHTMAP_TEXTURE, LightmapTexture, Part, encode_glb
from eclat.images.exr import encode_exr
from eclat.images.tone import srgb_encode
from eclat.lightmap.flat import encode_flat
from eclat.scene import Scene
from eclat.typed import typed

VERSION = 1
"""Version of the format of the JSON file."""

CLIPPED_SHARE = 0.002
"""Share of the lit texels (0..1) that may be clipped in the embedded 8-bit image, so that it resolves the others more
finely."""


@dataclass(frozen=True, eq=False)
class Lightmap:
    """The irradiance on all surfaces of a scene.

    `irradiance` (H, W, 3) is float32 in W·m⁻², or in lux if the scene is photometric; row 0 is at v = 0, and the whole
    image spans the texture coordinates (0, 0) to (1, 1). `parts` are the meshes of the scene, with their vertices split
    at the borders of charts and with `lightmap_uvs`. `texel_size` is in metres, `gutter` in texels. `statistics` holds
    the numbers of texels, rays and charts, the seconds, and the area in m². `settings` are the options with which the
    map was baked.
    """

    scene: Scene
    parts: tuple[Part, ...]
    irradiance: NDArray[np.float32]
    texel_size: float
    component: str
    method: str
    gutter: int
    statistics: dict[str, float] = field(default_factory=dict)
    settings: dict[str, Any] = field(default_factory=dict)

    def __repr__(self) -> str:
        height, width, _ = self.irradiance.shape
        what = f"{self.component} light by {self.method}"
        return (
            f"<Lightmap of {self.scene.name or 'a scene'}: {width} x {height} texels of {self.texel_size:g} m, {what}>"
        )

    @property
    def unit(self) -> str:
        """The unit of the irradiance, "W/m2" or "lux"."""
        return "lux" if self.scene.photometric else "W/m2"

    def intensity(self) -> float:
        """Return the irradiance that the value 1 of the embedded 8-bit image represents.

        It is the largest irradiance, or less if a few texels are far brighter than the rest; these are clipped.
        """
        largest = np.max(self.irradiance, axis=2)
        lit = largest[largest > 0]
        if not len(lit):
            return 1.0
        most = float(lit.max())
        usual = float(np.quantile(lit, 1 - CLIPPED_SHARE))
        return most if most < 1.5 * usual else usual

    def clipped_share(self) -> float:
        """Return the share of the lit texels (0..1) whose irradiance is above `intensity()` in any channel."""
        largest = np.max(self.irradiance, axis=2)
        lit = largest > 0
        return float((largest[lit] > self.intensity()).mean()) if lit.any() else 0.0

    @typed
    def save(self, path: str | os.PathLike[str]) -> list[Path]:
        """Write the files `room_lit.glb`, `room_lit.lightmap.exr` and `room_lit.lightmap.json`, and return their paths.

        The .glb holds the scene and its light map as MOZ_lightmap with 8 bits per channel; the .exr holds the same map
        in single precision; the .json describes both. Either all three files are written or none. If
        the process is killed between two renames, the .glb is the previous one, and its `lightmap_set` differs from
        `set` in the .json.

        Raises
        ------
        EclatError : the name does not end in .glb, or a file cannot be written.
        """
        target = Path(path)
        names = output_names(target)
        for name in names:
            check_writable(name)
        glb, exr, side_car = names
        intensity, generator = self.intensity(), f"eclat {eclat.__version__}"
        note = quote(side_car.name)
        picture = encode_exr(self.irradiance, {}, {"unit": self.unit, "component": self.component}, {})
        # A crash between two renames can leave files of two bakes. The scene, whose own map is complete, is renamed last,
        # and readers ignore a description that does not have the scene's mark.
        mark = hashlib.sha256(picture).hexdigest()[:32]
        data = encode_glb(
            self.scene,
            self.parts,
            lightmap=LightmapTexture(self.png(intensity), intensity, {"eclat": {"lightmap": note}}),
            lights=self.component == "indirect",
            generator=generator,
            notes={"lightmap": note, "lightmap_set": mark},
        )
        page = {
            "exr": exr.name,
            "width": int(self.irradiance.shape[1]),
            "height": int(self.irradiance.shape[0]),
            "gltf_texture": LIGHTMAP_TEXTURE,
            "intensity": intensity,
        }
        description = {
            "version": VERSION,
            "generator": generator,
            "glb": glb.name,
            "set": mark,
            "method": self.method,
            "component": self.component,
            "unit": self.unit,
            "texel_size": self.texel_size,
            "gutter": self.gutter,
            "pages": [page],
            "exposure": None,
            "statistics": self.statistics | {"clipped_share": self.clipped_share()},
            "settings": self.settings,
        }
        text = json.dumps(description, ensure_ascii=False, indent=2).encode() + b"\n"
        write_files({side_car: text, exr: picture, glb: data})
        return list(names)

    @typed
    def save_flat(
        self, path: str | os.PathLike[str], exposure: float | None = None, tone_mapping: str = "none"
    ) -> Path:
        """Write one .glb for viewers that do not support light maps, with the light of the surfaces in unlit materials.

        Parameters
        ----------
        exposure : exposure in stops. Radiance is multiplied by 2^exposure, and 1 is then white. None chooses it so that
            few texels are clipped at white.
        tone_mapping : "none" or "filmic", as for pictures.

        Raises
        ------
        EclatError : the name does not end in .glb, the file cannot be written, or the exposure is out of range.
        """
        target = output_names(path)[0]
        write_file(target, encode_flat(self, exposure, tone_mapping, f"eclat {eclat.__version__}"))
        return target

    def png(self, intensity: float) -> bytes:
        """Encode the map as a PNG with 8 bits per channel, sRGB-encoded, in which white represents `intensity`."""
        scaled = srgb_encode(self.irradiance.astype(np.float64) / intensity)
        file = io.BytesIO()
        PillowImage.fromarray(np.rint(scaled * 255).astype(np.uint8)).save(file, format="PNG")
        return file.getvalue()


def output_names(path: str | os.PathLike[str]) -> tuple[Path, Path, Path]:
    """Return the paths of the .glb, .exr and .json files. Raises EclatError if the name does not end in .glb."""
    target = Path(path)
    if target.suffix.lower() != ".glb":
        raise EclatError(f"{os.fspath(path)}: expected a name that ends in .glb")
    return target, target.with_suffix(".lightmap.exr"), target.with_suffix(".lightmap.json")
