# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A program for a Python that has `bpy`: passes, the exported glTF, light maps and a viewport, as numbers in means.json.

With `blender/` and `python/` in PYTHONPATH, called as `features.py FOLDER`.
"""

import json
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import bpy
import numpy as np
import OpenEXR
import scenes

import eclat
import eclat_blender
from eclat_blender.notices import Notices
from eclat_blender.translate import translate
from eclat_blender.viewport_draw import ViewportDrawing


def layers_of(folder):
    """Render all passes into a file, and return the means of its channels."""
    scene, layer = bpy.context.scene, bpy.context.view_layer
    layer.use_pass_z = layer.use_pass_normal = True
    for name in ("use_direct", "use_indirect", "use_albedo", "use_record_density"):
        setattr(layer.eclat, name, True)
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format, settings.color_depth = "OPEN_EXR_MULTILAYER", "32"
    scene.view_settings.view_transform = "Raw"
    scene.render.filepath = str(folder / "layers.exr")
    bpy.ops.render.render(write_still=True)
    with OpenEXR.File(scene.render.filepath, separate_channels=True) as file:
        return {name: float(c.pixels.mean()) for part in file.parts for name, c in part.channels.items()}


def by_gltf(folder):
    """Draw a room by the add-on and by the glTF that Blender exports of it, both by many paths: their means."""
    scenes.build("diffuse_room")
    bpy.data.objects.remove(bpy.data.objects["area"])
    for name, color in (("white", (0.7, 0.7, 0.7)), ("red", (0.6, 0.1, 0.1)), ("green", (0.1, 0.5, 0.1))):
        # glTF knows the Principled BSDF only.
        made = scenes.material(f"{name} paint", "BsdfPrincipled", Base_Color=(*color, 1.0), Roughness=0.6)[0]
        bpy.data.materials[name].user_remap(made)
    scenes.lamp("POINT", 500, (0.5, -1, 3.5))
    bpy.data.lights["point"].shadow_soft_size = 0.0
    graph = bpy.context.evaluated_depsgraph_get()
    bpy.context.scene.render.engine = "ECLAT"
    found = translate(graph, lambda _: None, Notices())
    file = folder / "room.glb"
    bpy.ops.export_scene.gltf(
        filepath=str(file), export_lights=True, export_cameras=True, export_import_convert_lighting_mode="COMPAT"
    )
    exported = eclat.load(file)
    camera = exported.cameras[0]
    drawn = eclat.render(exported, "path", samples=256, size=scenes.SIZE, camera=camera, denoise=False)
    bpy.context.scene.eclat.method, bpy.context.scene.eclat.samples = "path", 256
    ours = render(folder / "room.exr")
    assert len(found.scene.meshes) == len(exported.meshes)
    return float(drawn.pixels.mean()), float(ours.mean())


def render(target):
    scene = bpy.context.scene
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):
        settings.media_type = "IMAGE"
    settings.file_format, settings.color_depth, settings.color_mode = "OPEN_EXR", "32", "RGB"
    scene.view_settings.view_transform = "Raw"
    scene.eclat.denoise = False
    scene.render.filepath = str(target)
    bpy.ops.render.render(write_still=True)
    return eclat.Image.load(target).pixels


def light_maps():
    """Bake two of the objects; return the names of their images, and the floor's mean by records and by paths."""
    scene = bpy.context.scene
    bpy.ops.object.select_all(action="DESELECT")
    for name in ("Cube", "Plane"):
        bpy.data.objects[name].select_set(True)
    scene.eclat.bake_size, scene.eclat.max_error = 32, 0.03
    means = []
    for method in ("path", "irradiance-cache"):
        scene.eclat.method, scene.eclat.bake_samples = method, 1024
        assert bpy.ops.eclat.bake_light_maps() == {"FINISHED"}
        pixels = np.array(bpy.data.images["Plane light map"].pixels[:]).reshape(32, 32, 4)
        means.append(float(pixels[..., :3].mean()))
    return sorted(image.name for image in bpy.data.images if image.name.endswith("light map")), *means


def viewport(folder):
    """Show the scene in a viewport without a window, through stand-ins of the region and the engine: the mean of what it
    shows and of the final picture of the same view."""
    scene = bpy.context.scene
    graph = bpy.context.evaluated_depsgraph_get()
    camera = scene.camera
    window = camera.calc_matrix_camera(graph, x=scenes.SIZE[0], y=scenes.SIZE[1])
    context = SimpleNamespace(
        region=SimpleNamespace(width=scenes.SIZE[0], height=scenes.SIZE[1]),
        region_data=SimpleNamespace(view_matrix=camera.matrix_world.inverted(), window_matrix=window),
    )
    told = []
    engine = SimpleNamespace(
        tag_redraw=lambda: told.append(1), report=lambda *_: None, update_stats=lambda *_: None,
    )  # fmt: skip
    drawing = ViewportDrawing(engine)
    drawing._show = lambda *_: None  # Needs a graphics card.
    drawing.update(context, graph)
    drawing.draw(context, graph)
    end = time.monotonic() + 120
    while drawing._refiner.busy and time.monotonic() < end:
        time.sleep(0.1)
    drawing.draw(context, graph)
    shown = float(drawing._refiner.picture.mean())
    drawing.close()
    assert len(told) > 2
    scene.eclat.method, scene.eclat.samples = "path", 256
    return shown, float(render(folder / "view.exr").mean())


def main(folder):
    eclat_blender.register()
    found = {}
    scenes.build("diffuse_room")
    bpy.context.scene.render.engine = "ECLAT"
    found["passes"] = layers_of(folder)
    found["maps"], found["floor_by_path"], found["floor"] = light_maps()
    found["viewport"], found["viewport_final"] = viewport(folder)
    found["gltf"], found["blender"] = by_gltf(folder)
    eclat_blender.unregister()
    found["unregistered"] = not hasattr(bpy.types.Scene, "eclat") and not hasattr(bpy.types, "EclatRenderEngine")
    (folder / "means.json").write_text(json.dumps(found))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
