# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A scene of ours as one of Blender's, for Cycles: the same triangles, colours, lights and camera.

Plastics and metals become the nearest of Blender's models, which are not ours, so Cycles is judged against its own long
render. What has no near model raises UnavailableError.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from eclat.scene import DEFAULTS, Camera, DirectionalLight, Environment, Material, Mesh, Scene, Value
from harness.mitsuba_materials import texels
from harness.unavailable import UnavailableError

TO_BLENDER = np.array([(0.0, 0.0, -1.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0)])
"""Our frame of environments, with +y up and the centre of the image at −z, to Blender's, with +z up and the centre at +x."""


def build(bpy: Any, scene: Scene, size: tuple[int, int]) -> None:
    """Replace what Blender holds by the scene, seen from its first camera."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    materials: dict[int, Any] = {}
    for i, mesh in enumerate(scene.meshes):
        if id(mesh.material) not in materials:
            materials[id(mesh.material)] = _material(bpy, mesh.material)
        _add_mesh(bpy, mesh, i, materials[id(mesh.material)])
    for light in scene.lights:
        if not isinstance(light, DirectionalLight):
            raise UnavailableError(f"{scene.name}: only directional lights and emitting surfaces are given to Cycles")
        _add_sun(bpy, light)
    _add_camera(bpy, scene.cameras[0], size)
    _set_world(bpy, scene.environment)


def _add_mesh(bpy: Any, mesh: Mesh, index: int, material: Any) -> None:
    positions = np.asarray(mesh.positions, np.float32)
    triangles = np.asarray(mesh.triangles, np.int32)
    made = bpy.data.meshes.new(f"mesh{index}")
    made.vertices.add(len(positions))
    made.vertices.foreach_set("co", positions.ravel())
    made.loops.add(triangles.size)
    made.loops.foreach_set("vertex_index", triangles.ravel())
    made.polygons.add(len(triangles))
    made.polygons.foreach_set("loop_start", np.arange(0, triangles.size, 3, dtype=np.int32))
    if mesh.uvs is not None:
        uvs = np.asarray(mesh.uvs, np.float32)[:, :2]
        made.uv_layers.new(name="uv").data.foreach_set("uv", uvs[triangles.ravel()].ravel())
    made.materials.append(material)
    made.update(calc_edges=True)
    made.polygons.foreach_set("use_smooth", np.full(len(triangles), mesh.normals is not None))
    if mesh.normals is not None:
        made.normals_split_custom_set_from_vertices(np.asarray(mesh.normals, np.float32).tolist())
    bpy.context.scene.collection.objects.link(bpy.data.objects.new(f"mesh{index}", made))


def _add_sun(bpy: Any, light: DirectionalLight) -> None:
    from mathutils import Vector

    strength = max(light.irradiance)
    sun = bpy.data.lights.new("sun", "SUN")
    sun.energy, sun.angle = strength, 2 * math.radians(light.angular_radius)
    sun.color = [value / strength for value in light.irradiance]
    placed = bpy.data.objects.new("sun", sun)
    placed.rotation_mode = "QUATERNION"
    placed.rotation_quaternion = Vector((0, 0, -1)).rotation_difference(Vector(light.direction))
    bpy.context.scene.collection.objects.link(placed)


def _add_camera(bpy: Any, camera: Camera, size: tuple[int, int]) -> None:
    from mathutils import Matrix

    if camera.projection != "perspective" or camera.aperture_radius or any(camera.shift):
        raise UnavailableError("only a pinhole camera is given to Cycles")
    made = bpy.data.cameras.new("camera")
    made.sensor_fit = "HORIZONTAL"
    made.angle = 2 * math.atan(camera.half_extent(size[0] / size[1])[0])
    made.clip_start, made.clip_end = 1e-3, 1e4
    placed = bpy.data.objects.new("camera", made)
    placed.matrix_world = Matrix(np.asarray(camera.to_world, float).tolist())
    scene = bpy.context.scene
    scene.collection.objects.link(placed)
    scene.camera = placed
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.resolution_percentage = 100


def _set_world(bpy: Any, environment: Environment | None) -> None:
    from mathutils import Matrix

    world = bpy.data.worlds.new("world")
    bpy.context.scene.world = world
    nodes, links = _emptied(world)
    background, output = nodes.new("ShaderNodeBackground"), nodes.new("ShaderNodeOutputWorld")
    links.new(background.outputs[0], output.inputs["Surface"])
    background.inputs["Strength"].default_value = 1.0
    background.inputs["Color"].default_value = (0.0, 0.0, 0.0, 1.0)
    if environment is None:
        return
    if environment.image.shape[:2] == (1, 1):
        background.inputs["Color"].default_value = (*map(float, environment.image[0, 0]), 1.0)
        return
    turn = TO_BLENDER @ np.asarray(environment.to_world, float).T
    if np.linalg.det(turn) < 0:
        raise UnavailableError("a mirrored environment is not given to Cycles")
    place, mapping, seen = (
        nodes.new(f"ShaderNode{name}") for name in ("TexCoord", "Mapping", "TexEnvironment")
    )  # fmt: skip
    mapping.vector_type = "VECTOR"
    mapping.inputs["Rotation"].default_value = Matrix(turn.tolist()).to_euler("XYZ")
    seen.image = _image(bpy, np.asarray(environment.image[::-1], np.float32))
    links.new(place.outputs["Generated"], mapping.inputs["Vector"])
    links.new(mapping.outputs["Vector"], seen.inputs["Vector"])
    links.new(seen.outputs["Color"], background.inputs["Color"])


def _emptied(owner: Any) -> tuple[Any, Any]:
    """Return the nodes and links of a material or a world, without any node."""
    owner.use_nodes = True
    owner.node_tree.nodes.clear()
    return owner.node_tree.nodes, owner.node_tree.links


def _image(bpy: Any, pixels: np.ndarray) -> Any:
    """Make an image of linear values (H, W, 3), the first row at the bottom, as Blender has it."""
    height, width = pixels.shape[:2]
    image = bpy.data.images.new("image", width, height, float_buffer=True, is_data=True)
    image.pixels.foreach_set(np.dstack([pixels, np.ones((height, width), np.float32)]).ravel())
    image.update()
    return image


class _Shading:
    """The nodes of one material."""

    def __init__(self, bpy: Any, material: Material) -> None:
        self.bpy, self.ours = bpy, material
        self.made = bpy.data.materials.new(material.name or "material")
        self.nodes, self.links = _emptied(self.made)

    def add(self, kind: str, **inputs: Any) -> Any:
        """Add a node; an input is a number, a colour, or the output of another node. `_` stands for a space in names."""
        node = self.nodes.new(f"ShaderNode{kind}")
        for name, given in inputs.items():
            socket = node.inputs[name.replace("_", " ")]
            if hasattr(given, "links"):
                self.links.new(given, socket)
            else:
                socket.default_value = given
        return node

    def read(self, name: str) -> Value:
        return self.ours.parameters.get(name, DEFAULTS[name])

    def number(self, name: str) -> float:
        value = self.read(name)
        if value.texture is not None:
            raise UnavailableError(f"material {self.ours.name!r}: textured {name} is not given to Cycles")
        return float(value.constant[0]) ** (2 if value.square else 1)

    def colour(self, value: Value) -> Any:
        """A colour, or the output of an image of the linear texels."""
        if value.texture is None:
            return (*map(float, value.constant), 1.0)
        if value.uv_set != 0 or value.uv_transform != Value((1.0, 1.0, 1.0)).uv_transform:
            raise UnavailableError(f"texture {value.texture.name!r}: only coordinates as they are are given to Cycles")
        node = self.add("TexImage")
        node.image = _image(self.bpy, texels(value))
        node.extension = {"repeat": "REPEAT", "mirror": "MIRROR", "clamp": "EXTEND"}[value.texture.wrap_u]
        node.interpolation = "Linear" if value.texture.filter == "bilinear" else "Closest"
        return node.outputs["Color"]


def _material(bpy: Any, material: Material) -> Any:
    shading = _Shading(bpy, material)
    if material.normal_map is not None or material.vertex_colors or material.back is not None:
        raise UnavailableError(
            f"material {material.name!r}: bumps, colours of vertices and other backs are not given to Cycles"
        )
    surface = _surface(shading)
    if material.emission is not None:
        surface = _with_emission(shading, surface)
    opacity = material.opacity
    if opacity.texture is not None or opacity.constant[0] != 1:
        mix = shading.add("MixShader", Fac=shading.colour(opacity) if opacity.texture else float(opacity.constant[0]))
        shading.links.new(shading.add("BsdfTransparent").outputs[0], mix.inputs[1])
        shading.links.new(surface, mix.inputs[2])
        surface = mix.outputs[0]
    shading.links.new(surface, shading.add("OutputMaterial").inputs["Surface"])
    return shading.made


def _with_emission(shading: _Shading, surface: Any) -> Any:
    """Add the emission, on the side of the normal unless it is two-sided."""
    emission = shading.ours.emission
    assert emission is not None
    emitted = shading.add("Emission", Color=shading.colour(emission), Strength=1.0)
    if not shading.ours.emission_two_sided:
        front = shading.add("Math")
        front.operation = "SUBTRACT"
        front.inputs[0].default_value = 1.0
        shading.links.new(shading.add("NewGeometry").outputs["Backfacing"], front.inputs[1])
        shading.links.new(front.outputs[0], emitted.inputs["Strength"])
    both = shading.add("AddShader")
    shading.links.new(surface, both.inputs[0])
    shading.links.new(emitted.outputs[0], both.inputs[1])
    return both.outputs[0]


def _surface(shading: _Shading) -> Any:
    """The nearest of Blender's models. Its roughness is the root of α."""
    kind = shading.ours.kind
    if kind == "diffuse":
        return shading.add("BsdfDiffuse", Color=shading.colour(shading.read("reflectance")), Roughness=0.0).outputs[0]
    if kind == "metallic_roughness":
        return shading.add(
            "BsdfPrincipled", Base_Color=shading.colour(shading.read("base_color")), Metallic=shading.number("metallic"),
            Roughness=math.sqrt(shading.number("roughness")), IOR=shading.number("ior"),
        ).outputs[0]  # fmt: skip
    if kind not in ("conductor", "plastic", "dielectric"):
        raise UnavailableError(f"material {shading.ours.name!r}: a {kind} is not given to Cycles")
    roughness = math.sqrt(shading.number("alpha_u"))
    if kind == "conductor":
        return shading.add("BsdfAnisotropic", Color=_metal(shading), Roughness=roughness).outputs[0]
    if kind == "plastic":
        return shading.add(
            "BsdfPrincipled", Base_Color=shading.colour(shading.read("diffuse_reflectance")), Roughness=roughness,
            IOR=shading.number("ior"),
        ).outputs[0]  # fmt: skip
    colour = shading.colour(shading.read("specular_transmittance"))
    return shading.add("BsdfGlass", Color=colour, Roughness=roughness, IOR=shading.number("ior")).outputs[0]


def _metal(shading: _Shading) -> Any:
    """The colour of a metal at normal incidence."""
    specular = shading.read("specular_reflectance")
    if specular.texture is not None:
        return shading.colour(specular)
    eta, k = (np.array(shading.read(name).constant) for name in ("eta", "k"))
    reflected = ((eta - 1) ** 2 + k**2) / ((eta + 1) ** 2 + k**2)
    return (*(float(x) for x in reflected * np.array(specular.constant)), 1.0)
