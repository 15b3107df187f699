# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A scene whose every surface is paint of one colour, so that renderers with other materials get the same scene."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from eclat.images.tone import srgb_decode
from eclat.scene import Material, Scene, Texture, Value, grey, rgb

COLOURS = ("reflectance", "diffuse_reflectance", "specular_transmittance", "base_color", "specular_reflectance")
"""The parameter that becomes the paint's colour: the first of these that a material has."""


def painted(scene: Scene) -> Scene:
    """The same triangles, lights and cameras: flat shading, no textures, no bumps, opaque; glass as paint of its colour."""
    meshes = tuple(replace(mesh, normals=None, material=paint(mesh.material)) for mesh in scene.meshes)
    return replace(scene, meshes=meshes, name=f"{scene.name} (painted)")


def paint(material: Material) -> Material:
    """The diffuse material of a material's mean colour; what emits goes on emitting."""
    name = next((name for name in COLOURS if name in material.parameters), None)
    colour = grey(0.5) if name is None else mean_colour(material.parameters[name])
    return Material(
        "diffuse", {"reflectance": colour}, name=material.name, two_sided=material.two_sided, emission=material.emission
    )


def mean_colour(value: Value) -> Value:
    """The value without its texture: times the mean of its texels, in linear light."""
    if value.texture is None:
        return rgb(*value.constant)
    mean = _mean(value.texture) if value.channel is None else (_mean(value.texture)[value.channel],) * 3
    return rgb(*(c * m for c, m in zip(value.constant, mean, strict=True)))


def _mean(texture: Texture) -> tuple[float, ...]:
    image = np.asarray(texture.image, np.float64) / (255 if texture.image.dtype == np.uint8 else 1)
    colours = np.repeat(image[..., :1], 3, axis=2) if image.shape[2] < 3 else image[..., :3]
    if texture.srgb:
        colours = srgb_decode(colours)
    return tuple(float(x) for x in colours.mean(axis=(0, 1)))
