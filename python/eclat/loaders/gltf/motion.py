# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A glTF scene over time: which of its objects move, and what it looks like at a time."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass

from eclat.errors import EclatError
from eclat.loaders.gltf.animations import Channels
from eclat.loaders.gltf.builder import Builder, Sources
from eclat.loaders.gltf.container import Document
from eclat.loaders.gltf.nodes import moving_with
from eclat.loaders.gltf.skins import joint_indices
from eclat.loaders.posing import later
from eclat.motion.animation import Motion, Pose


@dataclass(frozen=True)
class _Changing:
    """The indices of what changes: nodes that are moved, nodes and meshes that change their shape, and values of
    materials, lights and cameras."""

    nodes: set[int]
    materials: set[int]
    lights: set[int]
    cameras: set[int]


def motion_of(document: Document, sources: Sources, builder: Builder, rest: Pose) -> Motion | None:
    """Return the motion of a file whose rest pose `builder` has built, or None if nothing moves."""
    channels = sources.channels
    if channels is None or not any(channel.track.moves for channel in channels.channels):
        return None
    changing = _changing(document, channels)
    origins = builder.origins
    moved = {key for key, o in origins.items() if o.node in changing.nodes}

    def changed(group: Mapping[Hashable, object], indices: set[int]) -> list[Hashable]:
        return [key for key in group if key in moved or origins[key].index in indices]

    lights = changed(rest.lights, changing.lights)
    cameras = changed(rest.cameras, changing.cameras)

    def pose(time: float) -> Pose:
        return _pose_at(document, sources, changing.materials, rest, {*lights, *cameras}, time)

    return Motion(
        rest=rest,
        pose=later(pose),
        start=channels.start,
        end=channels.end,
        objects=tuple(dict.fromkeys(rest.meshes[key].name for key in changed(rest.meshes, changing.materials))),
        lights=tuple(rest.lights[key].name or f"light {n}" for n, key in enumerate(rest.lights) if key in lights),
        cameras=tuple(rest.cameras[key].name for key in cameras),
    )


def _changing(document: Document, channels: Channels) -> _Changing:
    nodes = document.elements("nodes")
    moving = moving_with(document, channels.of("nodes", among=("translation", "rotation", "scale")))
    shaped = channels.of("nodes", among=("weights",))
    meshes = channels.of("meshes")
    for index, node in enumerate(nodes):
        try:
            joints = joint_indices(document, node)
            mesh = node.index("mesh", len(document.elements("meshes")), "meshes")
        except EclatError:
            continue  # The rest pose has reported it.
        if mesh in meshes or (joints is not None and not moving.isdisjoint(joints)):
            shaped.add(index)
    lights = channels.of("extensions", "KHR_lights_punctual", "lights")
    return _Changing(moving | shaped, channels.of("materials"), lights, channels.of("cameras"))


def _pose_at(
    document: Document, sources: Sources, materials: set[int], rest: Pose, moving: set[Hashable], time: float
) -> Pose:
    """Return the pose at a time in seconds, with the materials, and the lights and cameras with the keys `moving`, that
    change; all others are those of the rest pose.
    """
    assert sources.channels is not None
    changed = document.changed(sources.channels.at(document.root.data, time))
    builder = Builder(changed, sources, sources.materials.changed(changed, materials) if materials else None)
    found = builder.build()
    lights = {key: light for key, light in found.lights.items() if key in moving}
    cameras = {key: camera for key, camera in found.cameras.items() if key in moving}
    return Pose(found.meshes, {**rest.lights, **lights}, {**rest.cameras, **cameras})
