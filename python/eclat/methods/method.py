# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The interface of all methods, and of what they prepare for a scene. The verbs know nothing else of a method.

A method is a value: its options. It *prepares* a scene for a purpose, and what it prepared gives estimators: of radiance
along camera rays, and of irradiance at points. What can also be kept in a file is a `Solved`. A new method needs its
own class, its solved class if it has one, and a call of `register`.
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
from eclat.errors import EclatError, did_you_mean, shown, warn
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
        """This value itself, after a check of scene and depth, so that verbs take methods and solutions alike."""
        if care is not None and care.refine:
            raise EclatError("refine: expected a method, got what was solved: `eclat.refine` goes on from that")
        self.require_match(scene, work.max_depth)
        return self

    def require_match(self, scene: Scene, max_depth: int) -> None:
        """Raise EclatError if it was prepared for another scene or depth."""
        return

    @abstractmethod
    def radiance_estimator(self, scene: Scene, work: Work) -> _core.Estimator:
        """The estimator of radiance along camera rays. `estimators.radiance_from` makes one from a Python function."""

    @abstractmethod
    def point_estimator(self, scene: Scene, work: Work) -> _core.PointEstimator:
        """The estimator of irradiance at points. `estimators.irradiance_from` makes one from a Python function."""

    def passes(self, scene: Scene, work: Work) -> PassEstimator | None:
        """One estimator for each sample of all pixels; None if `radiance_estimator` serves all samples."""
        return None

    @property
    def estimate(self) -> ErrorEstimate | None:
        """The estimated error for the purpose it was prepared for; None if the error was not estimated."""
        return None

    @property
    def record_positions(self) -> FloatArray | None:
        """World positions of the records to show in pictures, shape (N, 3); None if there are no records."""
        return None

    def layers(self, film: _core.Film) -> dict[str, np.ndarray]:
        """The layers that this method adds to those that all pictures have."""
        return {}

    def picture_statistics(self, film: _core.Film) -> dict[str, float]:
        """The entries that it adds to the statistics of a picture."""
        return {}


class Solved(Prepared):
    """The solution of a scene by a method. It can be saved, loaded, merged, described and used again.

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
        """The arrays to save, by name."""

    def header(self) -> dict[str, Any]:
        """The JSON-compatible values to save besides the arrays and the fields that all solutions have."""
        return {}

    @classmethod
    @abstractmethod
    def from_parts(cls, common: Common, header: Mapping[str, Any], arrays: Mapping[str, np.ndarray]) -> Self:
        """Make a solution from saved data. Raises KeyError, TypeError or ValueError with the name of a damaged
        array."""

    def merged(self, other: Self) -> Self:
        """Merge two solutions of the same scene, options and depth. Raises EclatError if the method cannot."""
        raise EclatError(f"merge: expected records or photons, got {self.options.name}, whose solutions are whole")

    @property
    def nbytes(self) -> int:
        """The size of the arrays in bytes."""
        return sum(array.nbytes for array in self.arrays().values())

    def require_match(self, scene: Scene, max_depth: int) -> None:
        """Raise EclatError if it was solved for another scene or depth. Warn if it is incomplete."""
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
        """Merge two solutions. Raises EclatError if methods, scenes or options differ."""
        if type(self) is not type(other):
            raise EclatError(f"merge: expected two of one kind, got a {self.called} and a {other.called}")
        if self.fingerprint != other.fingerprint:
            raise EclatError(f"merge: each {self.called} was solved for a scene of its own: expected the same scene")
        if (self.options, self.max_depth) != (other.options, other.max_depth):
            raise EclatError(f"merge: each {self.called} was solved with options of its own: expected the same options")
        return self.merged(other)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write an `.npz` file, completely or not at all. Raises EclatError if it cannot be written."""
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
        """Read a saved solution. Raises EclatError, also if it was solved for another scene than a given `scene`."""
        found = _load(path, scene)
        if not isinstance(found, cls):
            raise EclatError(f"{os.fspath(path)}: expected a {cls.called}, got a {found.called}")
        return found

    def describe(self) -> str:
        """One line of text that describes the solution."""
        parts = [f"{len(self):,} {self.consists_of}", *self.remarks()]
        if "seconds" in self.statistics:
            parts.append(f"{self.statistics['seconds']:.1f} s")
        if not self.complete:
            parts.append("incomplete")
        return ", ".join(filter(None, (*parts, error_text(self.statistics))))

    def remarks(self) -> list[str]:
        """Further text for `describe`."""
        return []

    def facts(self) -> dict[str, Any]:
        """The same facts as JSON-compatible values, for programs."""
        return {self.consists_of: len(self), "complete": self.complete, "statistics": dict(self.statistics)}

    def picture_statistics(self, film: _core.Film) -> dict[str, float]:
        return {"bytes": float(self.nbytes), self.consists_of: float(len(self))}

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {self.describe()}>"


@dataclass(frozen=True)
class Common:
    """The fields that all solutions have, as they were saved."""

    options: Any
    fingerprint: str
    max_depth: int
    complete: bool
    statistics: dict[str, float]


@dataclass(frozen=True)
class Method(ABC):
    """A way to compute light, with its options. Every field has a default that suits most scenes."""

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
        """This method itself, so that verbs take methods and solutions alike."""
        return self

    def require_match(self, scene: Scene, max_depth: int) -> None:
        """Accept every scene and depth, since nothing was solved."""
        return

    def solve(self, scene: Scene, purpose: Purpose, work: Work, care: Care | None = None) -> Solved:
        """Compute a solution that can be kept. Raises EclatError if the method has nothing to solve."""
        raise EclatError(f"{self.name} has nothing to solve: expected one of {', '.join(solving_methods())}")

    def prepare(self, scene: Scene, purpose: Purpose, work: Work, care: Care | None = None) -> Prepared:
        """Prepare what pictures and points are computed from."""
        return self.solve(scene, purpose, work, care)

    def refine(
        self, solved: Solved, scene: Scene, purpose: Purpose, work: Work, care: Care, max_error: float | None
    ) -> Solved:
        """Solve again with finer settings, until the error meets `max_error`; None takes one step.

        Raises EclatError if the method cannot be refined.
        """
        raise EclatError(f"refine: expected records, got a {solved.called}, which can only be solved anew")

    def at_effort(self, share: float, max_error: float) -> Self:
        """The same method with the given share (1 or less) of its effort, or with the given error, whichever its
        options express. Comparisons use it for their levels."""
        return self


Source = Method | Prepared
"""What light is computed by: what the verbs are given."""

METHODS: dict[str, type[Method]] = {}
"""Name → method."""

M = TypeVar("M", bound=type[Method])
S = TypeVar("S", bound=Solved)


def register(method: M) -> M:
    """Add a method to `METHODS`, which makes it available in all verbs and commands."""
    METHODS[method.name] = method
    return method


def solving_methods() -> list[str]:
    """Names of the methods whose solutions can be kept."""
    return [name for name, method in METHODS.items() if method.solved is not None]


def method_class(name: str) -> type[Method]:
    """The method with the given name. Raises EclatError, which suggests the nearest name, if there is none."""
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
    """Turn the `what` of a verb into a method or a solution.

    Parameters
    ----------
    what : a method, its class, its name, a solution, or None. A class or a name takes those `settings` that it has.
    default : the method that None stands for.

    Raises
    ------
    EclatError : the name is unknown, or `what` is nothing of the above.
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
    raise EclatError(f"expected a method, its name or what was solved, got {shown(what)}")


def load_solved(path: str | os.PathLike[str], scene: Scene | None = None) -> Solved:
    """Read a solution of any method that `eclat solve` or `save` wrote.

    Raises EclatError.
    """
    return _load(path, scene)


def merge(first: S, second: S) -> S:
    """Merge two solutions of one scene. The result has the records of both, sorted and without duplicates, or the
    photons of both.

    The order of the two does not matter. Merged photons are equal to those of one emission; merged records differ from
    those of one joint solve.

    Raises EclatError if methods, scenes or options differ, if both hold the photons of the same seed, or for radiosity.
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
    """The fields that all solutions have. Raises KeyError or ValueError if the header lacks one or holds a wrong
    one."""
    for name, kind in (("fingerprint", str), ("max_depth", int), ("complete", bool), ("statistics", dict)):
        if type(header[name]) is not kind:
            raise ValueError(f"{name} is {header[name]!r:.60}")
    statistics = {str(name): float(value) for name, value in header["statistics"].items()}
    return Common(options, header["fingerprint"], header["max_depth"], header["complete"], statistics)


class DamagedArrayError(ValueError):
    """An array of a file is missing or malformed. The argument is its name."""
