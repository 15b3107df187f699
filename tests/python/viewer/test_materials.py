# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What the page is told of materials that it cannot show as they are."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.measured_brdf import normal_albedo
from eclat.scene import Camera, Material, Mesh, Scene, look_at
from eclat.viewer.lamps import parts_of
from eclat.viewer.messages import decode_message
from eclat.viewer.surfaces import scene_message
from support.brdf_files import merl_file, shiny_paint


def test_measured_materials_are_named_and_shown_with_their_albedo(tmp_path: Path) -> None:
    path = tmp_path / "paint.binary"
    path.write_bytes(merl_file(shiny_paint()))
    brdf = eclat.load_brdf(path)
    corners = np.array([[0, 0, 0], [0, 0, 1], [1, 0, 0]], float)
    mesh = Mesh(corners, np.array([[0, 1, 2]]), Material("measured", name="paint", measured=brdf), name="floor")
    scene = Scene((mesh,), (), cameras=(Camera(look_at((0, 3, 0), (0, 0, 0), up=(0, 0, 1))),))
    with pytest.warns(eclat.EclatWarning, match="'paint' is measured") as warned:
        header, _ = decode_message(scene_message(scene, parts_of(scene, None)))
    assert len(warned) == 1 and any("'paint' is measured" in note for note in header["notes"])
    (material,) = header["materials"]
    np.testing.assert_allclose(material["diffuse"]["constant"], normal_albedo(brdf), rtol=1e-6)
