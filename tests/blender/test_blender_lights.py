# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The light of Blender's lamps: the watts that they send, their edges and their places."""

import math

import numpy as np
import pytest

from eclat.scene import DirectionalLight, Mesh, PointLight, SpotLight, triangle_areas
from eclat_blender.lights import lamp, spot_angles
from eclat_blender.notices import Notices
from eclat_blender.translate import translate
from support.blender_standins import depsgraph, light, solid, thing

ABOVE = np.array([(1, 0, 0, 2), (0, 1, 0, 3), (0, 0, 1, 4), (0, 0, 0, 1)], float)


def test_a_point_sends_its_watts_over_the_sphere():
    made = lamp(light("POINT", 10.0, color=(1, 0.5, 0)), ABOVE, "lamp", Notices())
    assert isinstance(made, PointLight) and made.position == (2, 3, 4)
    assert np.allclose(np.array(made.intensity) * 4 * math.pi, (10, 5, 0))


@pytest.mark.parametrize("radius", [0.01, 0.5])
def test_a_sphere_sends_the_same_watts(radius):
    made = lamp(light("POINT", 10.0, shadow_soft_size=radius), ABOVE, "lamp", Notices())
    assert isinstance(made, Mesh) and made.material.emission is not None
    corners = np.asarray(made.positions)[np.asarray(made.triangles)]
    assert triangle_areas(corners).sum() * math.pi * made.material.emission.constant[0] == pytest.approx(10.0)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert ((corners.mean(axis=1) - ABOVE[:3, 3]) * normals).sum(axis=1).min() > 0  # It glows outwards.
    assert triangle_areas(corners).sum() == pytest.approx(4 * math.pi * radius**2, rel=0.02)


@pytest.mark.parametrize(
    ("shape", "area"), [("SQUARE", 4.0), ("RECTANGLE", 6.0), ("DISK", math.pi), ("ELLIPSE", 1.5 * math.pi)]
)
def test_an_area_sends_its_watts_over_the_half_space_before_it(shape, area):
    made = lamp(light("AREA", 10.0, shape=shape, size=2.0, size_y=3.0), ABOVE, "lamp", Notices())
    assert isinstance(made, Mesh) and made.material.emission is not None and made.material.back_culled
    corners = np.asarray(made.positions)[np.asarray(made.triangles)]
    found = triangle_areas(corners).sum()
    assert found == pytest.approx(area, rel=0.01)
    assert found * math.pi * made.material.emission.constant[0] == pytest.approx(10.0)
    assert (np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] < 0).all()


def test_a_sun_is_an_irradiance_with_half_its_diameter():
    made = lamp(light("SUN", 3.0, angle=math.radians(0.6)), ABOVE, "lamp", Notices())
    assert isinstance(made, DirectionalLight) and made.direction == (0, 0, -1)
    assert made.irradiance == (3, 3, 3) and made.angular_radius == pytest.approx(0.3)


@pytest.mark.parametrize(("size", "blend"), [(0.5, 0.0), (0.5, 1.0), (1.2, 0.15), (3.0, 0.6)])
def test_a_spot_sends_as_much_light_as_blenders_smooth_step(size, blend):
    made = lamp(light("SPOT", 10.0, spot_size=size, spot_blend=blend), ABOVE, "lamp", Notices())
    assert isinstance(made, SpotLight)
    assert made.intensity[0] * 4 * math.pi == pytest.approx(10)
    cosine = np.linspace(math.cos(size / 2), 1, 200_001)
    edge = max(blend * (1 - math.cos(size / 2)), 1e-12)
    x = np.clip((cosine - math.cos(size / 2)) / edge, 0, 1)
    theirs = (x * x * (3 - 2 * x)).mean()
    inner, outer = (math.cos(math.radians(angle)) for angle in spot_angles(size, blend))
    ours = (np.clip((cosine - outer) / max(inner - outer, 1e-12), 0, 1) ** 2).mean()
    assert ours == pytest.approx(theirs, rel=1e-3)


def test_what_lamps_cannot_do_is_named():
    notices = Notices()
    lamp(light("SPOT", 10.0, shadow_soft_size=0.2), ABOVE, "one", notices)
    lamp(light("AREA", 10.0, spread=1.0), ABOVE, "two", notices)
    lamp(light("SUN", 10.0, use_shadow=False), ABOVE, "three", notices)
    assert [text.split(":")[0] for text in notices.texts] == ["light 'one'", "light 'two'", "light 'three'"]
    assert lamp(light("POINT", 0.0), ABOVE, "dark", notices) is None


@pytest.mark.parametrize("visible", [False, True])
def test_the_camera_sees_objects_and_lamps_with_a_size_only_where_blender_says_so(visible):
    square, other = solid(), solid("other")
    area = thing("LIGHT", light("AREA", 10.0), "area")
    square.visible_camera = area.visible_camera = visible
    notices = Notices()
    made = translate(depsgraph([(square, ABOVE), (other, ABOVE), (area, ABOVE)]), lambda _: None, notices).scene
    hidden = {mesh.name: mesh.material.hidden_from_camera for mesh in made.meshes}
    assert hidden == {"square": not visible, "other": False, "area": not visible}
    assert notices.texts == []
