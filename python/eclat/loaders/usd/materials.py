# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Read materials: UsdPreviewSurface and the colours of prims without a material [UsdShade; UsdPreviewSurface]."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from eclat.errors import EclatError, warn
from eclat.loaders.usd.stages import Stage
from eclat.loaders.usd.textures import Source, Textures, source_of
from eclat.scene import Material, NormalMap, Value, grey

MAX_INDEX = 100.0
"""The refractive index at which the specular colour is the reflectance at normal incidence, within 4 %."""
DEFAULT_COLOR = 0.18
"""The diffuse colour of a UsdPreviewSurface that has none."""
UNPAINTED = 0.5
"""The reflectance of a prim without a material and without a display colour, which USD leaves to the renderer."""


@dataclass(frozen=True)
class Surface:
    """A material, and the names of the primvars that it reads."""

    material: Material
    uv_sets: tuple[str, ...]
    """At most two; the first is `uvs`, and the second is `uvs2` of a mesh."""
    colors: str | None
    """The primvar of vertex colours."""


class Materials:
    """The materials of a stage. Each is converted once for each way in which it is used."""

    def __init__(self, stage: Stage) -> None:
        self._stage = stage
        self._textures = Textures(stage)
        self._made: dict[tuple[str, bool], Surface] = {}

    def of(self, bound: Any, one_sided: bool) -> Surface:
        """Return the surface of a prim.

        Parameters
        ----------
        bound : its UsdShadeMaterial, or an invalid one for the display colour.
        one_sided : whether the prim says that it is not double-sided, so that its back is invisible, as in glTF.
        """
        key = (str(bound.GetPath()) if bound else "", one_sided)
        if key not in self._made:
            self._made[key] = self._make(bound, one_sided)
        return self._made[key]

    def _make(self, bound: Any, one_sided: bool) -> Surface:
        shader = _surface_shader(bound) if bound else None
        sides: dict[str, Any] = {"two_sided": not one_sided, "back_culled": one_sided}
        if shader is None:
            if bound:
                where = self._stage.where(bound.GetPrim())
                warn(f"{where}: expected a UsdPreviewSurface, got none; the display colour is used instead")
            name = bound.GetPrim().GetName() if bound else "display colour"
            return Surface(
                Material("diffuse", {"reflectance": grey(1.0)}, name, vertex_colors=True, **sides), (), "displayColor"
            )
        return _Preview(self._stage, self._textures, shader).surface(bound.GetPrim().GetName(), sides)


def _surface_shader(bound: Any) -> Any:
    """Return the UsdPreviewSurface of a material, or None."""
    shader = bound.ComputeSurfaceSource()[0]
    return shader if shader and str(shader.GetIdAttr().Get() or "") == "UsdPreviewSurface" else None


class _Preview:
    """One UsdPreviewSurface, while it is converted."""

    def __init__(self, stage: Stage, textures: Textures, shader: Any) -> None:
        self._stage, self._textures, self._shader = stage, textures, shader
        self._where = stage.where(shader.GetPrim())
        self._uv_sets: list[str] = []
        self._colors: str | None = None

    def surface(self, name: str, sides: dict[str, Any]) -> Surface:
        """Convert the shader to a material called `name` with the fields `sides`."""
        base = self._color("diffuseColor", (DEFAULT_COLOR,) * 3)
        parameters = {"base_color": base, "roughness": self._scalar("roughness", 0.5, square=True)}
        if self._constant("useSpecularWorkflow", 0):
            parameters |= {
                "metallic": grey(0.0),
                "ior": grey(MAX_INDEX),
                "specular_color": self._color("specularColor", (0.0, 0.0, 0.0)),
            }
        else:
            parameters["metallic"] = self._scalar("metallic", 0.0)
            index = float(self._constant("ior", 1.5))
            parameters["ior"] = grey(min(max(index, 1.0), MAX_INDEX) if np.isfinite(index) else 1.5)
        emission = self._color("emissiveColor", (0.0, 0.0, 0.0))
        glows = emission.texture is not None or max(emission.constant) > 0
        opacity, threshold = self._scalar("opacity", 1.0), float(self._constant("opacityThreshold", 0.0))
        self._warn_of_the_rest()
        material = Material(
            "metallic_roughness",
            parameters,
            name,
            opacity=opacity,
            alpha_cutoff=threshold if threshold > 0 else None,
            normal_map=self._normal_map(),
            emission=emission if glows else None,
            emission_two_sided=sides["two_sided"],
            vertex_colors=self._colors is not None,
            **sides,
        )
        return Surface(material, tuple(self._uv_sets), self._colors)

    def _warn_of_the_rest(self) -> None:
        if self._source("clearcoat").node is not None or self._constant("clearcoat", 0.0):
            self._stage.once("clearcoat", "the clear coats of UsdPreviewSurface are not supported and are ignored")
        if self._source("displacement").node is not None or self._constant("displacement", 0.0):
            self._stage.once("displacement", "the displacement of UsdPreviewSurface is not supported and is ignored")

    def _source(self, name: str) -> Source:
        return source_of(self._stage, self._shader, name)

    def _constant(self, name: str, default: float) -> float:
        value = self._source(name).value
        try:
            return default if value is None else float(value)
        except (TypeError, ValueError):
            raise EclatError(f"{self._where}: expected a number as {name}, got {type(value).__name__}") from None

    def _scalar(self, name: str, default: float, square: bool = False) -> Value:
        """Return a parameter in 0..1."""
        found = self._source(name)
        if found.node is not None:
            textured = self._textures.value(found.node, found.output, self._uv_sets)
            if textured is not None:
                return Value(
                    textured.constant,
                    textured.texture,
                    textured.channel,
                    textured.uv_set,
                    textured.uv_transform,
                    square=square,
                )
        number = self._constant(name, default)
        inside = min(max(number, 0.0), 1.0) if np.isfinite(number) else default
        if inside != number:
            warn(f"{self._where}: expected a {name} in 0..1, got {number:g}; {inside:g} is used instead")
        return Value((inside,) * 3, square=square)

    def _color(self, name: str, default: tuple[float, float, float]) -> Value:
        found = self._source(name)
        if found.node is not None:
            kind = str(found.node.GetIdAttr().Get() or "")
            if kind.startswith("UsdPrimvarReader") and name == "diffuseColor":
                self._colors = str(source_of(self._stage, found.node, "varname").value or "displayColor")
                return grey(1.0)
            textured = self._textures.value(found.node, found.output, self._uv_sets)
            if textured is not None:
                return textured
        value = default if found.value is None else found.value
        try:
            numbers = np.array(value, dtype=np.float64).ravel()
        except (TypeError, ValueError):
            numbers = np.zeros(0)
        if numbers.shape != (3,) or not np.isfinite(numbers).all() or numbers.min() < 0:
            warn(
                f"{self._where}: expected three numbers of at least 0 as {name}, got others; {default} is used instead"
            )
            numbers = np.array(default)
        red, green, blue = numbers.tolist()
        return Value((red, green, blue))

    def _normal_map(self) -> NormalMap | None:
        found = self._source("normal")
        if found.node is None:
            return None
        value = self._textures.value(found.node, found.output, self._uv_sets, normals=True)
        if value is None or value.texture is None:
            return None
        if value.texture.image.shape[2] < 3:
            warn(f"{self._where}: expected an RGB image as the normal map, got a grey one; it is ignored")
            return None
        return NormalMap(Value((1.0, 1.0, 1.0), value.texture, None, value.uv_set, value.uv_transform))
