# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Every flag of every command does something: it changes what the verbs are called with or what is written, or is refused.

The flags are those that the commands themselves declare, so that a new one cannot be forgotten.
"""

from __future__ import annotations

import importlib
from contextlib import nullcontext
from dataclasses import fields
from pathlib import Path
from typing import Any

import click
import numpy as np
import pytest

import eclat
from eclat.bridge.compiled import fingerprint
from eclat.cli import COMMANDS, main
from eclat.images.image import Image
from eclat.scenes import build

VALUES: dict[str, list[str]] = {
    "--output": ["other"],
    "--max-error": ["0.07"],
    "--max-depth": ["4"],
    "--samples": ["7"],
    "--gathered-samples": ["6"],
    "--reference-samples": ["9"],
    "--time": ["3"],
    "--exposure": ["1.5"],
    "--tone-mapping": ["filmic"],
    "--crop": ["1,1,3,3"],
    "--adaptive": ["noise"],
    "--replay": ["1,1,2"],
    "--replay-settings": ["none.exr"],
    "--continue": ["none.exr"],
    "--set": ["rows=9"],
    "--method": ["radiance-cache"],
    "--cache": ["cache.npz"],
    "--points": ["points.csv"],
    "--camera": ["side"],
    "--camera-from": ["0,0,3"],
    "--camera-to": ["0,0.5,0"],
    "--camera-up": ["0,0.8,0.6"],
    "--fov": ["33"],
    "--size": ["24x18"],
    "--sun": ["135,40"],
    "--environment": ["1,2,3"],
    "--material": ["white=diffuse,reflectance=0.1"],
    "--seed": ["5"],
    "--threads": ["1"],
    "--component": ["indirect"],
    "--texel-size": ["0.2"],
    "--gutter": ["3"],
    "--sides": ["both"],
    "--max-size": ["512"],
    "--charts-timeout": ["3"],
    "--methods": ["path"],
    "--levels": ["2"],
    "--reference": ["reference.exr"],
    "--root": ["."],
    "--light-groups": ["each"],
    "--grid": ["2,3,4"],
    "--bounds": ["0,0,0,1,1,2"],
    "--window": ["hanning"],
    "--isa": ["x86-64-v2"],
    "--at": ["1"],
    "--frames": ["0:2"],
    "--fps": ["12"],
    "--shutter": ["0.5"],
    "--moments": ["4"],
    "--shard": ["1/2"],
    "--camera-path": ["walk.json"],
    "--ies": ["bulb=absent.ies"],
    "--display-server": ["localhost:14158"],
    "--texel-size-of": ["floor=0.2"],
    "--directional": ["sh"],
    "--workers": ["2"],
    "--scheduler": ["tcp://hub:8786"],
}
"""A value unlike the default for each flag that takes one."""

ENDING = {
    "render": ".png",
    "solve": ".npz",
    "irradiance": ".npy",
    "bake": ".glb",
    "probes": ".json",
    "compare": ".html",
}
BESIDE = {
    "render": {"--camera-up": ["--camera-from", "0,0,3"], "--gathered-samples": ["--samples", "8", "--halves"]},
    "bake": {"--exposure": ["--flatten"], "--no-denoise": ["--denoise"]},
}
"""Flags that say something only beside others."""
ONLY_TERMINALS = ("--quiet", "--help", "--log-level")


class Recorder:
    """Stands for all verbs: what they were called with, and what became of their results, as text."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.said: list[str] = []
        for verb in (
            "animate",
            "render",
            "solve",
            "refine",
            "irradiance",
            "bake",
            "estimate_bake",
            "probes",
            "load_solved",
        ):
            monkeypatch.setitem(vars(eclat), verb, self.verb(verb))
        monkeypatch.setattr("eclat.verbs.compare.render", self.verb("render"))
        for name in ("local", "connect"):
            monkeypatch.setattr(f"eclat.farm.farm.Farm.{name}", self.farm(name))

    def farm(self, name: str) -> Any:
        def started(*arguments: Any) -> Any:
            self.said.append(f"farm {name} {arguments}")
            return nullcontext()

        return started

    def verb(self, name: str) -> Any:
        def called(*arguments: Any, **keywords: Any) -> Any:
            keywords.pop("progress", None)
            told = {key: value for key, value in keywords.items() if key != "finished"}
            statistics = keywords.pop("statistics", None)
            if statistics is not None:
                statistics["points"] = 1.0
            self.said.append(f"{name} {[self._text(a) for a in arguments]} {sorted(told.items(), key=str)}")
            if name == "animate":
                keywords["finished"](Path("out.png"), False)
                return [Path("out.png")]
            if name == "render":
                return Image(np.linspace(0.2, 3, 108 * 3, dtype=np.float32).reshape(9, 12, 3), {}, {})
            if name == "estimate_bake":
                return eclat.BakeEstimate(**{field.name: 1 for field in fields(eclat.BakeEstimate)})
            return np.ones((1, 3), np.float32) if name == "irradiance" else Result(self.said)

        return called

    def _text(self, argument: Any) -> str:
        if isinstance(argument, eclat.Scene):
            return f"scene {fingerprint(argument)} {[repr(c.to_world) + repr(c) for c in argument.cameras]}"
        return repr(argument)


class Result:
    """What `solve`, `bake` and their like return."""

    def __init__(self, said: list[str]) -> None:
        self._said = said
        self.irradiance = np.ones((4, 4, 3))
        self.pages, self.page_count = [self.irradiance], 1
        self.statistics = {"charts": 1.0, "seconds": 1.0, "inside": 1.0, "windowed": 1.0}
        self.statistics |= {"noise_error": 0.1}
        self.counts = (1, 1, 1)
        self.texel_size, self.unit = 0.1, "lux"

    def __repr__(self) -> str:
        return "result"

    def save(self, *arguments: Any, **keywords: Any) -> None:
        self._said.append(f"save {arguments} {keywords}")

    def save_flat(self, *arguments: Any) -> None:
        self._said.append(f"save_flat {arguments}")

    def describe(self) -> str:
        return "described"

    def facts(self) -> dict[str, Any]:
        return {}

    def size_text(self) -> str:
        return "4 x 4"

    def clipped_share(self) -> float:
        return 0.0


def flags_of(command: str) -> list[tuple[str, list[str]]]:
    """Each flag of a command with a value, both spellings of those that have two."""
    found = []
    for parameter in importlib.import_module(COMMANDS[command]).command.params:
        if isinstance(parameter, click.Argument):
            continue
        for name in (*parameter.opts, *parameter.secondary_opts):
            if name.startswith("--") and name not in ONLY_TERMINALS:
                takes = not (parameter.is_flag or (parameter.flag_value is not None and name.startswith("--no-")))
                found.append((name, VALUES[name] if takes else []))
    return found


def outcome(command: str, arguments: list[str], monkeypatch: pytest.MonkeyPatch, capsys: Any) -> tuple[Any, ...]:
    recorder = Recorder(monkeypatch)
    for path in Path.cwd().glob("out*"):
        path.unlink()
    base = [command, "room.glb"] + (["-o", f"out{ENDING[command]}"] if "--output" not in arguments else [])
    if command == "animate" and "--frames" not in arguments:
        base += ["--frames", "0:1"]
    if command == "irradiance" and "--points" not in arguments:
        base += ["--points", "here.csv"]
    if command == "compare" and "--methods" not in arguments:
        base += ["--methods", "irradiance-cache"]
    code = main([*base, *arguments])
    written = {p.name: p.read_bytes() for p in sorted(Path.cwd().glob("out*"))}
    said = capsys.readouterr()
    return code, recorder.said, written, said.out if "--json" in arguments else "", said.err if code else ""


@pytest.mark.parametrize("command", list(ENDING))
def test_every_flag_reaches_its_verb_or_is_refused(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    from dataclasses import replace

    room = build("cornell-box")
    cameras = (room.cameras[0], replace(room.cameras[0], name="side", fov=20.0))
    monkeypatch.setitem(
        vars(eclat), "load", lambda name, root: replace(room, cameras=(replace(cameras[0], name=str(root)), cameras[1]))
    )
    Path("here.csv").write_text("0 0.5 0 0 1 0\n")
    Path("walk.json").write_text('{"keys": [{"time": 0, "from": [0, 1, 4], "to": [0, 1, 0]}]}')
    Path("points.csv").write_text("0 0.7 0 0 1 0\n")
    Image(np.ones((9, 12, 3), np.float32)).save("reference.exr")
    Path("other").mkdir()
    for flag, value in flags_of(command):
        if flag == "--output":
            value = [f"out-other{ENDING[command]}"]
        beside = BESIDE.get(command, {}).get(flag, [])
        plain = outcome(command, beside, monkeypatch, capsys)
        assert plain[0] == 0, plain[-1]
        changed = outcome(command, [*beside, flag, *value], monkeypatch, capsys)
        if changed[0] == 0:
            assert changed != plain, f"eclat {command} {flag} does nothing"
        else:
            assert flag.strip("-") in changed[-1] or str(value[0] if value else "") in changed[-1], changed[-1]
