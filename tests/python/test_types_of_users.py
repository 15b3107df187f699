# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Types as a user's editor sees them: a script that uses what a beginner uses, and the examples in the README and in the
guides, have no error in Pyright's strict mode."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

import eclat
from support.page_blocks import ROOT, blocks_of

SCRIPT = """\
import numpy as np

import eclat
from eclat.scene import Camera, Material, Mesh, PointLight, Scene, look_at, rgb

corners = np.array([[-1, 0, -1], [-1, 0, 1], [1, 0, 1], [1, 0, -1]], np.float64)
floor = Mesh(corners, np.array([[0, 1, 2], [0, 2, 3]]), Material("diffuse", {"reflectance": rgb(0.6, 0.5, 0.4)}))
lamp = PointLight((0.0, 1.0, 0.0), (5.0, 5.0, 5.0), name="lamp")
camera = Camera(look_at((2, 1.5, 2), (0, 0, 0)), fov=45, size=(64, 48))
scene = Scene((floor,), (lamp,), cameras=(camera,))

image = eclat.render(scene, eclat.IrradianceCache(max_error=0.1), samples=4, light_groups=True)
depth = image["depth"]
brightest: float = float(depth.max())
names: list[str] = image.keys()
mixed = eclat.mix(image, {"lamp": "0.3,#ffcc88"})
mixed.save("room.exr")
picture = mixed.to_pil(exposure="auto")
size: tuple[int, int] = picture.size
solved = eclat.solve(scene, eclat.Radiosity(patches=100))
irradiance = eclat.irradiance(scene, np.zeros((1, 3)), np.array([[0.0, 1.0, 0.0]]), solved)
listed = eclat.irradiance(scene, [[0, 0.1, 0]], [[0, 1, 0]])
probes = eclat.probes(scene, grid=(2, 2, 2))
moving = probes.irradiance([[0, 0.5, 0]], [[0, 1, 0]])
means: dict[str, float] = {name: float(layer.mean()) for name, layer in image.items()}
methods: list[str] = sorted(eclat.METHODS)
print(brightest, names, size, irradiance.shape, listed.shape, moving.shape, means, methods, eclat.load("cornell-box").name)
"""


UNTYPED = ("pxr",)
"""Packages on pages whose authors give no types."""


def python_of(page: Path) -> str:
    """Return the Python of a page that the tests run, but for blocks that import packages without types."""
    blocks = [block.code for block in blocks_of(page) if block.language == "python" and not block.reason]
    return "\n".join(code for code in blocks if not any(f"from {name} " in code for name in UNTYPED))


@pytest.mark.full
def test_scripts_are_clean_in_strict_mode(tmp_path: Path) -> None:
    pytest.importorskip("basedpyright")
    pages = [ROOT / "README.md", *(ROOT / "docs/get_started").glob("*.md"), *(ROOT / "docs/guides").glob("*.md")]
    scripts = {"script": SCRIPT} | {page.stem: code for page in pages if (code := python_of(page))}
    assert len(scripts) > 5
    for name, code in scripts.items():
        (tmp_path / f"{name}_example.py").write_text(code, encoding="utf-8")
    settings = {"typeCheckingMode": "strict", "extraPaths": [str(Path(eclat.__file__).parents[1])]}
    (tmp_path / "pyrightconfig.json").write_text(json.dumps(settings))
    command = [sys.executable, "-m", "basedpyright", "--outputjson", "--pythonpath", sys.executable, "."]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=600)
    found = json.loads(done.stdout)
    messages = [
        f"{Path(d['file']).name}:{d['range']['start']['line'] + 1}: {d['message']}" for d in found["generalDiagnostics"]
    ]
    assert found["summary"]["filesAnalyzed"] == len(scripts) and not messages, "\n".join(messages)


def test_the_script_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    exec(compile(SCRIPT, "script.py", "exec"), {})
    assert "cornell-box" in capsys.readouterr().out and (tmp_path / "room.exr").exists()
