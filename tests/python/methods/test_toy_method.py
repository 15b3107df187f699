# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The proof of the interface: a method in one file, which returns a constant, and gets it through every verb and command."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

import eclat
from eclat import _core
from eclat.bridge.compiled import fingerprint
from eclat.cli import main
from eclat.methods.estimators import irradiance_from, radiance_from
from eclat.methods.method import METHODS, Method, Solved, register
from eclat.methods.saved import Common, DamagedArrayError
from eclat.methods.work import Care, Purpose, Work
from eclat.scenes import build
from eclat.verbs.compare import Effort, compare


@dataclass(frozen=True, eq=False, repr=False)
class ToySolution(Solved):
    """Notes: merged, there are more of them."""

    called: ClassVar[str] = "toy"
    consists_of: ClassVar[str] = "notes"
    format: ClassVar[int] = 1

    options: Toy
    fingerprint: str
    notes: np.ndarray
    max_depth: int = -1
    statistics: dict[str, float] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.notes)

    def arrays(self) -> dict[str, np.ndarray]:
        return {"notes": self.notes}

    @classmethod
    def from_parts(cls, common: Common, header: Mapping[str, Any], arrays: Mapping[str, np.ndarray]) -> ToySolution:
        if "notes" not in arrays:
            raise DamagedArrayError("notes")
        return cls(common.options, common.fingerprint, arrays["notes"], common.max_depth, common.statistics)

    def merged(self, other: ToySolution) -> ToySolution:
        return ToySolution(self.options, self.fingerprint, np.concatenate((self.notes, other.notes)), self.max_depth)

    def radiance_estimator(self, scene: eclat.Scene, work: Work) -> _core.Estimator:
        def constant(origins: np.ndarray, directions: np.ndarray, numbers: np.ndarray) -> np.ndarray:
            assert np.allclose(np.linalg.norm(directions, axis=1), 1) and ((numbers >= 0) & (numbers < 1)).all()
            return np.full((len(origins), 3), self.options.radiance)

        return radiance_from(scene, constant)

    def point_estimator(self, scene: eclat.Scene, work: Work) -> _core.PointEstimator:
        return irradiance_from(scene, lambda points, normals, component: np.array(self.options.irradiance))


@register
@dataclass(frozen=True)
class Toy(Method):
    """Light that is the same everywhere."""

    name: ClassVar[str] = "toy"
    cannot: ClassVar[str] = "Everything, but its constant is exact."
    solved: ClassVar[type[Solved] | None] = ToySolution

    radiance: float = 0.75
    """Of every camera ray, W·m⁻²·sr⁻¹."""
    irradiance: float = 2.5
    """At every point, W·m⁻²."""

    def solve(self, scene: eclat.Scene, purpose: Purpose, work: Work, care: Care | None = None) -> ToySolution:
        return ToySolution(self, fingerprint(scene), np.array([float(work.seed)]), work.max_depth)


@pytest.fixture(autouse=True)
def registered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The toy is a method while these tests run, and for no other test."""
    monkeypatch.chdir(tmp_path)
    register(Toy)
    yield
    del METHODS["toy"]


del METHODS["toy"]

SIZE = (40, 36)
POINTS = ([[0.0, 0.5, 0.0], [0.1, 0.2, 0.0]], [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])


@pytest.fixture(scope="module")
def scene() -> eclat.Scene:
    return build("cornell-box")


@pytest.mark.parametrize("what", ["toy", Toy, Toy()])
def test_pictures_by_name_class_and_value(scene: eclat.Scene, what: Any) -> None:
    image = eclat.render(scene, what, samples=2, size=SIZE)
    np.testing.assert_allclose(image.pixels, 0.75)
    assert image.metadata["method"] == "toy" and image.metadata["options"] == {"radiance": 0.75, "irradiance": 2.5}
    assert image.metadata["statistics"]["notes"] == 1
    reference = eclat.render(scene, "direct", samples=2, size=SIZE)
    for layer in ("albedo", "normal", "depth"):
        np.testing.assert_array_equal(image.layers[layer], reference.layers[layer])


def test_a_solve_uses_its_own_options_and_any_number_of_threads(scene: eclat.Scene) -> None:
    for threads in (1, 2):
        image = eclat.render(scene, Toy(radiance=0.25), samples=3, size=SIZE, threads=threads, adaptive=True)
        np.testing.assert_allclose(image.pixels, 0.25)


def test_irradiance_and_light_maps(scene: eclat.Scene) -> None:
    np.testing.assert_allclose(eclat.irradiance(scene, *POINTS, "toy"), 2.5)
    np.testing.assert_allclose(eclat.irradiance(scene, *POINTS, "toy", component="indirect"), 2.5)
    direct = eclat.irradiance(scene, *POINTS, "toy", component="direct")
    np.testing.assert_array_equal(direct, eclat.irradiance(scene, *POINTS, "path", component="direct"))
    lightmap = eclat.bake(scene, Toy(irradiance=1.5), texel_size=0.3, samples=4)
    assert lightmap.method == "toy" and lightmap.settings["irradiance"] == 1.5
    np.testing.assert_allclose(lightmap.irradiance[lightmap.irradiance.any(axis=2)], 1.5, rtol=1e-5)


def test_photons_are_saved_and_merged(scene: eclat.Scene) -> None:
    solved = eclat.solve(scene, "toy", seed=7)
    solved.save("toy.npz")
    loaded = eclat.load_solved("toy.npz", scene)
    np.testing.assert_allclose(eclat.render(scene, loaded, samples=1, size=SIZE).pixels, 0.75)
    np.testing.assert_allclose(eclat.irradiance(scene, *POINTS, ToySolution.load("toy.npz")), 2.5)
    both = eclat.merge(loaded, eclat.solve(scene, Toy(), seed=9))
    assert isinstance(both, ToySolution) and both.notes.tolist() == [7, 9]
    np.testing.assert_allclose(eclat.render(scene, both, samples=1, size=SIZE).pixels, 0.75)
    assert repr(both) == "<ToySolution: 2 notes>"
    with pytest.raises(eclat.EclatError, match="this toy was solved for another scene"):
        eclat.load_solved("toy.npz", build("furnace"))
    with pytest.raises(eclat.EclatError, match="expected a cache, got a toy"):
        eclat.Solution.load("toy.npz")
    with pytest.raises(eclat.EclatError, match="refine: expected records, got a toy"):
        eclat.refine(loaded, scene)


def test_commands(capsys: pytest.CaptureFixture[str]) -> None:
    size = ["--size", "40x36"]
    arguments = ["--method", "toy", "--set", "radiance=0.5", "--samples", "1", "-o", "a.npy"]
    assert main(["render", "cornell-box", *size, *arguments]) == 0
    np.testing.assert_allclose(np.load("a.npy"), 0.5)
    assert main(["solve", "cornell-box", "--method", "toy", "-o", "toy.npz", "--json", "-q"]) == 0
    assert json.loads(capsys.readouterr().out.splitlines()[-1])["notes"] == 1
    assert main(["render", "cornell-box", *size, "--cache", "toy.npz", "--samples", "1", "-o", "b.npy", "-q"]) == 0
    np.testing.assert_allclose(np.load("b.npy"), 0.75)
    Path("points.csv").write_text("0 0.5 0 0 1 0\n")
    assert main(["irradiance", "cornell-box", "--points", "points.csv", "--method", "toy", "-o", "e.npy", "-q"]) == 0
    np.testing.assert_allclose(np.load("e.npy")[0, :3], 2.5)
    assert main(["bake", "cornell-box", "--method", "toy", "--texel-size", "0.3", "--samples", "4", "-q"]) == 0
    baked = json.loads(Path("cornell-box_lit.lightmap.json").read_text())
    assert "toy" in json.dumps(baked)
    capsys.readouterr()
    for command in ("render", "solve", "irradiance", "bake"):
        assert main([command, "--help"]) == 0
        text = " ".join(capsys.readouterr().out.split())
        assert "Light that is the same everywhere." in text and "At every point, W·m⁻². [2.5]" in text
    assert main(["render", "cornell-box", "--method", "toi"]) == 2
    assert "did you mean 'toy'" in capsys.readouterr().err


def test_two_solutions_are_compared(scene: eclat.Scene) -> None:
    known = eclat.render(scene, Toy(), samples=1, size=SIZE)
    from eclat.verbs.compare import Reference

    found = compare(scene, ["toy"], effort=Effort(2, samples=4), reference=Reference(known, known))
    assert [result.method for result in found.results] == ["toy"]
    assert all(m.error < 1e-6 for m in found.results[0].measurements)
    assert main(["compare", "cornell-box", "--methods", "toy,direct", "--levels", "1", "--samples", "2",
                 "--reference-samples", "2", "--size", "24x24", "-o", "page.html", "-q"]) == 0  # fmt: skip
    assert "Everything, but its constant is exact." in Path("page.html").read_text()


def test_an_error_in_an_estimator_is_raised(scene: eclat.Scene) -> None:
    class Broken(ToySolution):
        def radiance_estimator(self, scene: eclat.Scene, work: Work) -> _core.Estimator:
            def fail(*arrays: np.ndarray) -> np.ndarray:
                raise RuntimeError("no light today")

            return radiance_from(scene, fail)

    with pytest.raises(RuntimeError, match="no light today"):
        eclat.render(scene, Broken(Toy(), fingerprint(scene), np.zeros(1)), samples=1, size=SIZE)
