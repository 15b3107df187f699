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
from eclat.images.ktx2 import encode_ktx2, ktx2_scale
from eclat.images.tone import srgb_encode
from eclat.lightmap.directional import Directional, for_godot, for_unity
from eclat.lightmap.flat import encode_flat
from eclat.lightmap.levels import smaller_levels
from eclat.scene import FloatArray, Scene
from eclat.typed import typed

VERSION = 1
"""Version of the format of the JSON file."""

CLIPPED_SHARE = 0.002
"""Share of the lit texels (0..1) that may be clipped in the embedded 8-bit image, so that it resolves the others more
finely."""


@dataclass(frozen=True, eq=False)
class Lightmap:
    """The irradiance on all surfaces of a scene.

    `irradiance` (H, W, 3) is float32 in W·m⁻², or in lux if the scene is photometric. It holds `page_count` pages of equal
    height, one below the other; row 0 of a page is at v = 0, and each spans the texture coordinates (0, 0) to (1, 1).
    `parts` are the meshes of the scene, with their vertices split at the borders of charts and with `lightmap_uvs` of their
    `lightmap_page`. `texel_size` is in metres, `gutter` in texels. `statistics` holds the numbers of texels, rays, charts
    and pages, the seconds, and the area in m². `settings` are the options with which the map was baked. `harmonics` (H, W,
    4, 3) are the coefficients of a directional map, in W·m⁻² or lux (`lightmap.directional`), or None. `used` (H, W) marks
    the texels that surfaces use, and `apart` is the number of texels between those whose light must not be mixed; of these, the
    levels of a mip map are made. Without `used`, there is only one.
    """

    scene: Scene
    parts: tuple[Part, ...]
    irradiance: NDArray[np.float32]
    texel_size: float
    component: str
    method: str
    gutter: int
    page_count: int = 1
    harmonics: NDArray[np.float32] | None = None
    used: NDArray[np.bool_] | None = None
    apart: float = 0.0
    statistics: dict[str, float] = field(default_factory=dict)
    settings: dict[str, Any] = field(default_factory=dict)

    def __repr__(self) -> str:
        what = f"{self.component} light by {self.method}"
        return (
            f"<Lightmap of {self.scene.name or 'a scene'}: {self.size_text()} texels of {self.texel_size:g} m, {what}>"
        )

    def size_text(self) -> str:
        """Describe the size in texels, as in "1024 x 512" or "3 pages of 1024 x 512"."""
        height, width, _ = self.irradiance.shape
        one = f"{width} x {height // self.page_count}"
        return one if self.page_count == 1 else f"{self.page_count} pages of {one}"

    @property
    def pages(self) -> list[NDArray[np.float32]]:
        """The pages, (height, W, 3) each."""
        return np.split(self.irradiance, self.page_count)

    def levels(self, page: int) -> list[NDArray[np.float32]]:
        """Return a page and the smaller levels of its mip map, as many as do not mix the light of charts (`lightmap.levels`)."""
        image = self.pages[page]
        if self.used is None:
            return [image]
        return [image, *smaller_levels(image, np.split(self.used, self.page_count)[page], self.apart)]

    def stacked_uvs(self) -> list[FloatArray]:
        """Return for each part its coordinates (V, 2) in the image of all pages, `irradiance`."""
        found = []
        for part in self.parts:
            assert part.lightmap_uvs is not None
            found.append((part.lightmap_uvs + np.array([0, part.lightmap_page])) / np.array([1, self.page_count]))
        return found

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
    def save(
        self, path: str | os.PathLike[str], *, ktx2: bool = False, directional: Directional | None = None
    ) -> list[Path]:
        """Write the files `room_lit.glb`, `room_lit.lightmap.exr` and `room_lit.lightmap.json`, and return all paths.

        The .glb holds the scene and its light map as MOZ_lightmap with 8 bits per channel; the .exr holds the same map
        in single precision; the .json describes both. Further pages are in `room_lit.lightmap.2.exr` and so on. Either all
        files are written or none. If the process is killed between two renames, the .glb is the previous one, and its
        `lightmap_set` differs from `set` in the .json.

        Parameters
        ----------
        ktx2 : whether to write each page also as `room_lit.lightmap.ktx2`, in half precision, for graphics cards, with the
            smaller levels of a mip map in which charts do not mix: n with a `gutter` of 2ⁿ.
        directional : the layout in which to write from where the light comes: "sh", the coefficients, as layers of an .exr;
            "godot", four slices of an .exr; "unity", a .png beside the .exr. The map must be baked with `directional`.

        Raises
        ------
        EclatError : the name does not end in .glb, a file cannot be written, or the map holds no directions.
        """
        if directional is not None and self.harmonics is None:
            raise EclatError("directional: the light map holds no directions; bake it with directional=True")
        target = Path(path)
        glb, exr, side_car = output_names(target)
        check_writable(target)
        intensity, generator = self.intensity(), f"eclat {eclat.__version__}"
        note = quote(side_car.name)
        files: dict[str | os.PathLike[str], bytes] = {}
        pages = []
        for number, page in enumerate(self.pages):
            described = self._page_files(number, page, exr, ktx2, directional)
            files |= {exr.with_name(name): data for name, data in described.values()}
            pages.append(
                {kind: name for kind, (name, _) in described.items()}
                | {"width": int(page.shape[1]), "height": int(page.shape[0])}
                | {"gltf_texture": LIGHTMAP_TEXTURE + number, "intensity": intensity}
                | ({"ktx2_scale": ktx2_scale(page)} if ktx2 else {})
            )
        for name in (side_car, *files):
            check_writable(name)
        # A crash between two renames can leave files of two bakes. The scene, whose own map is complete, is renamed last,
        # and readers ignore a description that does not have the scene's mark.
        mark = hashlib.sha256(b"".join(files.values())).hexdigest()[:32]
        extras = {"eclat": {"lightmap": note}}
        data = encode_glb(
            self.scene,
            self.parts,
            lightmaps=[LightmapTexture(png(page, intensity), intensity, extras) for page in self.pages],
            lights=self.component == "indirect",
            generator=generator,
            notes={"lightmap": note, "lightmap_set": mark},
        )
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
            "pages": pages,
            "directional": directional,
            "exposure": None,
            "statistics": self.statistics | {"clipped_share": self.clipped_share()},
            "settings": self.settings,
        }
        text = json.dumps(description, ensure_ascii=False, indent=2).encode() + b"\n"
        write_files({side_car: text} | files | {glb: data})
        return [glb, exr, side_car, *(Path(name) for name in files if Path(name) != exr)]

    def _page_files(
        self, number: int, page: NDArray[np.float32], exr: Path, ktx2: bool, directional: Directional | None
    ) -> dict[str, tuple[str, bytes]]:
        """Encode the files of one page: what each is called in the description, with its name and its bytes."""
        about = {"unit": self.unit, "component": self.component}
        stem = exr.name.removesuffix(".exr") + (f".{number + 1}" if number else "")
        files = {"exr": (f"{stem}.exr", encode_exr(page, {}, about, {}))}
        if ktx2:
            scale = np.float32(ktx2_scale(page))
            files["ktx2"] = (f"{stem}.ktx2", encode_ktx2([level / scale for level in self.levels(number)]))
        if directional is not None and self.harmonics is not None:
            own = np.split(self.harmonics, self.page_count)[number]
            ending, data = encode_directional(own, page, directional, about)
            files["directional"] = (f"{stem}.{directional}.{ending}", data)
        return files

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


def png(page: NDArray[np.float32], intensity: float) -> bytes:
    """Encode a page (H, W, 3) as a PNG with 8 bits per channel, sRGB-encoded, in which white represents `intensity`."""
    scaled = srgb_encode(page.astype(np.float64) / intensity)
    file = io.BytesIO()
    PillowImage.fromarray(np.rint(scaled * 255).astype(np.uint8)).save(file, format="PNG")
    return file.getvalue()


def encode_directional(
    harmonics: NDArray[np.float32], irradiance: NDArray[np.float32], layout: Directional, about: dict[str, Any]
) -> tuple[str, bytes]:
    """Encode coefficients (H, W, 4, 3) in the layout of an engine; return the ending of the file's name and its bytes."""
    if layout == "unity":
        file = io.BytesIO()
        PillowImage.fromarray(for_unity(harmonics, irradiance)).save(file, format="PNG")
        return "png", file.getvalue()
    if layout == "godot":
        return "exr", encode_exr(for_godot(harmonics), {}, about, {})
    names = {f"l1{axis}": np.ascontiguousarray(harmonics[:, :, 1 + i]) for i, axis in enumerate("yzx")}
    return "exr", encode_exr(np.ascontiguousarray(harmonics[:, :, 0]), names, about, {})


def output_names(path: str | os.PathLike[str]) -> tuple[Path, Path, Path]:
    """Return the paths of the .glb, .exr and .json files. Raises EclatError if the name does not end in .glb."""
    target = Path(path)
    if target.suffix.lower() != ".glb":
        raise EclatError(f"{os.fspath(path)}: expected a name that ends in .glb")
    return target, target.with_suffix(".lightmap.exr"), target.with_suffix(".lightmap.json")
