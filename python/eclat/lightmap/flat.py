# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A lit scene for viewers that do not support light maps: one texture, used by unlit materials, holds the light that
all surfaces reflect and emit.

A texel holds the radiance ρ/π · E + Lₑ, for the albedo ρ, the irradiance E and the emitted radiance Lₑ, scaled to the
range of a screen. Viewers show unlit materials [KHR_materials_unlit] in exactly their colour. The textures of the scene
are reduced to the resolution of the map, and glossy surfaces are treated as diffuse.
"""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from PIL import Image as PillowImage

from eclat.gltf_export import Part
from eclat.gltf_export.document import Document, Json
from eclat.gltf_export.geometry import bounding_box, primitive
from eclat.gltf_export.metallic_roughness import as_metallic_roughness
from eclat.gltf_export.nodes import camera_node
from eclat.gltf_export.textures import Textures, constant_of, texels
from eclat.images.tone import TONE_MAPPINGS, check_display, srgb_encode
from eclat.lightmap.atlas import Atlas, Unwrapped
from eclat.lightmap.gutters import dilate
from eclat.lightmap.sides import reflects_diffusely
from eclat.lightmap.texels import Ints, Texels, corners_of, rasterize
from eclat.scene import DEFAULTS, FloatArray, Scene, Value

WHITE_QUANTILE = 0.95
"""Share of the lit texels that are darker than white (0..1) if the caller gives no exposure; the others are clipped."""


class LitParts(Protocol):
    """The parts of a light map that are needed to compute colours."""

    @property
    def scene(self) -> Scene:
        """The scene whose cameras go into the file."""

    @property
    def parts(self) -> tuple[Part, ...]:
        """The meshes with their coordinates in the map."""

    @property
    def irradiance(self) -> NDArray[np.float32]:
        """The irradiance of all texels, (H, W, 3): the pages one below the other."""

    @property
    def page_count(self) -> int:
        """The number of pages."""

    def stacked_uvs(self) -> list[FloatArray]:
        """Return the coordinates of each part in the image of all pages."""

    @property
    def gutter(self) -> int:
        """The distance between charts in texels."""


def encode_flat(lightmap: LitParts, exposure: float | None, tone_mapping: str, generator: str) -> bytes:
    """Encode a binary glTF file with unlit materials.

    `exposure` is in stops; None chooses it so that few texels are clipped at white. `tone_mapping` is a key of
    `TONE_MAPPINGS`. Raises EclatError if either is out of range.
    """
    check_display(0.0 if exposure is None else exposure, tone_mapping)
    radiance, opacity = _radiance_and_opacity(lightmap)
    scale = _scale(radiance) if exposure is None else 2.0**exposure

    def shown(linear: FloatArray) -> FloatArray:
        return np.clip(TONE_MAPPINGS[tone_mapping](linear * scale), 0, 1)

    pixels = np.concatenate((srgb_encode(shown(radiance)), opacity[..., None]), axis=2)
    if (opacity == 1).all():
        pixels = pixels[..., :3]
    document = Document(generator)
    textures = Textures(document, {0: 0, 1: 0})
    shown_pages = []
    for page in np.split(np.rint(pixels * 255).astype(np.uint8), lightmap.page_count):
        file = io.BytesIO()
        PillowImage.fromarray(page).save(file, format="PNG")
        image = document.add("images", {"bufferView": document.view(file.getvalue()), "mimeType": "image/png"})
        shown_pages.append(textures.texture(image, ("clamp", "clamp"), mipmaps=False))
    nodes, known = [], {}
    for part in lightmap.parts:
        material = part.mesh.material
        key = id(material), part.one_of_two, part.lightmap_page
        if key not in known:
            texture = shown_pages[part.lightmap_page]
            known[key] = document.add("materials", _unlit(document, part, texture, shown))
        bare = replace(part.mesh, uvs=part.lightmap_uvs, uvs2=None, colors=None, tangents=None)
        mesh = {"name": bare.name, "primitives": [primitive(document, Part(bare), known[key])]}
        nodes.append(document.add("nodes", {"name": bare.name, "mesh": document.add("meshes", mesh)}))
    bounds = bounding_box(lightmap.parts)
    nodes += [camera_node(document, camera, bounds) for camera in lightmap.scene.cameras]
    document.root |= {"scene": 0, "scenes": [{"name": lightmap.scene.name, "nodes": nodes}]}
    return document.encode()


def _unlit(document: Document, part: Part, texture: int, shown: Callable[[FloatArray], FloatArray]) -> Json:
    material = part.mesh.material
    json: Json = {"name": material.name, "extensions": {document.use("KHR_materials_unlit"): {}}}
    surface: Json = {"metallicFactor": 0.0, "baseColorTexture": {"index": texture}}
    if material.emission is not None and not reflects_diffusely(material):
        # Surfaces that emit but do not reflect have no texels in the map.
        glow = np.array([constant_of(material.emission)])
        if material.emission.texture is not None:
            glow = glow * texels(material.emission).mean(axis=(0, 1))
        surface = {"metallicFactor": 0.0, "baseColorFactor": [*shown(glow)[0].tolist(), 1.0]}
    if material.two_sided and not part.one_of_two:
        json["doubleSided"] = True
    if material.opacity.texture is not None or constant_of(material.opacity)[0] < 1:
        cutoff = material.alpha_cutoff
        json |= {"alphaMode": "BLEND"} if cutoff is None else {"alphaMode": "MASK", "alphaCutoff": cutoff}
    return json | {"pbrMetallicRoughness": surface}


def _radiance_and_opacity(lightmap: LitParts) -> tuple[FloatArray, FloatArray]:
    """Compute the radiance (H, W, 3) and the opacity (H, W) of all texels, including those between charts."""
    height, width = lightmap.irradiance.shape[:2]
    size = np.array([width, height])
    unwrapped = tuple(
        Unwrapped(np.arange(len(uvs)), np.asarray(part.mesh.triangles), uvs * size, np.zeros(len(uvs), np.int64))
        for part, uvs in zip(lightmap.parts, lightmap.stacked_uvs(), strict=True)
    )
    corners = corners_of([part.mesh for part in lightmap.parts], Atlas(width, height, unwrapped, ""))
    found = rasterize(corners, width, height)
    radiance, opacity = np.zeros((height, width, 3)), np.ones((height, width))
    known = np.zeros((height, width), bool)
    first = 0
    for part in lightmap.parts:
        count = len(part.mesh.triangles)
        mine = np.flatnonzero((found.triangles >= first) & (found.triangles < first + count))
        at = found.rows[mine], found.columns[mine]
        shine, cover = _surface(part, found, mine, first, lightmap.irradiance[at])
        radiance[at], opacity[at], known[at] = shine, cover, True
        first += count
    both, _ = dilate(np.concatenate((radiance, opacity[..., None]), axis=2), known, lightmap.gutter + 1)
    return both[..., :3], np.where(known, opacity, 1.0)


def _surface(
    part: Part, found: Texels, mine: np.ndarray, first: int, irradiance: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Compute the radiance (N, 3) and the opacity (N,) of the texels `mine` of one part.

    `first` is the number of the part's first triangle; `irradiance` is (N, 3).
    """
    mesh, material = part.mesh, as_metallic_roughness(part.mesh.material)
    corners = np.asarray(mesh.triangles)[found.triangles[mine] - first]

    def at_texels(values: FloatArray | None, width: int) -> FloatArray:
        if values is None:
            return np.zeros((len(mine), width))
        blended: FloatArray = np.einsum("ni,nij->nj", found.weights[mine], np.asarray(values, np.float64)[corners])
        return blended

    uvs = [at_texels(values, 2) for values in (mesh.uvs, mesh.uvs2)]
    albedo = evaluate(material.parameters.get("base_color", DEFAULTS["base_color"]), uvs)
    cover = evaluate(material.opacity, uvs)[:, 0]
    if material.vertex_colors and mesh.colors is not None:
        colors = at_texels(mesh.colors, 4)
        albedo, cover = albedo * colors[:, :3], cover * colors[:, 3]
    shine = albedo / np.pi * irradiance
    return (shine if material.emission is None else shine + evaluate(material.emission, uvs)), np.clip(cover, 0, 1)


def evaluate(value: Value, uvs: list[FloatArray]) -> FloatArray:
    """Evaluate a parameter at N points, (N, 3); `uvs` holds both sets of their texture coordinates, (N, 2) each."""
    constant = np.broadcast_to(np.array(constant_of(value)), (len(uvs[0]), 3))
    if value.texture is None:
        return constant
    matrix = np.array(value.uv_transform)
    places = uvs[value.uv_set] @ matrix[:, :2].T + matrix[:, 2]
    image = texels(value)
    height, width = image.shape[:2]
    x, y = places[:, 0] * width - 0.5, places[:, 1] * height - 0.5
    if value.texture.filter == "nearest":
        x, y = np.rint(x), np.rint(y)
    i, j = np.floor(x).astype(np.int64), np.floor(y).astype(np.int64)
    total = np.zeros((len(places), image.shape[2]))
    for dx, dy in ((0, 0), (1, 0), (0, 1), (1, 1)):
        weight = np.where(dx, x - i, 1 - (x - i)) * np.where(dy, y - j, 1 - (y - j))
        column = _wrapped(i + dx, width, value.texture.wrap_u)
        row = _wrapped(j + dy, height, value.texture.wrap_v)
        total += weight[:, None] * image[row, column]
    return constant * total


def _wrapped(index: Ints, size: int, how: str) -> Ints:
    if how == "clamp":
        return np.clip(index, 0, size - 1)
    if how == "mirror":
        back = index % (2 * size)
        return np.minimum(back, 2 * size - 1 - back)
    return index % size


def _scale(radiance: FloatArray) -> float:
    largest = radiance.max(axis=2)
    lit = largest[largest > 0]
    return 1 / float(np.quantile(lit, WHITE_QUANTILE)) if len(lit) else 1.0
