# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Small scenes of Blender, each made by a function of its name; they need `bpy`."""

from __future__ import annotations

import math

import bpy
import numpy as np

SIZE = (96, 64)


def start() -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = *SIZE, 100
    scene.world = bpy.data.worlds.new("world")
    background(0.0)


def nodes_of(owner):
    if owner.node_tree is None:
        owner.use_nodes = True
    owner.node_tree.nodes.clear()
    return owner.node_tree.nodes, owner.node_tree.links


def background(strength, color=(1.0, 1.0, 1.0, 1.0)):
    """Make the world a Background node, which is returned with the nodes and links."""
    nodes, links = nodes_of(bpy.context.scene.world)
    shader, output = nodes.new("ShaderNodeBackground"), nodes.new("ShaderNodeOutputWorld")
    links.new(shader.outputs[0], output.inputs["Surface"])
    shader.inputs["Color"].default_value, shader.inputs["Strength"].default_value = color, strength
    return shader, nodes, links


def material(name, kind, **inputs):
    """Make a material of one shader; `_` stands for a space in the names of inputs."""
    made = bpy.data.materials.new(name)
    nodes, links = nodes_of(made)
    shader, output = nodes.new(f"ShaderNode{kind}"), nodes.new("ShaderNodeOutputMaterial")
    if hasattr(shader, "distribution"):
        shader.distribution = "GGX"  # Without light that facets scatter several times.
    links.new(shader.outputs[0], output.inputs["Surface"])
    for key, value in inputs.items():
        shader.inputs[key.replace("_", " ")].default_value = value
    return made, shader, nodes, links


def add(kind, shader=None, **given):
    getattr(bpy.ops.mesh, f"primitive_{kind}_add")(**given)
    made = bpy.context.object
    if shader is not None:
        made.data.materials.append(shader)
    return made


def smooth(thing):
    thing.data.polygons.foreach_set("use_smooth", np.ones(len(thing.data.polygons), bool))
    thing.data.update()
    return thing


def lamp(kind, energy, location, target=(0, 0, 0), **given):
    data = bpy.data.lights.new(kind.lower(), kind)
    data.energy = energy
    for name, value in given.items():
        setattr(data, name, value)
    return place(bpy.data.objects.new(kind.lower(), data), location, target)


def camera(location, target=(0, 0, 0), lens=50.0, **given):
    data = bpy.data.cameras.new("camera")
    data.lens = lens
    for name, value in given.items():
        setattr(data, name, value)
    made = place(bpy.data.objects.new("camera", data), location, target)
    bpy.context.scene.camera = made
    return data


def place(thing, location, target):
    from mathutils import Vector

    thing.location = location
    thing.rotation_euler = (Vector(target) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(thing)
    return thing


def picture(name, pixels, space="Non-Color", is_float=True):
    """Make an image of (H, W, 3), row 0 on top."""
    height, width = pixels.shape[:2]
    image = bpy.data.images.new(name, width, height, float_buffer=is_float, is_data=space == "Non-Color")
    if not is_float:
        image.colorspace_settings.name = space
    whole = np.dstack((pixels, np.ones((height, width)))) if pixels.shape[2] == 3 else pixels
    image.pixels.foreach_set(np.ascontiguousarray(whole[::-1], np.float32).ravel())
    image.update()
    image.pack()
    return image


def checks(cells=4, low=(0.1, 0.2, 0.6), high=(0.9, 0.7, 0.3)):
    rows, columns = np.mgrid[0 : 8 * cells, 0 : 8 * cells] // 8
    return np.where(((rows + columns) % 2)[..., None], low, high)


def diffuse_room():
    """An open box of matte colours below an area lamp: light between surfaces."""
    white, red, green = (
        material(n, "BsdfDiffuse", Color=(*c, 1.0))[0]
        for n, c in (("white", (0.7, 0.7, 0.7)), ("red", (0.6, 0.1, 0.1)), ("green", (0.1, 0.5, 0.1)))
    )
    add("plane", white, size=4)
    add("plane", white, size=4, location=(0, 2, 2), rotation=(math.pi / 2, 0, 0))
    add("plane", red, size=4, location=(-2, 0, 2), rotation=(0, math.pi / 2, 0))
    add("plane", green, size=4, location=(2, 0, 2), rotation=(0, -math.pi / 2, 0))
    add("cube", white, size=1, location=(0.4, 0.3, 0.5), rotation=(0, 0, 0.4))
    lamp("AREA", 300, (0, 0, 5), size=1)
    camera((0, -6.5, 2), (0, 0, 1.4), lens=40)


def four_lamps():
    """A floor and a block under a point, a spot, a sun and a disc, with sharp and soft shadows."""
    grey = material("grey", "BsdfDiffuse", Color=(0.6, 0.6, 0.6, 1.0))[0]
    add("plane", grey, size=12)
    add("cube", grey, size=1, location=(0, 0, 0.5))
    lamp("POINT", 200, (-2.5, -1, 2.5), color=(1, 0.4, 0.3), shadow_soft_size=0.2)
    lamp("SPOT", 600, (3, -2, 4), (0.5, 0, 0), color=(0.3, 1, 0.4), spot_size=0.7, spot_blend=0.5, shadow_soft_size=0.0)
    lamp("SUN", 0.5, (0, 0, 5), (1, 2, 0), angle=0.02)
    lamp("AREA", 150, (0, 3, 4), size=1.5, shape="DISK")
    camera((0, -7, 5), (0, 0, 0.3))


def glossy_balls():
    """Rough mirrors below a sky of an image."""
    floor = material("floor", "BsdfDiffuse", Color=(0.5, 0.5, 0.5, 1.0))[0]
    add("plane", floor, size=20)
    for i, (rough, color) in enumerate(((0.15, (0.9, 0.9, 0.9)), (0.4, (0.9, 0.6, 0.2)), (0.7, (0.5, 0.5, 0.5)))):
        shader = material(f"mirror {i}", "BsdfGlossy", Color=(*color, 1.0), Roughness=rough)[0]
        smooth(add("uv_sphere", shader, segments=48, ring_count=24, location=(2.2 * i - 2.2, 0, 1)))
    image_world(0.0, 1.0)
    camera((0, -7, 2.5), (0, 0, 0.8))


def sky_picture():
    """A smooth sky with a bright side and a dark ground, (H, W, 3)."""
    v, u = np.mgrid[0:32, 0:64] / np.array((32, 64)).reshape(2, 1, 1)
    up = np.clip(1 - 2 * v, 0, 1)[..., None]
    side = np.exp(-(((u - 0.3) / 0.08) ** 2) - ((v - 0.3) / 0.1) ** 2)[..., None]
    return 0.2 + up * np.array((0.3, 0.5, 0.9)) + side * np.array((9.0, 7.0, 4.0))


def image_world(turn, strength):
    shader, nodes, links = background(strength)
    image = nodes.new("ShaderNodeTexEnvironment")
    image.image = picture("sky", sky_picture())
    place_, mapping = nodes.new("ShaderNodeTexCoord"), nodes.new("ShaderNodeMapping")
    mapping.inputs["Rotation"].default_value = (0, 0, turn)
    links.new(place_.outputs["Generated"], mapping.inputs["Vector"])
    links.new(mapping.outputs["Vector"], image.inputs["Vector"])
    links.new(image.outputs["Color"], shader.inputs["Color"])


def turned_sky():
    """A rotated image of the sky with a strength, and a camera that shifts its frame."""
    white = material("white", "BsdfDiffuse", Color=(0.7, 0.7, 0.7, 1.0))[0]
    add("plane", white, size=8)
    smooth(add("uv_sphere", white, segments=48, ring_count=24, location=(0, 0, 1)))
    image_world(1.3, 0.7)
    camera((3, -6, 2), (0, 0, 1), shift_x=0.15, shift_y=-0.1)


def textured():
    """Principled surfaces with images of colour, roughness, metalness and normals; a mapping; an sRGB image of 8 bits."""
    made, shader, nodes, links = material("tiles", "BsdfPrincipled", Specular_IOR_Level=0.5)
    maps = (
        ("color", checks(), "Base Color", "sRGB"),
        ("rough", checks(4, (0.3,) * 3, (0.8,) * 3), "Roughness", "Non-Color"),
        ("metal", checks(2, (0.0,) * 3, (1.0,) * 3), "Metallic", "Non-Color"),
    )
    place_, mapping = nodes.new("ShaderNodeTexCoord"), nodes.new("ShaderNodeMapping")
    mapping.inputs["Scale"].default_value = (2, 3, 1)
    mapping.inputs["Rotation"].default_value = (0, 0, 0.5)
    mapping.inputs["Location"].default_value = (0.1, 0.3, 0)
    links.new(place_.outputs["UV"], mapping.inputs["Vector"])
    for name, pixels, target, space in maps:
        node = nodes.new("ShaderNodeTexImage")
        node.image, node.interpolation = picture(name, pixels, space, space != "sRGB"), "Closest"
        links.new(mapping.outputs["Vector"], node.inputs["Vector"])
        links.new(node.outputs["Color"], shader.inputs[target])
    bumpy, shader, nodes, links = material("bumpy", "BsdfPrincipled", Base_Color=(0.6, 0.5, 0.4, 1), Roughness=0.6)
    u = np.mgrid[0:64, 0:64][1] / 64
    slope = 0.4 * np.sin(2 * np.pi * 6 * u)
    normal = np.dstack((slope, 0 * slope, np.sqrt(1 - slope**2))) * 0.5 + 0.5
    image, turned = nodes.new("ShaderNodeTexImage"), nodes.new("ShaderNodeNormalMap")
    image.image = picture("normals", normal)
    links.new(image.outputs["Color"], turned.inputs["Color"])
    links.new(turned.outputs["Normal"], shader.inputs["Normal"])
    add("plane", made, size=6)
    add("cube", bumpy, size=1.6, location=(0, 0, 0.8), rotation=(0, 0, 0.6))
    lamp("SUN", 2, (0, 0, 5), (2, 2, 0), angle=0.1)
    background(0.4)
    camera((0, -6, 4), (0, 0, 0.4))


def instances():
    """A subdivided and an arrayed object, instances of a collection, a mirrored object, and text."""
    white = material("white", "BsdfDiffuse", Color=(0.7, 0.7, 0.7, 1.0))[0]
    blue = material("blue", "BsdfDiffuse", Color=(0.1, 0.2, 0.7, 1.0))[0]
    add("plane", white, size=14)
    monkey = add("monkey", blue, size=1.2, location=(0, 0, 0.8))
    monkey.modifiers.new("smooth", "SUBSURF").render_levels = 1
    row = add("cube", white, size=0.5, location=(-2.5, 1.5, 0.25))
    array = row.modifiers.new("row", "ARRAY")
    array.count, array.relative_offset_displace = 5, (1.8, 0, 0)
    parts = bpy.data.collections.new("parts")
    cone = add("cone", blue, radius1=0.4, depth=1, location=(0, 0, 0.5))
    bpy.context.scene.collection.objects.unlink(cone)
    parts.objects.link(cone)
    for x, scale in ((-2, 1), (2, -1.4)):
        holder = bpy.data.objects.new("holder", None)
        holder.instance_type, holder.instance_collection = "COLLECTION", parts
        holder.location, holder.scale = (x, -0.5, 0), (scale, abs(scale), abs(scale))
        bpy.context.scene.collection.objects.link(holder)
    curve = bpy.data.curves.new("word", "FONT")
    curve.body, curve.extrude = "ab", 0.1
    word = bpy.data.objects.new("word", curve)
    word.location, word.rotation_euler = (-0.4, -1.5, 0.1), (1.2, 0, 0)
    word.data.materials.append(white)
    bpy.context.scene.collection.objects.link(word)
    lamp("AREA", 400, (3, -3, 6), size=2)
    background(0.2)
    camera((0, -7, 3.5), (0, 0, 0.5))


def sun_and_sky():
    """The sky texture of Blender, with its sun."""
    white = material("white", "BsdfDiffuse", Color=(0.6, 0.6, 0.6, 1.0))[0]
    add("plane", white, size=30)
    add("cube", white, size=1.5, location=(0, 0, 0.75), rotation=(0, 0, 0.3))
    shader, nodes, links = background(0.05)
    sky = nodes.new("ShaderNodeTexSky")
    kinds = sky.bl_rna.properties["sky_type"].enum_items.keys()
    sky.sky_type = "MULTIPLE_SCATTERING" if "MULTIPLE_SCATTERING" in kinds else "NISHITA"
    sky.sun_elevation, sky.sun_rotation = 0.7, 2.2
    links.new(sky.outputs[0], shader.inputs["Color"])
    camera((0, -6, 3), (0, 0, 0.6))


def blurred():
    """A camera with depth of field."""
    white = material("white", "BsdfDiffuse", Color=(0.6, 0.6, 0.6, 1.0))[0]
    glow = material("glow", "Emission", Color=(1.0, 0.7, 0.3, 1.0), Strength=4.0)[0]
    add("plane", white, size=20)
    for i in range(5):
        add("cube", glow if i % 2 else white, size=0.6, location=(i - 2, 2.0 * i - 4, 0.3))
    background(0.5)
    data = camera((0, -8, 2.5), (0, 0, 0.3))
    data.dof.use_dof, data.dof.focus_distance, data.dof.aperture_fstop = True, 8.0, 0.15


def parallel_cutout():
    """An orthographic camera, a transparent film, and a surface with holes and glow."""
    made, shader, nodes, links = material("holes", "BsdfPrincipled", Base_Color=(0.2, 0.6, 0.3, 1.0), Roughness=0.8)
    image = nodes.new("ShaderNodeTexImage")
    image.image, image.interpolation = picture("mask", checks(3, (0.0,) * 3, (1.0,) * 3)), "Closest"
    links.new(image.outputs["Color"], shader.inputs["Alpha"])
    glow = material("glow", "BsdfPrincipled", Emission_Color=(0.2, 0.4, 1.0, 1.0), Emission_Strength=2.0)[0]
    add("plane", made, size=2, rotation=(1.2, 0, 0.3))
    add("cube", glow, size=0.7, location=(0.8, 0.9, 0.2))
    lamp("SUN", 2, (0, 0, 5), (1, 2, 0))
    background(0.3)
    bpy.context.scene.render.film_transparent = True
    camera((1, -6, 3), (0, 0, 0), type="ORTHO", ortho_scale=4.0)


def glass_and_mixes():
    """Glass, transmission, and mixtures of shaders, in even light."""
    floor = material("floor", "BsdfDiffuse", Color=(0.5, 0.4, 0.3, 1.0))[0]
    add("plane", floor, size=14)
    glass = material("glass", "BsdfGlass", Color=(1, 1, 1, 1), Roughness=0.0, IOR=1.45)[0]
    frosted = material(
        "frosted", "BsdfPrincipled", Base_Color=(0.8, 0.9, 1.0, 1), Transmission_Weight=1.0, Roughness=0.3
    )[0]
    half, shader, nodes, links = material("half", "MixShader")
    shader.inputs[0].default_value = 0.3
    for index, kind in ((1, "BsdfDiffuse"), (2, "BsdfGlossy")):
        part = nodes.new(f"ShaderNode{kind}")
        part.inputs["Color"].default_value = (0.7, 0.3, 0.2, 1.0)
        if kind == "BsdfGlossy":
            part.distribution, part.inputs["Roughness"].default_value = "GGX", 0.3
        links.new(part.outputs[0], shader.inputs[index])
    for i, shader in enumerate((glass, frosted, half)):
        smooth(add("uv_sphere", shader, segments=48, ring_count=24, location=(2.2 * i - 2.2, 0, 1)))
    background(0.8)
    camera((0, -7, 2.5), (0, 0, 0.8))


SCENES = (
    diffuse_room, four_lamps, glossy_balls, turned_sky, textured, instances, sun_and_sky, blurred, parallel_cutout,
    glass_and_mixes,
)  # fmt: skip


def build(name: str) -> None:
    start()
    next(make for make in SCENES if make.__name__ == name)()
    bpy.context.view_layer.update()
