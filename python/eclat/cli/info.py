# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The command `eclat info`, which lists the contents of a scene."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

import click

from eclat.cli.command import Command
from eclat.cli.reporting import Reporter, reporting_options
from eclat.cli.scene_options import load_file, posed, scene_argument
from eclat.errors import printable
from eclat.scene import DirectionalLight, PointLight, ProfileLight, SpotLight
from eclat.stage.material_overrides import material_names

if TYPE_CHECKING:
    from eclat.scene import Camera, Scene

EXAMPLES = {
    "eclat info room.glb": "List meshes, materials, lights and cameras, with the warnings of the loader:",
    "eclat info room.glb --json": "List the same as JSON, for programs:",
}

_LIGHTS: dict[type, str] = {
    PointLight: "point",
    SpotLight: "spot",
    ProfileLight: "profile",
    DirectionalLight: "directional",
}


@click.command(
    "info",
    cls=Command,
    short_help="List the contents of a scene, and what the loader replaced or ignored.",
    examples=EXAMPLES,
    help="List the contents of SCENE: meshes, materials by kind, lights, cameras and bounds, and the loader's warnings.",
)
@scene_argument
@reporting_options
def command(**flags: Any) -> None:
    """Load the scene and describe it."""
    with Reporter(flags["quiet"], flags["as_json"]) as reporter:
        scene = load_file(flags)
        description = describe(posed(scene, flags)) | {"animation": _animation(scene)}
        reporter.result(_text(description), **description)


def describe(scene: Scene) -> dict[str, Any]:
    """Describe the contents of a scene in types that JSON can represent."""
    import numpy as np

    materials = {id(mesh.material): mesh.material for mesh in scene.meshes}
    glowing = [mesh for mesh in scene.meshes if mesh.material.emission is not None]
    corners = [np.asarray(mesh.positions) for mesh in scene.meshes if len(mesh.positions)]
    bounds = None
    if corners:
        low = np.min([points.min(axis=0) for points in corners], axis=0)
        high = np.max([points.max(axis=0) for points in corners], axis=0)
        bounds = [low.tolist(), high.tolist()]
    environment = scene.environment
    return {
        "name": scene.name,
        "meshes": len(scene.meshes),
        "triangles": sum(len(mesh.triangles) for mesh in scene.meshes),
        "vertices": sum(len(mesh.positions) for mesh in scene.meshes),
        "materials": dict(Counter(material.kind for material in materials.values()).most_common()),
        "material_names": material_names(scene),
        "textures": len({id(t) for m in materials.values() for v in m.parameters.values() if (t := v.texture)}),
        "lights": dict(Counter(_LIGHTS[type(light)] for light in scene.lights).most_common()),
        "emissive_meshes": len(glowing),
        "emissive_triangles": sum(len(mesh.triangles) for mesh in glowing),
        "environment": None if environment is None else [environment.image.shape[1], environment.image.shape[0]],
        "cameras": [_camera(camera) for camera in scene.cameras],
        "bounds": bounds,
        "up": list(scene.up),
        "animation": _animation(scene),
        "unit": "photometric" if scene.photometric else "radiometric",
        "warnings": list(scene.warnings),
    }


def _animation(scene: Scene) -> dict[str, Any] | None:
    """Describe what moves, or return None if nothing does."""
    found = scene.animation
    if found is None:
        return None
    moving = {"objects": list(found.objects), "lights": list(found.lights), "cameras": list(found.cameras)}
    return {"start": found.start, "end": found.end, "duration": found.end - found.start, **moving}


def _camera(camera: Camera) -> dict[str, Any]:
    return {
        "name": camera.name,
        "from": [float(x) for x in camera.to_world[:3, 3]],
        "fov": camera.fov,
        "fov_axis": camera.fov_axis,
        "projection": camera.projection,
        "size": list(camera.size) if camera.size else None,
    }


def _text(description: dict[str, Any]) -> str:
    lights = dict(description["lights"])
    if description["emissive_triangles"]:
        count, meshes = description["emissive_triangles"], description["emissive_meshes"]
        lights["emissive"] = f"{count:,} triangles in {meshes:,} mesh{'es' if meshes > 1 else ''}"
    if description["environment"]:
        lights["environment"] = "{}x{}".format(*description["environment"])
    lines = [
        ("name", description["name"] or "none"),
        ("meshes", f"{description['meshes']:,}"),
        ("triangles", f"{description['triangles']:,} of {description['vertices']:,} vertices"),
        ("materials", _counts(description["materials"])),
        ("named", ", ".join(description["material_names"]) or "none"),
        ("textures", f"{description['textures']:,}"),
        ("lights", _counts(lights)),
        *(_camera_line(i, camera) for i, camera in enumerate(description["cameras"])),
        ("bounds", _bounds(description["bounds"])),
        ("up", _numbers(description["up"])),
        *_animation_lines(description["animation"]),
        ("units", "candela and lux" if description["unit"] == "photometric" else "W·sr⁻¹·m⁻²"),
        ("warnings", f"{len(description['warnings'])}"),
    ]
    if not description["cameras"]:
        lines.insert(7, ("cameras", "none"))
    return "\n".join(f"{label:<10}  {printable(value)}" for label, value in lines)


def _animation_lines(animation: dict[str, Any] | None) -> list[tuple[str, str]]:
    if animation is None:
        return []
    span = f"{animation['start']:g} s to {animation['end']:g} s"
    moving = [f"{kind} {', '.join(animation[kind])}" for kind in ("objects", "lights", "cameras") if animation[kind]]
    return [("animation", span), ("moving", "; ".join(moving) or "none")]


def _camera_line(index: int, camera: dict[str, Any]) -> tuple[str, str]:
    unit = "m" if camera["projection"] == "orthographic" else "°"
    size = f", {camera['size'][0]}x{camera['size'][1]}" if camera["size"] else ""
    name = f"{camera['name']!r} " if camera["name"] else ""
    fov = f"{camera['fov']:g}{unit} along {camera['fov_axis']}"
    return f"camera {index}", f"{name}{camera['projection']}, from {_numbers(camera['from'])}, {fov}{size}"


def _counts(counts: dict[str, Any]) -> str:
    return ", ".join(f"{kind} {count}" for kind, count in counts.items()) or "none"


def _numbers(values: list[float]) -> str:
    return "(" + ", ".join(f"{value:.4g}" for value in values) + ")"


def _bounds(bounds: list[list[float]] | None) -> str:
    return "none" if bounds is None else f"{_numbers(bounds[0])} to {_numbers(bounds[1])} m"
