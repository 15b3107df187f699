# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The command line as a user meets it: help, messages word for word, exit codes, files."""

from __future__ import annotations

import json
import os
import shlex
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import eclat
from eclat.cli import COMMANDS, main
from eclat.cli import render as render_command
from eclat.cli.replay import REPEATED
from eclat.images.image import Image
from eclat.images.image_files import read_png_metadata
from eclat.loaders import load
from support.fake_api import FakeApi

# Absolute, since the tests run in folders of their own.
PATHS = os.pathsep.join(os.path.abspath(path) for path in sys.path)

Output = pytest.CaptureFixture[str]


@pytest.fixture(autouse=True)
def api(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> FakeApi:
    monkeypatch.chdir(tmp_path)
    return FakeApi(monkeypatch)


def errors(capsys: Output) -> str:
    captured = capsys.readouterr()
    assert captured.out == ""
    return captured.err


@pytest.mark.parametrize("command", COMMANDS)
def test_every_help_teaches_by_examples(command: str, capsys: Output) -> None:
    assert main([command, "--help"]) == 0
    text = capsys.readouterr().out
    assert "Examples:" in text
    assert f"eclat {command}" in text.split("Examples:")[1]


def test_without_arguments_the_help_lists_all_commands(capsys: Output) -> None:
    assert main([]) == 0
    text = capsys.readouterr().out
    assert all(f"\n  {command} " in text for command in COMMANDS)


def test_the_time_to_load_the_scene_is_part_of_the_time(monkeypatch: pytest.MonkeyPatch) -> None:
    class Clock:
        now = 0.0

        def perf_counter(self) -> float:
            return self.now

    clock, given = Clock(), []
    load_scene, make = render_command.load_scene_to_show, eclat.render

    def slowly(flags: dict[str, object]) -> object:
        clock.now += seconds
        return load_scene(flags)

    def rendered(*arguments: object, **keywords: object) -> Image:
        given.append(keywords["time"])
        return make(*arguments, **keywords)

    monkeypatch.setattr(render_command, "clock", clock)
    monkeypatch.setattr(render_command, "load_scene_to_show", slowly)
    monkeypatch.setattr(eclat, "render", rendered)
    for seconds in (12.0, 100.0):  # noqa: B007 `slowly` reads it
        assert main(["render", "cornell-box", "--time", "30"]) == 0
    assert main(["render", "cornell-box"]) == 0
    assert given == [18.0, 7.5, None]


def test_help_lists_methods_and_their_options_with_types_and_defaults(capsys: Output) -> None:
    assert main(["render", "--help"]) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert "irradiance-cache Irradiance caching" in text
    assert "weight=tabellion | ward | split-sphere" in text
    assert "neighbor-clamping=true | false" in text


def test_a_default_camera_and_light_need_no_flag(api: FakeApi, capsys: Output) -> None:
    assert main(["render", "cornell-box"]) == 0
    assert os.listdir() == ["cornell-box.png"]
    call = api.calls[0]
    assert type(call["what"]).__name__ == "IrradianceCache"
    assert (call["samples"], call["max_error"], call["size"], call["seed"]) == (None, 0.03, None, 0)
    out = capsys.readouterr()
    assert out.out == "cornell-box.png: 512x512, path, 0.3 s, 32 samples, 3,200 rays\n"
    assert out.err == ""


def test_flags_reach_the_renderer(api: FakeApi) -> None:
    flags = (
        "--method path --set roulette-depth=3 --samples 9 --size 8x6 --crop 1,2,3,4 --max-depth 4 --seed 7 --threads 2"
    )
    assert main(["render", "cornell-box", *flags.split(), "-o", "a.exr", "-o", "a.npy", "-q"]) == 0
    call = api.calls[0]
    assert call["what"].roulette_depth == 3
    expected = {
        "samples": 9,
        "size": (8, 6),
        "crop": (1, 2, 3, 4),
        "max_depth": 4,
        "seed": 7,
        "threads": 2,
        "camera": 0,
    }
    assert {name: call[name] for name in expected} == expected
    assert sorted(os.listdir()) == ["a.exr", "a.npy"]


def test_camera_sun_and_environment_change_the_scene(api: FakeApi) -> None:
    flags = "--camera-from 0,1,5 --camera-to 0,1,0 --fov 30 --environment 1,2,3 --size 8x8"
    assert main(["render", "cornell-box", *flags.split()]) == 0
    scene = api.calls[0]["scene"]
    np.testing.assert_allclose(scene.cameras[0].to_world[:3, 3], [0, 1, 5])
    assert scene.cameras[0].fov == 30
    np.testing.assert_array_equal(scene.environment.image, [[[1, 2, 3]]])


def test_exposure_is_chosen_where_no_file_chose_the_light(api: FakeApi, capsys: Output) -> None:
    """Daylight is true, so that its pictures would be white; what a file shines is shown as it is, unless asked."""

    def shown(*flags: str) -> tuple[str, float | None]:
        assert main(["render", *flags, "--size", "8x8", "-o", "a.png", "-o", "a.exr"]) == 0
        return capsys.readouterr().out, read_png_metadata("a.png").get("exposure")

    Path("bare.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    for flags in (["cornell-box", "--sun", "180,60"], ["bare.obj"], ["cornell-box", "--exposure", "auto"]):
        said, stops = shown(*flags)
        assert stops is not None and f"exposure {stops:+g} stops" in said, flags
        # The pictures of the fake have a log-average of about 0.45.
        assert -2 <= stops <= -1
    for flags in (
        ["cornell-box"],
        ["cornell-box", "--sun", "180,60", "--exposure", "-8"],
        ["bare.obj", "--environment", "1,1,1"],
    ):
        said, stops = shown(*flags)
        assert stops is None and "exposure" not in said, flags


def test_materials_change_by_name(api: FakeApi, capsys: Output) -> None:
    flags = ["--material", "floor=roughplastic,distribution=ggx,alpha=0.2", "--size", "8x8", "-o", "a.png"]
    assert main(["render", "cornell-box", *flags]) == 0
    (floor,) = (m.material for m in api.calls[0]["scene"].meshes if m.name == "floor")
    assert (floor.kind, floor.parameters["alpha_u"].constant[0]) == ("plastic", 0.2)
    assert main(["render", "cornell-box", "--replay-settings", "a.png"]) == 0
    assert [m.material.kind for m in api.calls[1]["scene"].meshes] == [
        m.material.kind for m in api.calls[0]["scene"].meshes
    ]
    capsys.readouterr()
    assert main(["render", "cornell-box", "--material", "flor=plastic"]) == 2
    assert "eclat: material 'flor': expected one of" in (text := errors(capsys)) and "did you mean 'floor'?" in text
    assert main(["render", "cornell-box", "--material", "floor=plastic", "--material", "floor=diffuse"]) == 2
    assert errors(capsys) == "eclat: --material: floor is given twice, expected it once\n"
    assert main(["render", "cornell-box", "--material", "floor"]) == 2
    assert "eclat: --material: expected NAME=KIND,property=value,…" in errors(capsys)


def two_cameras(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = load("cornell-box")
    cameras = tuple(replace(scene.cameras[0], name=name) for name in ("walk", "gallery"))
    monkeypatch.setitem(vars(eclat), "load", lambda path, root: replace(scene, cameras=cameras))


def test_a_camera_by_name_and_by_number(api: FakeApi, capsys: Output, monkeypatch: pytest.MonkeyPatch) -> None:
    two_cameras(monkeypatch)
    for camera in ("gallery", "1"):
        assert main(["render", "atrium", "--camera", camera, "--size", "8x8", "--quiet"]) == 0
    assert [call["camera"] for call in api.calls] == [1, 1]
    assert main(["render", "atrium", "--camera", "galery"]) == 2
    assert errors(capsys) == (
        "eclat: --camera: expected one of 0 'walk', 1 'gallery', got 'galery'; did you mean 'gallery'?\n"
    )


BAD_VALUES = {
    "--size 0x5": "--size: expected a width and a height between 1 and 65,536 pixels, got 0x5",
    "--size 1000000x1000000": "--size: expected a width and a height between 1 and 65,536 pixels, got 1000000x1000000",
    "--size 60000x60000": "--size: expected at most 134,217,728 pixels in total, got 60000x60000",
    "--size 640": "--size: expected WIDTHxHEIGHT in pixels, such as 1280x720, got '640'",
    "--samples -1": "--samples: expected an integer from 1 to 16,777,216, got '-1'",
    "--samples 0": "--samples: expected an integer from 1 to 16,777,216, got '0'",
    "--samples 1e3": "--samples: expected an integer from 1 to 16,777,216, got '1e3'",
    "--max-error 0": "--max-error: expected a number from 0.0005 to 0.5, got '0'",
    "--max-error nan": "--max-error: expected a number from 0.0005 to 0.5, got 'nan'",
    "--time 0": "--time: expected a number above 0 and at most 10,000,000, got '0'",
    "--time inf": "--time: expected a number above 0 and at most 10,000,000, got 'inf'",
    "--max-depth -2": "--max-depth: expected an integer from -1 to 1,000,000, got '-2'",
    "--max-depth 0": "--max-depth: expected -1 (no limit) or at least 1, got 0",
    "--seed -1": "--seed: expected an integer from 0 to 4,294,967,295, got '-1'",
    "--threads 0": "--threads: expected an integer from 1 to 1,024, got '0'",
    "--crop 5,5,5,9": (
        "--crop: expected x0,y0,x1,y1 in pixels with x0 < x1 and y0 < y1, such as 100,50,300,200, got '5,5,5,9'"
    ),
    "--crop 0,0,9,9 --size 8x8": "--crop: expected pixels inside the picture of 8x8, got 0,0,9,9",
    "--crop 0,0,513,1": "--crop: expected pixels inside the picture of 512x512, got 0,0,513,1",
    "--replay 512,0,1": "--replay: expected pixels inside the picture of 512x512, got 512,0,1",
    "--replay 1,2": "--replay: expected a pixel and the index of one of its samples, x,y,sample, such as 412,77,19, got '1,2'",
    "--camera-from nan,0,0": "--camera-from: expected three numbers x,y,z, got 'nan,0,0'",
    "--camera-to 1,2": "--camera-to: expected three numbers x,y,z, got '1,2'",
    "--camera 7": "--camera: expected one of 0 'camera', got '7'",
    "--fov 0": "--fov: expected a number above 0 and at most 179.9, got '0'",
    "--fov 180": "--fov: expected a number above 0 and at most 179.9, got '180'",
    "--sun 10,91": (
        "--sun: expected azimuth,elevation in degrees with an elevation from -90 to 90, such as 135,40, got '10,91'"
    ),
    "--environment 1,2": "--environment: expected an image file or a radiance r,g,b, each at least 0, got '1,2'",
    "--environment 1,-2,3": "--environment: expected an image file or a radiance r,g,b, each at least 0, got '1,-2,3'",
    "--exposure 65": "--exposure: expected a number from -64 to 64 or auto, got '65'",
    "--tone-mapping filmc": "--tone-mapping: expected one of none, filmic, got 'filmc'; did you mean 'filmic'?",
    "--method pth": "--method: expected one of direct, path, irradiance-cache, radiance-cache, photon-map, radiosity, "
    "got 'pth'; did you mean 'path'?",
    "--set rows": "--set: expected NAME=VALUE, got 'rows'",
    "--set max-eror=1": "--set: unknown option max-eror for irradiance-cache; did you mean 'max-error'?",
    "--set rows=many": "--set: rows: expected integer | none, got 'many'",
    "--set weight=wart": "--set: weight: expected tabellion | ward | split-sphere, got 'wart'",
    "--set rows=5 --set rows=6": "--set: rows is given twice, expected it once",
    "--set rows=1": "IrradianceCache: rows must be between 2 and 256, got 1",
    "--method path --show-records": "--show-records: expected a method with records, got path",
    "--cache a.npz --set rows=5": (
        "--cache cannot be combined with --method or --set: the file holds the method and its options"
    ),
    "--cache a.npz": "a.npz: file not found",
    "-o a.tiff": "a.tiff: expected an image file with one of the suffixes .exr, .png, .hdr, .pfm, .npy, got '.tiff'",
    "--replay-settings none.exr": "none.exr: file not found",
}


@pytest.mark.parametrize("flags", BAD_VALUES)
def test_bad_values(flags: str, capsys: Output, api: FakeApi) -> None:
    assert main(["render", "cornell-box", *flags.split()]) == 2
    assert errors(capsys).splitlines()[0] == f"eclat: {BAD_VALUES[flags]}"
    assert os.listdir() == [] and api.calls == []


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("rendr", "unknown command 'rendr', expected one of {commands}; did you mean 'render'?"),
        ("--versoin", "unknown option --versoin for eclat; did you mean '--version'?"),
        (
            "--log-level debug render cornell-box",
            "unknown option --log-level for eclat; it goes after the command, as in 'eclat render --log-level …'",
        ),
        ("render cornell-box --sampels 3", "unknown option --sampels for eclat render; did you mean '--samples'?"),
        ("render", "missing argument 'SCENE'"),
        ("render cornell-bx", None),
        ("info none.obj", "none.obj: expected a scene file, but no such file exists"),
        ("solve cornell-box -o a.npy", "a.npy: expected a name that ends in .npz"),
        (
            "solve cornell-box --method path -o a.npz",
            "--method: expected one of irradiance-cache, radiance-cache, photon-map, radiosity, got 'path'",
        ),
        ("compare cornell-box -o a.pdf", "a.pdf: expected a name that ends in .html"),
        (
            "compare cornell-box --methods pth",
            "methods: unknown method 'pth', expected one of direct, path, irradiance-cache, radiance-cache, photon-map, "
            "radiosity; did you mean 'path'?",
        ),
        ("irradiance cornell-box --points none.csv", "none.csv: file not found"),
    ],
)
def test_bad_command_lines(arguments: str, message: str | None, capsys: Output) -> None:
    assert main(arguments.split()) == 2
    first = errors(capsys).splitlines()[0]
    if message is None:
        assert first.startswith("eclat: cornell-bx: expected") and first.endswith("did you mean 'cornell-box'?")
    else:
        assert first == "eclat: " + message.format(commands=", ".join(COMMANDS))
    assert os.listdir() == []


def test_usage_errors_name_the_help(capsys: Output) -> None:
    for flag in ("--sampels", "--samples"):
        assert main(["render", "x", flag]) == 2
        assert errors(capsys).splitlines()[1] == "       for help, run: eclat render --help"


def test_an_unwritable_output_is_reported_before_any_work(api: FakeApi, capsys: Output) -> None:
    assert main(["render", "cornell-box", "-o", "no/a.png"]) == 2
    folder = Path("no").absolute()
    assert (
        errors(capsys) == f"eclat: no/a.png: the file cannot be written, because the folder {folder} does not exist\n"
    )
    assert api.calls == []


def test_ctrl_c_exits_with_130_and_leaves_the_output(api: FakeApi, capsys: Output) -> None:
    Path("cornell-box.png").write_bytes(b"old")
    api.raises = KeyboardInterrupt()
    assert main(["render", "cornell-box"]) == 130
    assert errors(capsys) == "eclat: interrupted\n"
    assert Path("cornell-box.png").read_bytes() == b"old"


@pytest.mark.parametrize("keep", [True, False])
def test_keep_partial_writes_what_the_interrupt_carries(api: FakeApi, keep: bool) -> None:
    stop = KeyboardInterrupt()
    stop.partial = Image(np.ones((2, 2, 3), dtype=np.float32), metadata={"samples_done": 3})  # type: ignore[attr-defined]
    api.raises = stop
    assert main(["render", "cornell-box", "-o", "a.exr", *(["--keep-partial"] if keep else [])]) == 130
    assert Path("a.exr").exists() == keep
    if keep:
        assert Image.load("a.exr").metadata["samples_done"] == 3


def test_keep_partial_says_when_there_is_nothing(api: FakeApi, capsys: Output) -> None:
    api.raises = KeyboardInterrupt()
    assert main(["render", "cornell-box", "--keep-partial"]) == 130
    assert errors(capsys) == (
        "eclat: --keep-partial: nothing was written, because nothing was finished yet\neclat: interrupted\n"
    )
    assert os.listdir() == []


def test_json_is_all_that_stands_on_standard_output(capsys: Output) -> None:
    assert main(["render", "cornell-box", "--size", "8x8", "--json"]) == 0
    captured = capsys.readouterr()
    events = [json.loads(line) for line in captured.out.splitlines()]
    assert [event["event"] for event in events] == ["progress"] * 3 + ["result"]
    assert events[-1]["files"] == ["cornell-box.png"]
    assert events[-1]["metadata"]["statistics"]["samples"] == 32
    assert captured.err == ""


def test_json_reports_errors_and_interrupts(api: FakeApi, capsys: Output) -> None:
    assert main(["render", "cornell-box", "--json", "--camera", "9"]) == 2
    captured = capsys.readouterr()
    message = "--camera: expected one of 0 'camera', got '9'"
    assert json.loads(captured.out) | {"time": 0} == {"event": "error", "time": 0, "message": message}
    assert captured.err == f"eclat: {message}\n"
    api.raises = KeyboardInterrupt()
    assert main(["render", "cornell-box", "--json"]) == 130
    assert json.loads(capsys.readouterr().out.splitlines()[-1])["message"] == "interrupted"


def test_json_needs_standard_output_for_itself(capsys: Output) -> None:
    assert main(["irradiance", "cornell-box", "--json"]) == 2
    assert capsys.readouterr().err == (
        "eclat: --json requires -o FILE: with --json, standard output holds only events\n"
    )


def test_quiet_keeps_warnings(capsys: Output) -> None:
    Path("lonely.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    assert main(["render", "lonely.obj", "--size", "8x8", "--quiet"]) == 0
    captured = capsys.readouterr()
    assert captured.out == ""
    assert "eclat: warning: the scene has no camera: a camera is placed outside of it\n" in captured.err
    assert len(set(captured.err.splitlines())) == len(captured.err.splitlines())


def test_settings_repeat_a_run(api: FakeApi, capsys: Output) -> None:
    flags = (
        "--method path --set roulette-depth=3 --time 9 --adaptive noise --size 8x6 --crop 1,2,3,4 --seed 7 "
        "--environment 1,2,3 --fov 40"
    )
    assert main(["render", "cornell-box", *flags.split(), "-o", "a.exr", "-o", "a.png"]) == 0
    for name in ("a.exr", "a.png"):
        assert main(["render", "cornell-box", "--replay-settings", name, "-o", "b.exr"]) == 0
        first, again = api.calls[0], api.calls[-1]
        # Time chose 32 samples, so that is what is repeated.
        assert (again["samples"], again["time"]) == (32, None)
        for key in ("what", "size", "crop", "seed", "camera", "max_depth", "max_error"):
            assert again[key] == first[key], key
        assert again["scene"].cameras[0].fov == 40
        np.testing.assert_array_equal(again["scene"].environment.image, first["scene"].environment.image)
    assert set(Image.load("a.exr").metadata["settings"]) == set(REPEATED)
    capsys.readouterr()
    assert main(["render", "cornell-box", "--replay-settings", "a.exr", "--seed", "3"]) == 2
    assert errors(capsys) == (
        "eclat: --replay-settings cannot be combined with --seed: the file holds the value to use\n"
    )


def test_edited_settings_pass_the_same_checks(capsys: Output) -> None:
    settings = dict.fromkeys(REPEATED) | {
        "method": "path",
        "settings": [],
        "light_groups": [],
        "ies": [],
        "size": [0, 5],
    }
    Image(np.zeros((1, 1, 3), np.float32), metadata={"settings": settings}).save("a.exr")
    assert main(["render", "cornell-box", "--replay-settings", "a.exr"]) == 2
    assert "--size: expected a width and a height" in errors(capsys)
    Image(np.zeros((1, 1, 3), np.float32), metadata={"settings": [1]}).save("a.exr")
    assert main(["render", "cornell-box", "--replay-settings", "a.exr"]) == 2
    assert "a.exr: expected a picture that `eclat render` wrote" in errors(capsys)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        *(("refine", value) for value in ({"a": 65536}, "yes", 1, [True])),
        *(("adaptive", value) for value in ({}, "yes", 1, [True], "noise,denoised")),
        *(("samples", value) for value in ({}, "many", [1, 2], [[[1]]], 1e400, True)),
        *(("size", value) for value in (5, {"w": 1}, [[1], 2], ["a", "b"], [1e300, 1])),
        *(("materials", value) for value in (1, "a=b", [{}], [1])),
        *(("settings", value) for value in ({}, "spacing=1", [None])),
        *(("method", value) for value in (1, [], {}, "rays")),
        *(("camera_to", value) for value in ({}, [1, 2], [None, 1, 2])),
    ],
)
def test_settings_of_any_kind_are_one_line(capsys: Output, name: str, value: object) -> None:
    settings = dict.fromkeys(REPEATED) | {"method": "path", "settings": [], "materials": [], "samples": 1, name: value}
    Image(np.zeros((1, 1, 3), np.float32), metadata={"settings": settings}).save("a.exr")
    assert main(["render", "cornell-box", "--replay-settings", "a.exr"]) == 2
    (line,) = errors(capsys).splitlines()
    assert line.startswith("eclat: ")


def test_replaying_one_sample_renders_one_pixel_and_writes_nothing(api: FakeApi, capsys: Output) -> None:
    assert main(["render", "cornell-box", "--replay", "4,2,19", "--method", "path"]) == 0
    assert (api.calls[0]["crop"], api.calls[0]["samples"]) == ((4, 2, 5, 3), 20)
    assert capsys.readouterr().out.startswith("pixel (4, 2), samples 0 to 19: finite, mean radiance ")
    assert os.listdir() == []


def test_samples_that_are_not_finite_come_with_the_command_that_replays_them(api: FakeApi, capsys: Output) -> None:
    api.metadata = {"bad_samples": {"count": 3, "first": [4, 2, 19]}}
    assert (
        main(["render", "cornell-box", "--method", "path", "--size", "8x6", "-q", "-o", "a.npy", "-o", "a b.exr"]) == 0
    )
    words = "render cornell-box --replay-settings 'a b.exr' --replay 4,2,19"
    assert errors(capsys) == f"eclat: warning: to repeat the first of these samples, run: eclat {words}\n"
    api.metadata["bad_samples"]["count"] = 1
    assert main(shlex.split(words)) == 0
    assert (api.calls[1]["crop"], api.calls[1]["samples"], api.calls[1]["size"]) == ((4, 2, 5, 3), 20, (8, 6))
    assert capsys.readouterr().out.startswith("pixel (4, 2), samples 0 to 19: 1 NOT FINITE, the first is number 19, ")


def test_scenes_are_listed(capsys: Output) -> None:
    assert main(["scenes"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("cornell-box  a room with a red and a green wall")


def test_info_counts_what_a_scene_holds(capsys: Output, monkeypatch: pytest.MonkeyPatch) -> None:
    assert main(["info", "cornell-box", "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert facts["triangles"] > 20 and facts["emissive_triangles"] >= 2
    assert facts["materials"].keys() == {"diffuse"}
    assert {"white", "red", "light"} <= set(facts["material_names"])
    assert facts["cameras"][0]["size"] == [512, 512]
    two_cameras(monkeypatch)
    assert main(["info", "atrium"]) == 0
    text = capsys.readouterr().out
    assert "camera 1    'gallery' perspective, from (0, 0, 3.9), 39.3077° along smaller, 512x512\n" in text
    assert "lights      emissive " in text


def test_irradiance_of_points_in_a_file(api: FakeApi, capsys: Output) -> None:
    Path("p.csv").write_text("x,y,z,nx,ny,nz\n0.1,0.2,0.3, 0,0,2\n# aside\n\n1 2 3 0 1 0\n")
    assert main(["irradiance", "cornell-box", "--points", "p.csv", "--component", "indirect", "--samples", "5"]) == 0
    assert (api.calls[0]["component"], api.calls[0]["samples"]) == ("indirect", 5)
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "irradiance_r,irradiance_g,irradiance_b,lux"
    lux = 179 * (0.2126 * 0.1 + 0.7152 * 0.2 + 0.0722 * 0.3)
    np.testing.assert_allclose([float(v) for v in lines[1].split(",")], [0.1, 0.2, 0.3, lux], rtol=1e-6)
    assert len(lines) == 3


def test_irradiance_into_files(capsys: Output) -> None:
    np.save("p.npy", np.array([[1.0, 2, 3, 0, 0, 1]]))
    assert main(["irradiance", "cornell-box", "--points", "p.npy", "-o", "e.npy"]) == 0
    assert np.load("e.npy").shape == (1, 4)
    assert capsys.readouterr().out.startswith("e.npy: 1 points, ")


BAKE = ["bake", "cornell-box", "--method", "path", "--samples", "4", "--texel-size", "0.2"]


def test_bake_writes_a_scene_and_what_its_light_map_means(capsys: Output) -> None:
    assert main(BAKE) == 0
    assert capsys.readouterr().out.startswith("cornell-box_lit.glb: ")
    files = [Path(f"cornell-box_lit.{end}") for end in ("glb", "lightmap.exr", "lightmap.json")]
    assert all(file.exists() for file in files)
    assert json.loads(files[2].read_text())["method"] == "path"
    assert main([*BAKE, "--flatten", "--json"]) == 0
    assert json.loads(capsys.readouterr().out.splitlines()[-1])["file"] == "cornell-box_flat.glb"
    assert sorted(path.name for path in Path().glob("*flat*")) == ["cornell-box_flat.glb"]


@pytest.mark.parametrize(
    ("flags", "message"),
    [
        ("-o room.gltf", "room.gltf: expected a name that ends in .glb"),
        ("-o nowhere/room.glb", "nowhere/room.glb: the file cannot be written, because the folder"),
        ("--exposure 1", "--exposure requires --flatten"),
        ("--texel-size 0.00001", "m fits"),
        ("--sides back", "--sides: expected one of auto, front, both, got 'back'"),
        ("--cache room.npz", "--cache cannot be combined with --method or --set"),
    ],
)
def test_mistakes_when_baking(flags: str, message: str, capsys: Output) -> None:
    assert main([*BAKE, *flags.split()]) == 2
    assert message in errors(capsys)
    assert not list(Path().iterdir())


def test_probes_write_a_grid_and_say_how_good_it_is(capsys: Output) -> None:
    flags = ["--grid", "2,3,2", "--samples", "64", "--window", "nonnegative", "--component", "direct"]
    assert main(["probes", "cornell-box", *flags]) == 0
    said = capsys.readouterr().out
    assert said.startswith("cornell-box.probes.json: 2 x 3 x 2 probes, ") and "estimated error" in said
    grid = eclat.ProbeGrid.load("cornell-box.probes.json")
    assert (grid.counts, grid.window, grid.component) == ((2, 3, 2), "nonnegative", "direct")
    assert main(["probes", "cornell-box", *flags, "-o", "a.npz", "--json", "--quiet"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["counts"] == [2, 3, 2] and result["statistics"]["probes"] == 12
    assert (eclat.ProbeGrid.load("a.npz").coefficients == grid.coefficients).all()


@pytest.mark.parametrize(
    ("flags", "message"),
    [
        ("--grid 2,2", "--grid: expected three numbers of probes X,Y,Z of at least 1, such as 16,6,12, got '2,2'"),
        ("--grid 0,2,2", "--grid: expected three numbers of probes"),
        ("--grid 9999,9999,9999", "with a product of at most"),
        ("--bounds 0,0,0,1,1", "--bounds: expected a box x0,y0,z0,x1,y1,z1 in metres"),
        ("--bounds 1,0,0,0,1,1", "--bounds: expected a box"),
        ("--window han", "--window: expected one of none, nonnegative, sloan, hanning, lanczos, got 'han'"),
        ("-o probes.txt", "probes.txt: expected a name that ends in .json or .npz"),
        ("-o none/probes.json", "none/probes.json"),
        ("--cache room.npz --method path", "--cache cannot be combined with --method or --set"),
    ],
)
def test_mistakes_with_probes(flags: str, message: str, capsys: Output) -> None:
    assert main(["probes", "cornell-box", *flags.split()]) == 2
    assert message in errors(capsys)
    assert not list(Path().iterdir())


# A shell gives its background jobs an ignored SIGINT; a terminal does not, and it is the terminal that is tested.
RUN_MAIN = (
    "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler); "
    "from eclat.cli import main; sys.exit(main())"
)


def start(arguments: list[str]) -> subprocess.Popen[str]:
    """`eclat` as a program of its own, with the real core."""
    command = [sys.executable, "-c", RUN_MAIN, *arguments]
    environment = os.environ | {"PYTHONPATH": PATHS}
    return subprocess.Popen(
        command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, encoding="utf-8"
    )


def test_the_package_runs_as_a_module() -> None:
    run = subprocess.run(
        [sys.executable, "-m", "eclat", "scene"], env=os.environ | {"PYTHONPATH": PATHS}, capture_output=True, text=True
    )
    assert run.returncode == 2 and "scenes" in run.stderr


def test_ctrl_c_while_baking_leaves_the_output() -> None:
    Path("cornell-box_lit.glb").write_bytes(b"old")
    with start(
        ["bake", "cornell-box", "--json", "--method", "path", "--samples", "100000", "--texel-size", "0.1"]
    ) as process:
        assert process.stdout is not None
        for line in process.stdout:
            if json.loads(line).get("phase") == "irradiance":
                break
        process.send_signal(signal.SIGINT)
        _, complaint = process.communicate(timeout=20)
    assert process.returncode == 130 and "interrupted" in complaint
    assert [path.name for path in Path().iterdir()] == ["cornell-box_lit.glb"]
    assert Path("cornell-box_lit.glb").read_bytes() == b"old"


def test_ctrl_c_among_probes_leaves_the_output() -> None:
    Path("a.json").write_bytes(b"old")
    with start(["probes", "cornell-box", "--json", "--samples", "1000000", "-o", "a.json"]) as process:
        assert process.stdout is not None
        for line in process.stdout:
            if json.loads(line).get("phase") == "probes":
                break
        process.send_signal(signal.SIGINT)
        _, complaint = process.communicate(timeout=20)
    assert process.returncode == 130 and complaint == "eclat: interrupted\n"
    assert os.listdir() == ["a.json"] and Path("a.json").read_bytes() == b"old"


@pytest.mark.parametrize("phase", ["solve", "render"])
def test_ctrl_c_in_each_phase_of_the_real_thing(phase: str) -> None:
    Path("cornell-box.png").write_bytes(b"old")
    method = {"solve": ["--max-error", "0.0005"], "render": ["--method", "path", "--samples", "1000000"]}[phase]
    with start(["render", "cornell-box", "--json", *method]) as process:
        assert process.stdout is not None
        for line in process.stdout:
            if json.loads(line).get("phase") == phase:
                break
        process.send_signal(signal.SIGINT)
        # A second is the promise; the rest is for a machine that is busy with other things.
        _, complaint = process.communicate(timeout=20)
    assert process.returncode == 130
    assert complaint == "eclat: interrupted\n"
    # Where nobody knows how long it takes, the file holds an unfinished picture; with --samples, what it held before.
    unfinished = Path("cornell-box.png").read_bytes()
    assert unfinished == b"old" if phase == "render" else unfinished.startswith(b"\x89PNG")
    assert os.listdir() == ["cornell-box.png"]


def test_irradiance_from_a_solved_file_says_what_served_each_point() -> None:
    Path("floor.csv").write_text("0,-1,0, 0,1,0\n0.5,-1,0.5, 0,1,0\n")
    Path("air.csv").write_text("0,-1,0, 0,1,0\n0,0,0, 1,0,0\n")
    runs = [
        ["solve", "cornell-box", "--points", "floor.csv", "--max-error", "0.1", "-o", "floor.npz"],
        ["irradiance", "cornell-box", "--points", "air.csv", "--cache", "floor.npz", "--samples", "16"],
    ]
    for run in runs:
        with start(run) as process:
            out, said = process.communicate(timeout=60)
        assert process.returncode == 0
    assert len(out.splitlines()) == 3
    assert said.startswith("eclat: 2 points, 1 read from records, 1 gathered, light straight from lamps within ")
    assert said.endswith(" %, RGB in W/m², lux by 179 lm/W\n")


def test_more_threads_than_cores_are_no_news_and_no_other_records() -> None:
    runs = [["solve", "cornell-box", "--max-error", "0.1", "--size", "32x32", "--threads", t] for t in ("1", "500")]
    for run in runs:
        with start([*run, "-o", f"{run[-1]}.npz", "--quiet"]) as process:
            assert process.communicate(timeout=60) == ("", "")
        assert process.returncode == 0
    one, many = (eclat.Solution.load(f"{run[-1]}.npz", load("cornell-box")) for run in runs)
    assert len(one) and np.array_equal(one.near, many.near) and np.array_equal(one.far, many.far)


def interrupted(arguments: list[str], phase: str, fraction: float) -> subprocess.Popen[str]:
    """A run with --json, stopped by Ctrl-C once that phase is that far; ended when this returns."""
    with start([*arguments, "--json"]) as process:
        assert process.stdout is not None
        for line in process.stdout:
            event = json.loads(line)
            if event.get("phase") == phase and event["fraction"] >= fraction:
                break
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=30)
    return process


def test_keep_partial_of_a_picture_is_the_picture_of_fewer_samples() -> None:
    flags = ["--method", "path", "--size", "64x64", "--seed", "5"]
    arguments = ["render", "cornell-box", *flags, "--samples", "100000", "--keep-partial", "-o", "a.exr"]
    # A sample of 64 × 64 pixels takes milliseconds, and 0.02 % are twenty.
    assert interrupted(arguments, "render", 0.0002).returncode == 130
    image = Image.load("a.exr")
    done = image.metadata["samples_done"]
    assert done > 0 and image.metadata["settings"]["samples"] == done
    with start(["render", "cornell-box", *flags, "--samples", str(done), "-o", "b.exr"]) as process:
        assert process.wait(timeout=120) == 0
    assert np.array_equal(Image.load("b.exr").pixels, image.pixels)


# Far records alone are not worth keeping: a few, so that their passes are over by then.
@pytest.mark.parametrize(
    ("where", "fraction"),
    [(["--view-independent"], 0.3), (["--size", "512x512"], 0.4)],
    ids=["everywhere", "view"],
)
def test_keep_partial_of_a_solve_is_marked_incomplete(where: list[str], fraction: float) -> None:
    settings = ["--max-error", "0.002", "--set", "far_records=500"]
    arguments = ["solve", "cornell-box", *where, *settings, "-o", "a.npz"]
    assert interrupted([*arguments, "--keep-partial"], "solve", fraction).returncode == 130
    scene = load("cornell-box")
    with pytest.warns(eclat.EclatWarning, match="this cache is incomplete, because its solve was interrupted"):
        solution = eclat.Solution.load("a.npz", scene)
    assert len(solution) > 0 and not solution.complete
    os.remove("a.npz")
    assert interrupted(arguments, "solve", fraction).returncode == 130
    assert os.listdir() == []


def test_a_closed_standard_output_ends_without_a_traceback() -> None:
    with start(["scenes"]) as process:
        assert process.stdout is not None
        process.stdout.close()
        assert process.wait(timeout=20) in (0, 1)
        assert process.stderr is not None
        assert process.stderr.read() == ""


def test_an_error_above_the_wanted_one_has_a_reason() -> None:
    from eclat.cli.picture_summary import why_above

    flags = {"samples": None, "time": None, "max_error": 0.03}
    high = {"estimated_error": 0.04, "cache_error": 0.035}
    assert why_above(flags, high) == (
        "the error is above --max-error 0.03, because the records alone have 3.5 %; --refine makes them finer"
    )
    assert not why_above(flags, {**high, "estimated_error": 0.03})
    assert not why_above(flags, {"estimated_error": 0.04}) and not why_above(flags, {})
    gathered = {**high, "noise_left": 0.035, "gathered_samples": 512.0}
    assert "512 samples that read the records only after a matte surface do not suffice" in why_above(flags, gathered)
    assert not why_above({**flags, "samples": 4}, high) and not why_above({**flags, "time": 4.0}, high)


def test_an_address_of_a_display_server_is_checked_before_the_scene_is_read(capsys: Output) -> None:
    assert main(["render", "absent.glb", "--display-server", "localhost:tev"]) == 2
    assert "eclat: --display-server: expected host:port, as in localhost:14158, got 'localhost:tev'" in errors(capsys)
