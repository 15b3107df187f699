# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What a method of light is, and what it prepares for a scene: all that the verbs know of any of them.

A method is a value: its options. It *prepares* a scene for a purpose, and what it prepared gives estimators: of radiance
along camera rays, and of irradiance at points. What can be kept in a file beside is `Solved`. A new method is a class of
its own beside its solved class, and one `register`.
"""

from __future__ import annotations

import dataclasses
import os
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Self, TypeVar

import numpy as np

from eclat import _core
from eclat.bridge.compiled import fingerprint
from eclat.errors import EclatError, did_you_mean, warn
from eclat.files.archive import read_archive, write_archive
from eclat.measure.error_estimate import ErrorEstimate, error_text
from eclat.methods.work import Care, Purpose, Work
from eclat.scene import FloatArray, Scene
from eclat.stage.staging import staged

PassEstimator = Callable[[int, _core.Progress], _core.Estimator]
"""Number of a sample, from 0 → the estimator that takes it."""


class Prepared(ABC):
    """What a method has ready for one scene: the estimators that the verbs read.

    Classes are frozen dataclasses that have at least these fields.
    """

    options: Method
    statistics: dict[str, float]

    def prepare(self, scene: Scene, purpose: Purpose, work: Work, care: Care | None = None) -> Prepared:
        """Itself, once it is known to be of this scene and depth, so that verbs take methods and solved values alike."""
        if care is not None and care.refine:
            raise EclatError("refine: expected a method, got what was solved: `eclat.refine` goes on from that")
        self.require_match(scene, work.max_depth)
        return self

    def require_match(self, scene: Scene, max_depth: int) -> None:
        """Raises EclatError where it was prepared for another scene or depth."""
        return

    @abstractmethod
    def radiance_estimator(self, scene: Scene, work: Work) -> _core.Estimator:
        """Radiance along camera rays. A function in Python becomes one by `estimators.radiance_from`."""

    @abstractmethod
    def point_estimator(self, scene: Scene, work: Work) -> _core.PointEstimator:
        """Irradiance at points. A function in Python becomes one by `estimators.irradiance_from`."""

    def passes(self, scene: Scene, work: Work) -> PassEstimator | None:
        """Estimators of single samples of all pixels, instead of `radiance_estimator`; None where one serves them all."""
        return None

    @property
    def estimate(self) -> ErrorEstimate | None:
        """Its error for the purpose for which it was prepared; None where nobody estimated it."""
        return None

    @property
    def record_positions(self) -> FloatArray | None:
        """(N, 3) world positions of its records, to be shown in pictures; None where it has none."""
        return None

    def layers(self, film: _core.Film) -> dict[str, np.ndarray]:
        """Layers of a picture, besides those that all methods have."""
        return {}

    def picture_statistics(self, film: _core.Film) -> dict[str, float]:
        """What the statistics of a picture say of it."""
        return {}


class Solved(Prepared):
    """What was learned about a scene, as a value: saved, loaded, merged, described, re-used.

    Classes are frozen dataclasses, made with `repr=False` and `eq=False`, that have at least these fields.
    """

    called: ClassVar[str]
    """How messages call it: "cache"."""
    consists_of: ClassVar[str]
    """What `len` counts: "records"."""
    format: ClassVar[int]
    """Version of the format of its files, counted up when it changes."""

    fingerprint: str
    """The fingerprint of the scene (`bridge.compiled.fingerprint`)."""
    max_depth: int
    complete: bool = True
    """False where a solve was interrupted."""

    @abstractmethod
    def __len__(self) -> int: ...

    @abstractmethod
    def arrays(self) -> dict[str, np.ndarray]:
        """Name → array, as they are saved."""

    def header(self) -> dict[str, Any]:
        """What is saved besides arrays and the fields that all have, as JSON can hold it."""
        return {}

    @classmethod
    @abstractmethod
    def from_parts(cls, common: Common, header: Mapping[str, Any], arrays: Mapping[str, np.ndarray]) -> Self:
        """From what was saved. Raises KeyError, TypeError or ValueError, with the name of the array that is damaged."""

    def merged(self, other: Self) -> Self:
        """Both as one; they are known to be of the same scene, options and depth. Raises EclatError where that cannot be."""
        raise EclatError(f"merge: expected records or photons, got {self.options.name}, whose solutions are whole")

    @property
    def nbytes(self) -> int:
        """Bytes of its arrays."""
        return sum(array.nbytes for array in self.arrays().values())

    def require_match(self, scene: Scene, max_depth: int) -> None:
        """Raises EclatError where the scene or the depth is not what was solved; warns where it is incomplete."""
        if self.fingerprint != fingerprint(scene):
            raise EclatError(
                f"this {self.called} was solved for another scene: geometry, materials or lights differ; solve it again"
            )
        if self.max_depth != max_depth:
            raise EclatError(
                f"this {self.called} was solved with max_depth {self.max_depth}: expected the same, got {max_depth}"
            )
        if not self.complete:
            warn(f"this {self.called} is incomplete, since its solve was interrupted: more is traced, with more noise")

    def merge(self, other: Solved) -> Solved:
        """Both as one. Raises EclatError where methods, scenes or options differ."""
        if type(self) is not type(other):
            raise EclatError(f"merge: expected two of one kind, got a {self.called} and a {other.called}")
        if self.fingerprint != other.fingerprint:
            raise EclatError(f"merge: each {self.called} was solved for a scene of its own: expected the same scene")
        if (self.options, self.max_depth) != (other.options, other.max_depth):
            raise EclatError(f"merge: each {self.called} was solved with options of its own: expected the same options")
        return self.merged(other)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write to an `.npz` file, whole or not at all. Raises EclatError where it cannot be written."""
        header = {
            "format": self.format,
            "method": self.options.name,
            "options": dataclasses.asdict(self.options),
            "fingerprint": self.fingerprint,
            "max_depth": self.max_depth,
            "complete": self.complete,
            "statistics": self.statistics,
        }
        write_archive(path, header | self.header(), self.arrays())

    @classmethod
    def load(cls, path: str | os.PathLike[str], scene: Scene | None = None) -> Self:
        """Read a saved one; with `scene`, refuse one that was solved for another. Raises EclatError."""
        found = _load(path, scene)
        if not isinstance(found, cls):
            raise EclatError(f"{os.fspath(path)}: expected a {cls.called}, got a {found.called}")
        return found

    def describe(self) -> str:
        """One line for people."""
        parts = [f"{len(self):,} {self.consists_of}", *self.remarks()]
        if "seconds" in self.statistics:
            parts.append(f"{self.statistics['seconds']:.1f} s")
        if not self.complete:
            parts.append("incomplete")
        return ", ".join(filter(None, (*parts, error_text(self.statistics))))

    def remarks(self) -> list[str]:
        """What `describe` says besides."""
        return []

    def facts(self) -> dict[str, Any]:
        """The same for programs, as JSON can hold it."""
        return {self.consists_of: len(self), "complete": self.complete, "statistics": dict(self.statistics)}

    def picture_statistics(self, film: _core.Film) -> dict[str, float]:
        return {"bytes": float(self.nbytes), self.consists_of: float(len(self))}

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {self.describe()}>"


@dataclass(frozen=True)
class Common:
    """The fields that all solved values have, as they were saved."""

    options: Any
    fingerprint: str
    max_depth: int
    complete: bool
    statistics: dict[str, float]


@dataclass(frozen=True)
class Method(ABC):
    """A way to compute light, with its options. Every field has a default that needs no touching."""

    name: ClassVar[str]
    """On the command line, in files and in tables."""
    cannot: ClassVar[str]
    """What it leaves out or gets wrong, for people who compare."""
    solved: ClassVar[type[Solved] | None] = None
    """What `solve` makes, which can be kept in files; None where there is nothing to keep."""
    for_whole_scene: ClassVar[bool] = True
    """What it solves serves every purpose; else it is made for a view, for points or for all surfaces, and its error there
    is estimated and can be refined."""
    has_records: ClassVar[bool] = False
    """Indirect light is interpolated between records: it varies slowly, and is best read by samples where pixels are noisy."""

    @property
    def options(self) -> Method:
        """Itself, so that verbs take methods and solved values alike."""
        return self

    def require_match(self, scene: Scene, max_depth: int) -> None:
        """Nothing was solved, so that everything matches."""
        return

    def solve(self, scene: Scene, purpose: Purpose, work: Work, care: Care | None = None) -> Solved:
        """What can be kept. Raises EclatError where the method has nothing to solve."""
        raise EclatError(f"{self.name} has nothing to solve: expected one of {', '.join(solving_methods())}")

    def prepare(self, scene: Scene, purpose: Purpose, work: Work, care: Care | None = None) -> Prepared:
        """What pictures and points are computed from."""
        return self.solve(scene, purpose, work, care)

    def refine(
        self, solved: Solved, scene: Scene, purpose: Purpose, work: Work, care: Care, max_error: float | None
    ) -> Solved:
        """What was solved with these options, finer: until its error meets `max_error`, or for None by one step.

        Raises EclatError where the method cannot.
        """
        raise EclatError(f"refine: expected records, got a {solved.called}, which can only be solved anew")

    def at_effort(self, share: float, max_error: float) -> Self:
        """The same method with that share (1 or less) of the effort of these options, or for that error, as it has settings
        for the one or the other: so that methods are compared at several levels."""
        return self


Source = Method | Prepared
"""What light is computed by: what the verbs are given."""

METHODS: dict[str, type[Method]] = {}
"""Name → method."""

M = TypeVar("M", bound=type[Method])
S = TypeVar("S", bound=Solved)


def register(method: M) -> M:
    """Add a method to `METHODS`, and so to all verbs and commands."""
    METHODS[method.name] = method
    return method


def solving_methods() -> list[str]:
    """Names of the methods whose solutions can be kept."""
    return [name for name, method in METHODS.items() if method.solved is not None]


def method_class(name: str) -> type[Method]:
    """The method of that name. Raises EclatError with the nearest name where there is none."""
    if name not in METHODS:
        raise EclatError(f"unknown method {name!r}, expected one of {', '.join(METHODS)}{did_you_mean(name, METHODS)}")
    return METHODS[name]


def make_options(method: str, **settings: object) -> Method:
    """A method with some fields set. Raises EclatError for an unknown method or field."""
    cls = method_class(method)
    known = [field.name for field in dataclasses.fields(cls)]
    for key in settings:
        if key not in known:
            raise EclatError(f"unknown option {key} for {method}{did_you_mean(key, known)}")
    return cls(**settings)


def as_method(what: Source | type[Method] | str | None, default: Method | None = None, **settings: object) -> Source:
    """What a verb was given, as a method or as what was solved.

    Parameters
    ----------
    what : a method; its class or its name, which take those of the `settings` that it has; what was solved; or None.
    default : for None.

    Raises
    ------
    EclatError : an unknown name, or something else.
    """
    if isinstance(what, str):
        what = method_class(what)
    if isinstance(what, type) and issubclass(what, Method):
        known = {field.name for field in dataclasses.fields(what)}
        return what(**{name: value for name, value in settings.items() if name in known})
    if what is None and default is not None:
        return default
    if isinstance(what, Method | Prepared):
        return what
    raise EclatError(f"expected a method, its name or what was solved, got {what!r}")


def load_solved(path: str | os.PathLike[str], scene: Scene | None = None) -> Solved:
    """What `eclat solve` or `save` wrote, of any method; with `scene`, refused where it was solved for another.

    Raises EclatError.
    """
    return _load(path, scene)


def merge(first: S, second: S) -> S:
    """Two solutions of one scene as one: the records of both, sorted, without duplicates, or the photons of both.

    Commutative. For records it is not the same as one joint solve; photons are then those of one emission.

    Raises EclatError where methods, scenes or options differ, where both hold the same photons (by their seed), or for
    radiosity.
    """
    merged = first.merge(second)
    assert isinstance(merged, type(first))
    return merged


def _load(path: str | os.PathLike[str], scene: Scene | None) -> Solved:
    name = os.fspath(path)
    header, arrays = read_archive(path)
    known = METHODS.get(str(header.get("method")))
    cls = known.solved if known is not None else None
    if known is None or cls is None:
        raise EclatError(f"{name}: nothing that Éclat solved, or of another version: solve the scene again")
    if header.get("format") != cls.format:
        raise EclatError(f"{name}: a {cls.called} of another version of Éclat: solve the scene again")
    try:
        common = _common(known(**header["options"]), header)
        solved = cls.from_parts(common, header, arrays)
    except DamagedArrayError as error:
        raise EclatError(f"{name}: the array {str(error)!r} is damaged") from error
    except (KeyError, TypeError, ValueError, OverflowError, AttributeError) as error:
        raise EclatError(f"{name}: its header is damaged ({error})") from error
    if scene is not None:
        solved.require_match(staged(scene), solved.max_depth)
    return solved


def _common(options: Method, header: Mapping[str, Any]) -> Common:
    """The fields that all solved values have. Raises KeyError or ValueError, since files can be edited."""
    for name, kind in (("fingerprint", str), ("max_depth", int), ("complete", bool), ("statistics", dict)):
        if type(header[name]) is not kind:
            raise ValueError(f"{name} is {header[name]!r:.60}")
    statistics = {str(name): float(value) for name, value in header["statistics"].items()}
    return Common(options, header["fingerprint"], header["max_depth"], header["complete"], statistics)


class DamagedArrayError(ValueError):
    """An array of a file, by its name, is absent or not what it should be."""
