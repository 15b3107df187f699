# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Stand-ins for what the Blender add-on reads of `bpy`: nodes, meshes, lamps, cameras, dependency graphs, engines."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np


class Columns:
    """A collection of Blender whose properties are arrays, read by `foreach_get`."""

    def __init__(self, count: int, **arrays: Any) -> None:
        self._count, self._arrays = count, arrays

    def __len__(self) -> int:
        return self._count

    def foreach_get(self, name: str, values: np.ndarray) -> None:
        values[:] = np.asarray(self._arrays[name], values.dtype).ravel()


class Inputs(list):
    """Sockets by number or name."""

    def __getitem__(self, key: Any) -> Any:
        return super().__getitem__(key) if isinstance(key, int | slice) else next(s for s in self if s.name == key)

    def __contains__(self, key: Any) -> bool:
        return any(key in (s, s.name) for s in self)


def socket(name: str, value: Any = 0.0, kind: str | None = None) -> Any:
    kind = kind or ("VALUE" if isinstance(value, int | float) else "RGBA" if len(value) == 4 else "VECTOR")
    return SimpleNamespace(
        name=name, identifier=name, type=kind, default_value=value, links=[], is_linked=False, enabled=True
    )


def node(kind: str, inputs: dict[str, Any] | None = None, outputs: dict[str, Any] | None = None, **more: Any) -> Any:
    made = SimpleNamespace(
        type=kind, name=kind, bl_label=kind.title(), mute=False, internal_links=[], is_active_output=True,
        inputs=Inputs(socket(name, value) for name, value in (inputs or {}).items()),
        outputs=Inputs(socket(name, value) for name, value in (outputs or {"Color": (0, 0, 0, 1)}).items()),
    )  # fmt: skip
    made.__dict__.update(more)
    return made


def link(source: Any, output: str, target: Any, name: str | int) -> None:
    end = target.inputs[name]
    made = SimpleNamespace(
        from_node=source,
        from_socket=source.outputs[output],
        to_node=target,
        to_socket=end,
        is_valid=True,
        is_muted=False,
    )
    end.links.append(made)
    end.is_linked = True


def tree(*nodes: Any) -> Any:
    return SimpleNamespace(nodes=list(nodes))


class Pixels(Columns):
    """`Image.pixels`, which takes the array only."""

    def foreach_get(self, values: np.ndarray) -> None:  # type: ignore[override]
        super().foreach_get("", values)


def picture(name: str, texels: np.ndarray, space: str = "Non-Color", is_float: bool = True) -> Any:
    """An image of RGBA (H, W, 4), row 0 on top."""
    height, width = texels.shape[:2]
    return SimpleNamespace(
        name=name, name_full=name, size=(width, height), source="GENERATED", is_float=is_float,
        colorspace_settings=SimpleNamespace(name=space), pixels=Pixels(1, **{"": texels[::-1]}),
    )  # fmt: skip


def image_node(texels: np.ndarray, space: str = "Non-Color", is_float: bool = True) -> Any:
    return node(
        "TEX_IMAGE", {"Vector": (0, 0, 0)}, {"Color": (0, 0, 0, 1), "Alpha": 1.0}, image=picture("i", texels, space, is_float),
        projection="FLAT", extension="REPEAT", interpolation="Linear",
    )  # fmt: skip


def material(shader: Any, *others: Any, output: str = "BSDF") -> Any:
    end = node(
        "OUTPUT_MATERIAL", {"Surface": (0, 0, 0, 1), "Volume": (0, 0, 0, 1), "Displacement": (0, 0, 0)}, target="ALL"
    )
    link(shader, output, end, "Surface")
    return SimpleNamespace(
        name="stuff", name_full="stuff", diffuse_color=(0.8, 0.8, 0.8, 1), node_tree=tree(end, shader, *others)
    )


def principled(**changed: Any) -> Any:
    inputs: dict[str, Any] = {
        "Base Color": (0.8, 0.8, 0.8, 1.0), "Metallic": 0.0, "Roughness": 0.5, "IOR": 1.5, "Alpha": 1.0,
        "Normal": (0.0, 0.0, 0.0), "Subsurface Weight": 0.0, "Specular IOR Level": 0.5,
        "Specular Tint": (1.0, 1.0, 1.0, 1.0), "Anisotropic": 0.0, "Transmission Weight": 0.0, "Coat Weight": 0.0,
        "Sheen Weight": 0.0, "Emission Color": (1.0, 1.0, 1.0, 1.0), "Emission Strength": 0.0,
    }  # fmt: skip
    for name, value in changed.items():
        inputs[name.replace("_", " ")] = value
    return node("BSDF_PRINCIPLED", inputs, {"BSDF": (0, 0, 0, 1)}, distribution="GGX")


def square_mesh() -> Any:
    """A square of side 2 in the plane z = 0 that faces up, with a UV map that covers the image."""
    places = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], float)
    uv = SimpleNamespace(name="map", active_render=True, uv=Columns(4, vector=[(0, 0), (1, 0), (1, 1), (0, 1)]))
    return SimpleNamespace(
        calc_loop_triangles=lambda: None,
        loop_triangles=Columns(2, loops=[(0, 1, 2), (0, 2, 3)], material_index=[0, 0]),
        loops=Columns(4, vertex_index=[0, 1, 2, 3]),
        vertices=Columns(4, co=places),
        corner_normals=Columns(4, vector=[(0, 0, 1)] * 4),
        uv_layers=[uv],
        color_attributes=SimpleNamespace(render_color_index=-1),
    )


def thing(kind: str, data: Any, name: str, mesh: Any = None, materials: tuple[Any, ...] = ()) -> Any:
    slots = [SimpleNamespace(material=material) for material in materials]
    return SimpleNamespace(
        type=kind, data=data, name=name, name_full=name, material_slots=slots, particle_systems=[],
        to_mesh=lambda: mesh, to_mesh_clear=lambda: None,
    )  # fmt: skip


def solid(name: str = "square", materials: tuple[Any, ...] = ()) -> Any:
    return thing("MESH", SimpleNamespace(as_pointer=lambda: 1), name, square_mesh(), materials)


def light(kind: str, energy: float, **more: Any) -> Any:
    made = SimpleNamespace(
        type=kind, energy=energy, color=(1.0, 1.0, 1.0), use_shadow=True, shadow_soft_size=0.0, angle=0.0, spot_size=1.0,
        spot_blend=0.0, shape="SQUARE", size=1.0, size_y=1.0, spread=np.pi,
    )  # fmt: skip
    made.__dict__.update(more)
    return made


def camera_data(**more: Any) -> Any:
    dof = SimpleNamespace(
        use_dof=False, aperture_blades=0, aperture_ratio=1.0, focus_distance=5.0, focus_object=None, aperture_fstop=2.8
    )
    made = SimpleNamespace(
        type="PERSP", name="camera", lens=50.0, sensor_width=36.0, sensor_height=24.0, sensor_fit="AUTO", shift_x=0.0,
        shift_y=0.0, ortho_scale=6.0, dof=dof,
    )  # fmt: skip
    made.__dict__.update(more)
    return made


def world(color: tuple[float, ...] = (1, 1, 1, 1), strength: float = 1.0) -> Any:
    shader = node("BACKGROUND", {"Color": color, "Strength": strength}, {"Background": (0, 0, 0, 1)})
    end = node("OUTPUT_WORLD", {"Surface": (0, 0, 0, 1), "Volume": (0, 0, 0, 1)}, target="ALL")
    link(shader, "Background", end, "Surface")
    return SimpleNamespace(name="world", color=color[:3], node_tree=tree(end, shader))


def from_above(height: float) -> np.ndarray:
    """The transform of a camera that looks straight down from a height."""
    to_world = np.eye(4)
    to_world[2, 3] = height
    return to_world


def depsgraph(things: list[tuple[Any, np.ndarray]], size: tuple[int, int] = (8, 6), **more: Any) -> Any:
    """What a dependency graph shows of objects with their transforms, under a white world and a camera from above."""
    settings = SimpleNamespace(
        method="path", max_error=0.05, use_time=False, time=60.0, samples=16, denoise=False, seed=0, bake_size=16,
        bake_margin=2, bake_samples=64, bake_component="total",
    )  # fmt: skip
    render = SimpleNamespace(
        resolution_x=size[0], resolution_y=size[1], resolution_percentage=100, pixel_aspect_x=1.0, pixel_aspect_y=1.0,
        use_border=False, use_crop_to_border=False, threads_mode="FIXED", threads=1, film_transparent=False,
        border_min_x=0.0, border_max_x=1.0, border_min_y=0.0, border_max_y=1.0,
    )  # fmt: skip
    render.__dict__.update(more)
    placed = SimpleNamespace(data=camera_data(type="ORTHO", ortho_scale=4.0), matrix_world=from_above(5.0))
    own = SimpleNamespace(use_direct=True, use_indirect=True, use_albedo=True, use_record_density=False)
    layer = SimpleNamespace(name="layer", eclat=own, use_pass_z=True, use_pass_normal=True)
    instances = [
        SimpleNamespace(object=thing, matrix_world=matrix, show_self=True, is_instance=False)
        for thing, matrix in things
    ]
    scene = SimpleNamespace(name="scene", eclat=settings, render=render, camera=placed, world=world())
    return SimpleNamespace(scene=scene, view_layer=layer, object_instances=instances)


class Engine:
    """Keeps what an engine writes and reports. `breaks` says after how many calls of `test_break` Esc is pressed."""

    is_preview = False

    def __init__(self, breaks: int | None = None) -> None:
        self.breaks, self.asked = breaks, 0
        self.reports: list[tuple[str, str]] = []
        self.results: list[Any] = []
        self.channels = {"Combined": 4}
        self.error = ""

    def add_pass(self, name: str, channels: int, ids: str, layer: str) -> None:
        self.channels[name] = channels

    def begin_result(self, x: int, y: int, width: int, height: int, layer: str) -> Any:
        passes = [
            SimpleNamespace(name=name, rect=_Rect(width * height * channels))
            for name, channels in self.channels.items()
        ]
        return SimpleNamespace(x=x, y=y, width=width, height=height, layers=[SimpleNamespace(passes=passes)])

    def end_result(self, result: Any) -> None:
        self.results.append(result)

    def update_result(self, result: Any) -> None:
        pass

    def update_progress(self, fraction: float) -> None:
        assert 0 <= fraction <= 1

    def update_stats(self, stats: str, info: str) -> None:
        pass

    def test_break(self) -> bool:
        self.asked += 1
        return self.breaks is not None and self.asked > self.breaks

    def report(self, kind: set[str], text: str) -> None:
        self.reports.append((next(iter(kind)), text))

    def error_set(self, text: str) -> None:
        self.error = text

    def picture(self, name: str = "Combined") -> np.ndarray:
        """The last result of a pass, row 0 on top."""
        result = self.results[-1]
        found = next(p for p in result.layers[0].passes if p.name == name)
        return found.rect.values.reshape(result.height, result.width, -1)[::-1]


class _Rect:
    def __init__(self, count: int) -> None:
        self.values = np.full(count, np.nan, np.float32)

    def foreach_set(self, values: np.ndarray) -> None:
        self.values[:] = values
