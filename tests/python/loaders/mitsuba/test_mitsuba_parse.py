# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Mitsuba XML and dicts to the same scene: parameters, includes, references, transforms, colours, and bad input."""

from __future__ import annotations

import re
import warnings
from pathlib import Path

import numpy as np
import pytest

from eclat.errors import EclatError, EclatWarning
from eclat.loaders.mitsuba import load_dict, load_xml
from eclat.scene import Scene
from support.mitsuba_files import WHOLE


def load(tmp_path: Path, body: str, version: str = "3.0.0", **parameters: str) -> Scene:
    path = tmp_path / "scene.xml"
    path.write_text(f'<scene version="{version}">\n{body}\n</scene>', encoding="utf-8")
    return load_xml(path, parameters)


def positions(scene: Scene) -> np.ndarray:
    return np.asarray(scene.meshes[0].positions)


def test_a_whole_scene(tmp_path: Path) -> None:
    path = tmp_path / "whole.xml"
    path.write_text(WHOLE)
    scene = load_xml(path)
    assert scene.name == "whole" and len(scene.meshes) == 2 and len(scene.lights) == 1
    assert scene.cameras[0].fov == 50
    assert scene.meshes[0].material.kind == "plastic" and scene.meshes[0].material.two_sided
    assert np.allclose(np.asarray(scene.meshes[0].positions).mean(axis=0), (1, 2, 0))


def test_parameters_beat_defaults_and_the_longest_name_wins(tmp_path: Path) -> None:
    path = tmp_path / "whole.xml"
    path.write_text(WHOLE)
    assert load_xml(path, {"angles": "60"}).cameras[0].fov == 60
    assert load_xml(path, {"angle": "60"}).cameras[0].fov == 50
    with pytest.warns(EclatWarning, match="the parameter 'angels' is not used; did you mean 'angles'"):
        load_xml(path, {"angels": "60"})


def test_parameters_without_a_value_are_refused(tmp_path: Path) -> None:
    body = '<default name="size" value="1"/>\n<shape type="sphere"><float name="radius" value="$sise"/></shape>'
    with pytest.raises(
        EclatError, match=r"scene\.xml:3 <float name=\"radius\">.*\$sise has neither a value.*did you mean 'size'"
    ):
        load(tmp_path, body)


def test_parameters_that_expand_exponentially_do_not_fill_the_memory(tmp_path: Path) -> None:
    defaults = "".join(f'<default name="p{i}_" value="$p{i - 1}_$p{i - 1}_"/>' for i in range(1, 60))
    with pytest.raises(EclatError, match=r"at most 16384 characters .* after the substitution"):
        load(tmp_path, f'<default name="p0_" value="lol"/>{defaults}')


def test_included_files_share_ids_parameters_and_folders(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "materials.xml").write_text(
        '<scene version="3.0.0"><bsdf type="phong" id="m"><float name="exponent" value="$e"/></bsdf></scene>'
    )
    (tmp_path / "parts" / "one.xml").write_text('<shape type="rectangle"><ref id="m"/></shape>')
    includes = '<include filename="parts/materials.xml"/><include filename="parts/one.xml"/>'
    scene = load(tmp_path, f'<default name="e" value="7"/>{includes}')
    assert scene.meshes[0].material.parameters["exponent"].constant[0] == 7


def test_includes_that_go_in_circles_or_lead_nowhere_are_refused(tmp_path: Path) -> None:
    with pytest.raises(EclatError, match=r"scene\.xml:2 <include>: the file scene\.xml includes itself"):
        load(tmp_path, '<include filename="scene.xml"/>')
    with pytest.raises(EclatError, match=r"scene\.xml:2 <include>.*none\.xml"):
        load(tmp_path, '<include filename="none.xml"/>')
    (tmp_path / "many.xml").write_text('<scene version="3.0.0">' + '<include filename="leaf.xml"/>' * 600 + "</scene>")
    (tmp_path / "leaf.xml").write_text('<scene version="3.0.0"/>')
    with pytest.raises(EclatError, match="expected at most 1000 included files"):
        load(tmp_path, '<include filename="many.xml"/>' * 2)


def test_includes_in_the_depth_of_includes_do_not_exhaust_the_stack(tmp_path: Path) -> None:
    for i in range(40):
        inner = f'<include filename="f{i + 1}.xml"/>'
        (tmp_path / f"f{i}.xml").write_text("<bsdf type='twosided'>" * 30 + inner + "</bsdf>" * 30)
    with pytest.raises(EclatError, match="at most 50 levels of nested"):
        load(tmp_path, '<include filename="f0.xml"/>')


def test_references_go_forwards_and_backwards(tmp_path: Path) -> None:
    shape = '<shape type="rectangle"><ref id="late"/></shape>'
    scene = load(tmp_path, f'{shape}<bsdf type="ward" id="late"/>{shape}')
    assert scene.meshes[0].material.kind == "ward"
    assert scene.meshes[0].material is scene.meshes[1].material


def test_references_to_nothing_and_to_themselves_are_refused(tmp_path: Path) -> None:
    shape = '<bsdf type="diffuse" id="Marble"/><shape type="rectangle">\n<ref id="Marbel"/></shape>'
    with pytest.raises(
        EclatError, match=r"scene\.xml:3 <ref id=\"Marbel\">: expected the id .*; did you mean 'Marble'"
    ):
        load(tmp_path, shape)
    with pytest.raises(EclatError, match="refers to itself"):
        load(tmp_path, '<bsdf type="twosided" id="a"><ref id="b"/></bsdf><bsdf type="mask" id="b"><ref id="a"/></bsdf>')
    with pytest.raises(EclatError, match="refers to itself"):
        load(tmp_path, '<alias id="a" as="b"/><alias id="b" as="a"/><shape type="cube"><ref id="a"/></shape>')
    chain = "".join(f'<bsdf type="mask" id="m{i}"><ref id="m{i + 1}"/></bsdf>' for i in range(200))
    with pytest.raises(EclatError, match="at most 50 levels of nested"):
        load(tmp_path, f'{chain}<bsdf type="diffuse" id="m200"/><shape type="cube"><ref id="m0"/></shape>')


def test_the_first_of_two_objects_with_the_same_id_is_kept(tmp_path: Path) -> None:
    body = '<bsdf type="ward" id="m"/><bsdf type="phong" id="m"/><shape type="cube"><ref id="m"/></shape>'
    with pytest.warns(EclatWarning, match="the id 'm' is also the id of"):
        assert load(tmp_path, body).meshes[0].material.kind == "ward"


@pytest.mark.parametrize(
    "steps",
    [
        '<translate x="1"/><rotate z="1" angle="90"/><scale x="2" y="3"/>',
        '<rotate x="1" y="2" z="2" angle="-30"/><translate value="1, 2, 3"/>',
        '<scale value="2"/><matrix value="0 0 1 5 0 1 0 6 -1 0 0 7 0 0 0 1"/>',
        '<matrix value="0 1 0 -1 0 0 0 0 1"/><translate y="-.5"/>',
        '<lookat origin="1, 2, 3" target="4, -5, 6" up="0, 0, 1"/><scale value="0.5"/>',
    ],
)
def test_transforms_apply_in_the_order_of_the_file(tmp_path: Path, steps: str) -> None:
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    shape = f'<shape type="rectangle"><transform name="to_world">{steps}</transform></shape>'
    steps_of_unit_axes = steps.replace('x="1" y="2" z="2"', 'x="0.33333333" y="0.66666667" z="0.66666667"')
    theirs = mi.load_string(f'<scene version="3.0.0">{shape.replace(steps, steps_of_unit_axes)}</scene>')
    expected = theirs.bbox()
    got = positions(load(tmp_path, shape))
    assert np.allclose(got.min(axis=0), expected.min, atol=1e-4)
    assert np.allclose(got.max(axis=0), expected.max, atol=1e-4)


def test_old_and_new_names_mean_the_same(tmp_path: Path) -> None:
    old = (
        '<sensor type="perspective"><string name="fovAxis" value="smaller"/><float name="fov" value="33"/>'
        '<transform name="toWorld"><lookAt origin="1,1,1" target="0,0,0" up="0,1,0"/></transform></sensor>'
        '<shape type="sphere"><boolean name="flipNormals" value="true"/><bsdf type="plastic">'
        '<float name="intIOR" value="1.9"/><spectrum name="diffuseReflectance" value=".1 .2 .3"/></bsdf></shape>'
    )
    new = re.sub(r'(?<=name=")\w+', lambda name: re.sub("([a-z])([A-Z])", r"\1_\2", name[0]).lower(), old)
    assert new != old
    a, b = load(tmp_path, old, "0.5.0"), load(tmp_path, new.replace("lookAt", "lookat"))
    assert np.array_equal(a.cameras[0].to_world, b.cameras[0].to_world) and a.cameras[0].fov_axis == "smaller"
    assert np.array_equal(a.meshes[0].triangles, b.meshes[0].triangles)
    for name, value in a.meshes[0].material.parameters.items():
        assert value == b.meshes[0].material.parameters[name] or value.constant == pytest.approx(
            b.meshes[0].material.parameters[name].constant
        )


def test_old_tags_are_understood(tmp_path: Path) -> None:
    body = (
        '<background type="constant"><rgb name="radiance" value="1 2 3"/></background>'
        '<luminaire type="point"/><camera type="perspective"/>'
    )
    scene = load(tmp_path, body, "0.4.0")
    assert scene.environment is not None and len(scene.lights) == 1 and len(scene.cameras) == 1


@pytest.mark.parametrize(
    ("color", "expected"),
    [
        ('<rgb name="reflectance" value=".1, .2 .3,"/>', (0.1, 0.2, 0.3)),
        ('<rgb name="reflectance" value="0.4"/>', (0.4, 0.4, 0.4)),
        ('<rgb name="reflectance" value="#ff8000"/>', (1.0, 0.21586, 0.0)),
        ('<srgb name="reflectance" value="1 0.5 0"/>', (1.0, 0.21404, 0.0)),
        ('<srgb name="reflectance" value="#f80"/>', (1.0, 0.24620, 0.0)),
        ('<spectrum name="reflectance" value="0.73f"/>', (0.73, 0.73, 0.73)),
        ('<spectrum name="reflectance" value=".65 .65 .47"/>', (0.65, 0.65, 0.47)),
        ('<spectrum name="reflectance" value="300:.2 , 900 : 0.2,"/>', (0.2, 0.2, 0.2)),
        ('<spectrum name="reflectance" filename="flat.spd"/>', (0.3, 0.3, 0.3)),
        ('<spectrum name="reflectance" filename="utf16.spd"/>', (0.3, 0.3, 0.3)),
        ('<spectrum name="reflectance" type="uniform"><float name="value" value="0.3"/></spectrum>', (0.3, 0.3, 0.3)),
        ('<float name="reflectance" value="0.25"/>', (0.25, 0.25, 0.25)),
        ('<texture name="reflectance" type="scale"><float name="scale" value="0.5"/><rgb name="value" value="1 .5 0"/>'
         "</texture>", (0.5, 0.25, 0.0)),
    ],
)  # fmt: skip
def test_colours_however_they_are_written(tmp_path: Path, color: str, expected: tuple[float, ...]) -> None:
    (tmp_path / "flat.spd").write_text("# a grey\n300 0.3\n\n 900\t0.3 # end\n")
    (tmp_path / "utf16.spd").write_text("300 0.3\n900 0.3\n", encoding="utf-16")
    scene = load(tmp_path, f'<shape type="rectangle"><bsdf type="diffuse">{color}</bsdf></shape>')
    assert scene.meshes[0].material.parameters["reflectance"].constant == pytest.approx(expected, abs=1e-4)


@pytest.mark.parametrize(("version", "expected"), [("0.6.0", (2, 2, 2)), ("3.0.0", (2.40959, 1.89658, 1.81783))])
def test_a_light_of_one_number_is_grey_before_version_3(
    tmp_path: Path, version: str, expected: tuple[float, ...]
) -> None:
    light = '<emitter type="point"><spectrum name="intensity" value="2"/></emitter>'
    assert load(tmp_path, light, version).lights[0].intensity == pytest.approx(expected, rel=1e-4)  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ('<shape type="sphere"><float name="radius" value="1,5x"/></shape>', "expected a number, got '1,5x'"),
        ('<shape type="sphere"><float name="radius" value="nan"/></shape>', "expected a number, got 'nan'"),
        (
            '<shape type="sphere"><float name="radius" value="1e999"/></shape>',
            "whose absolute value is at most 1e+30, got inf",
        ),
        ('<shape type="sphere"><float name="radius"/></shape>', "expected the attribute value"),
        (
            '<shape type="cube"><boolean name="flip_normals" value="maybe"/></shape>',
            "expected true or false, got 'maybe'",
        ),
        ('<shape type="sphere"><point name="center" value="1 2"/></shape>', "expected three numbers, got '1 2'"),
        ("<shape/>", "expected the attribute type"),
        (
            '<shape type="cube"><transform name="to_world"><matrix value="1 2 3"/></transform></shape>',
            "16 or 9 numbers",
        ),
        (
            '<shape type="cube"><transform name="to_world"><rotate angle="3"/></transform></shape>',
            "expected a rotation axis",
        ),
        ('<shape type="cube"><transform name="to_world"><skew x="3"/></transform></shape>', "expected one of lookat"),
        (
            '<shape type="cube"><transform name="to_world"><lookat origin="0 0 0"/></transform></shape>',
            "attribute target",
        ),
        (
            '<sensor type="perspective"><transform name="to_world">'
            '<lookat origin="0 1 0" target="0 1 0" up="0 0 1"/></transform></sensor>',
            "got [0.0, 1.0, 0.0] for both",
        ),
        (
            '<emitter type="point"><rgb name="intensity" value="1 2"/></emitter>',
            "expected three numbers, one number, or",
        ),
        ('<emitter type="point"><spectrum name="intensity" value="400:a"/></emitter>', "expected a number, got 'a'"),
    ],
)
def test_errors_name_file_line_element_and_expectation(tmp_path: Path, body: str, message: str) -> None:
    with pytest.raises(EclatError, match=r"scene\.xml:2 <\w+.*" + re.escape(message)):
        load(tmp_path, body)


def test_unknown_properties_cause_warnings_and_known_unused_ones_do_not(tmp_path: Path) -> None:
    silent = '<integrator type="bdpt"/><sampler type="sobol"/><film type="hdrfilm"/><bsdf type="hk"/>'
    with pytest.warns(EclatWarning) as record:
        load(
            tmp_path,
            f'{silent}<integrator type="mine"/><phase type="hg"/><fancy/><shape type="cube"><float value="1"/></shape>',
        )
    text = "\n".join(str(warning.message) for warning in record)
    assert len(record) == 4
    assert (
        "the integrator type 'mine' is unknown" in text
        and "phase" in text
        and "<fancy>: this element is unknown" in text
    )
    assert "this property has no name" in text


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (
            '<integrator type="path"><boolean name="hideEmitters" value="true"/></integrator>'
            '<emitter type="constant"/>',
            "but not the sky",
        ),
        ('<integrator type="volpath"><integer name="max_depth" value="8"/></integrator>', "max_depth to 8"),
        (
            '<integrator type="irrcache"><integrator type="path"><integer name="maxDepth" value="3"/></integrator>'
            "</integrator>",
            "max_depth to 3",
        ),
        ('<integrator type="direct"/>', "include indirect light"),
        ('<integrator type="depth"/>', "include all light"),
        ('<sensor type="perspective"><film type="hdrfilm"/></sensor>', "has a gaussian one"),
        ('<sensor type="perspective"><film type="hdrfilm"><rfilter type="gaussian"/></film></sensor>', "filter"),
        ('<sensor type="perspective"><film type="hdrfilm"><rfilter type="tent"/></film></sensor>', "--filter tent"),
    ],
)  # fmt: skip
def test_settings_that_change_the_picture_are_named(tmp_path: Path, settings: str, message: str) -> None:
    with pytest.warns(EclatWarning) as record:
        load(tmp_path, settings)
    assert [message in str(warning.message) for warning in record] == [True]


@pytest.mark.parametrize(
    "settings",
    [
        '<integrator type="path"><integer name="max_depth" value="-1"/><integer name="rr_depth" value="3"/></integrator>',
        '<integrator type="path"><boolean name="hide_emitters" value="false"/></integrator>',
        '<integrator type="path"><boolean name="hide_emitters" value="true"/></integrator>',
        '<sensor type="perspective"><film type="hdrfilm"><rfilter type="box"/></film></sensor>',
    ],
)
def test_settings_that_change_nothing_are_not(tmp_path: Path, settings: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        load(tmp_path, settings)


def test_the_dict_form_is_the_same_scene(tmp_path: Path) -> None:
    white = {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.8, 0.7, 0.6]}}
    matrix = np.array([[1, 0, 0, 1], [0, 1, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1.0]])
    light = {"type": "area", "radiance": {"type": "spectrum", "value": [(400, 1.0), (700, 2.0)]}}
    ours = load_dict(
        {
            "type": "scene",
            "white": white,
            "floor": {
                "type": "rectangle",
                "to_world": matrix,
                "bsdf": {"type": "ref", "id": "white"},
                "emitter": light,
            },
        }
    )
    theirs = load(
        tmp_path,
        '<bsdf type="diffuse" id="white"><rgb name="reflectance" value="0.8 0.7 0.6"/></bsdf><shape type="rectangle" '
        'id="floor"><transform name="to_world"><translate x="1" y="2" z="3"/></transform><ref id="white"/>'
        '<emitter type="area"><spectrum name="radiance" value="400:1, 700:2"/></emitter></shape>',
    )
    a, b = ours.meshes[0], theirs.meshes[0]
    assert a.name == b.name == "floor" and a.material.name == b.material.name == "white"
    assert np.array_equal(a.positions, b.positions)
    assert a.material.parameters["reflectance"].constant == b.material.parameters["reflectance"].constant
    assert a.material.emission is not None and b.material.emission is not None
    assert a.material.emission.constant == b.material.emission.constant


def test_mitsubas_own_cornell_box_loads() -> None:
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    scene = load_dict(mi.cornell_box())
    assert len(scene.meshes) == 8
    assert [mesh.name for mesh in scene.meshes if mesh.material.emission] == ["light"]
    assert scene.cameras[0].size == (256, 256)


def test_the_depth_of_an_integrator_of_an_unknown_type_is_named(tmp_path: Path) -> None:
    (tmp_path / "scene.xml").write_text(
        '<scene version="3.0.0"><integrator type="mine"><integer name="max_depth" value="2"/></integrator>'
        '<shape type="rectangle"/></scene>'
    )
    with pytest.warns(EclatWarning) as caught:
        load_xml(tmp_path / "scene.xml")
    assert [("'mine' is unknown" in str(w.message), "max_depth to 2" in str(w.message)) for w in caught] in (
        [(True, False), (False, True)],
        [(False, True), (True, False)],
    )
