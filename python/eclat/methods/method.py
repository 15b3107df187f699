# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The interface of all methods. The verbs use methods only through this interface.

A method is an object that holds its options. It *prepares* a scene for a purpose; the result, a `Prepared`, makes
estimators of radiance along camera rays and of irradiance at points. A result that can also be kept in a file is a
`Solved`. A new method needs a class of its own, a subclass of `Solved` if its results can be kept, and a call of
`register`.
"""

from __future__ import annotations

import dataclasses
import functools
import os
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol, Self, TypeVar

import numpy as np

from eclat import _core
from eclat.bridge.compiled import fingerprint
from eclat.errors import EclatError, shown, warn
from eclat.files.archive import write_archive
from eclat.html import facts_table
from eclat.measure.error_estimate import ErrorEstimate, error_text
from eclat.methods.saved import Common, read_saved
from eclat.methods.work import Care, Purpose, Times, Work
from eclat.scene import FloatArray, Scene
from eclat.stage.staging import staged
from eclat.typed import refuse_unknown, typed

PassEstimator = Callable[[int, _core.Progress], _core.Estimator]
"""A function from the index of a sample, from 0, to the estimator that takes this sample."""


class Prepared(ABC):
    """The result of preparing one scene by a method, which makes the estimators that the verbs use.

    Subclasses are frozen dataclasses that have at least these fields.
    """

    options: Method
    statistics: dict[str, float]

    def prepare(self, scene: Scene, purpose: Purpose, work: Work, care: Care | None = None) -> Prepared:
        """Return this object after checking its scene and depth, so that verbs use methods and solutions alike."""
        if care is not None and care.refine:
            raise EclatError("refine: expected a method, got a solution; call `eclat.refine` to refine a solution")
        self.require_match(scene, work.max_depth)
        return self

    def require_match(self, scene: Scene, max_depth: int) -> None:
        """Raise EclatError if this was prepared for another scene or another `max_depth`."""
        return

    @abstractmethod
    def radiance_estimator(self, scene: Scene, work: Work) -> _core.Estimator:
        """Make the estimator of radiance along camera rays; `estimators.radiance_from` makes one from a function."""

    @abstractmethod
    def point_estimator(self, scene: Scene, work: Work) -> _core.PointEstimator:
        """Make the estimator of irradiance at points. `estimators.irradiance_from` makes one from a Python function."""

    def passes(self, scene: Scene, work: Work) -> PassEstimator | None:
        """Return a function that makes a new estimator for each sample, or None if the estimator of
        `radiance_estimator` serves all samples.
        """
        return None

    @property
    def estimate(self) -> ErrorEstimate | None:
        """The estimated error for the purpose that this was prepared for; None if the error was not estimated."""
        return None

    @property
    def errs_by_noise_alone(self) -> bool:
        """Whether noise is the only error of a picture, so that the difference between two halves of its samples
        measures it.
        """
        return False

    @property
    def error_behind(self) -> ErrorEstimate | None:
        """The estimated error of prepared data that paths read only after a matte surface, those of all pixels alike; None if
        there are no such data or their error was not estimated.
        """
        return None

    def reference_estimator(self, scene: Scene, work: Work) -> _core.Estimator | None:
        """Make an unbiased estimator that does not read prepared data, with which the error of pictures is measured;
        None if there is none.
        """
        return None

    def final_gather(self) -> Prepared | None:
        """Return what reads the prepared data less directly, with more noise and less error: only where paths arrive that have
        gone on from a matte surface. None if there is no such thing.
        """
        return None

    @property
    def record_positions(self) -> FloatArray | None:
        """The world positions (N, 3) of the records, which pictures can mark; None if there are no records."""
        return None

    def layers(self, film: _core.Film) -> dict[str, np.ndarray]:
        """Return the layers that this method adds to the layers of all pictures."""
        return {}

    def picture_statistics(self, film: _core.Film) -> dict[str, float]:
        """Return the entries that this method adds to the statistics of a picture."""
        return {}


class Solved(Prepared):
    """The solution of a scene by a method, which can be saved, loaded, merged, described and used again.

    Subclasses are frozen dataclasses, made with `repr=False` and `eq=False`, that have at least these fields.
    """

    called: ClassVar[str]
    """Noun for such a solution in messages, such as "cache"."""
    consists_of: ClassVar[str]
    """Noun for the parts that `len` counts, such as "records"."""
    format: ClassVar[int]
    """Version of the format of its files, which is incremented whenever the format changes."""

    fingerprint: str
    """The fingerprint of the scene (`bridge.compiled.fingerprint`)."""
    max_depth: int
    complete: bool = True
    """False if the solve was interrupted."""

    @abstractmethod
    def __len__(self) -> int: ...

    @abstractmethod
    def arrays(self) -> dict[str, np.ndarray]:
        """Return the arrays to save, by name."""

    def header(self) -> dict[str, Any]:
        """Return the JSON-compatible values to save, besides the arrays and the fields that all solutions have."""
        return {}

    @classmethod
    @abstractmethod
    def from_parts(cls, common: Common, header: Mapping[str, Any], arrays: Mapping[str, np.ndarray]) -> Self:
        """Make a solution from saved data. Raises KeyError, TypeError or ValueError if the data are damaged."""

    def merged(self, other: Self) -> Self:
        """Merge two solutions of the same scene, options and depth. Raises EclatError if the method cannot merge."""
        raise EclatError(f"merge: expected records or photons, got a {self.called}: {self.options.name} cannot merge")

    @property
    def nbytes(self) -> int:
        """Total size of the arrays in bytes."""
        return sum(array.nbytes for array in self.arrays().values())

    def require_match(self, scene: Scene, max_depth: int) -> None:
        """Raise EclatError if this was solved for another scene or another `max_depth`. Warn if it is incomplete."""
        if self.fingerprint != fingerprint(scene):
            raise EclatError(
                f"this {self.called} was solved for another scene: geometry, materials or lights differ; solve this scene again"
            )
        if self.max_depth != max_depth:
            raise EclatError(
                f"max_depth: expected {self.max_depth}, with which this {self.called} was solved, got {max_depth}"
            )
        if not self.complete:
            warn(
                f"this {self.called} is incomplete, because its solve was interrupted: more paths are traced, with more noise"
            )

    def merge(self, other: Solved) -> Solved:
        """Merge two solutions. Raises EclatError if their methods, scenes or options differ."""
        if type(self) is not type(other):
            raise EclatError(f"merge: expected two solutions of one kind, got a {self.called} and a {other.called}")
        if self.fingerprint != other.fingerprint:
            raise EclatError(f"merge: expected two solutions of the same scene, got a {self.called} of another scene")
        if (self.options, self.max_depth) != (other.options, other.max_depth):
            raise EclatError(
                f"merge: expected two solutions with the same options and max_depth, got a {self.called} with others"
            )
        return self.merged(other)

    @typed
    def save(self, path: str | os.PathLike[str]) -> None:
        """Write an `.npz` file, either completely or not at all. Raises EclatError if it cannot be written."""
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
    @typed
    def load(cls, path: str | os.PathLike[str], scene: Scene | None = None) -> Self:
        """Read a saved solution.

        Raises EclatError if the file cannot be read, holds another kind of solution, or was solved for another scene
        than `scene`, if that is given.
        """
        found = _load(path, scene)
        if not isinstance(found, cls):
            raise EclatError(f"{os.fspath(path)}: expected a {cls.called}, got a {found.called}")
        return found

    def describe(self) -> str:
        """Describe the solution in one line of text."""
        parts = [f"{len(self):,} {self.consists_of}", *self.remarks()]
        if "seconds" in self.statistics:
            parts.append(f"{self.statistics['seconds']:.1f} s")
        if not self.complete:
            parts.append("incomplete")
        return ", ".join(filter(None, (*parts, error_text(self.statistics))))

    def remarks(self) -> list[str]:
        """Return further parts of the text of `describe`."""
        return []

    def facts(self) -> dict[str, Any]:
        """Return the facts that `describe` states as JSON-compatible values, for programs."""
        return {self.consists_of: len(self), "complete": self.complete, "statistics": dict(self.statistics)}

    def picture_statistics(self, film: _core.Film) -> dict[str, float]:
        return {"bytes": float(self.nbytes), self.consists_of: float(len(self))}

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {self.describe()}>"

    def _repr_html_(self) -> str:
        """Return the facts as a table, for notebooks."""
        rows: dict[str, object] = {
            "method": self.options.name, self.consists_of: f"{len(self):,}", "state": self.describe(),
            "memory": f"{self.nbytes / 1e6:.1f} MB",
        }  # fmt: skip
        changed = {f.name: getattr(self.options, f.name) for f in dataclasses.fields(self.options)}
        rows["options"] = ", ".join(f"{name}={value}" for name, value in changed.items())
        return facts_table(type(self).__name__, rows)


class OverTime(Protocol):
    """What a method solved for all times of an animation at once."""

    @property
    def statistics(self) -> dict[str, float]: ...

    def at(self, time: int) -> Prepared:
        """Return what it prepared for a time, by its index."""
        ...

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write a file that `Method.load_over_time` reads. Raises EclatError if it cannot be written."""
        ...


@dataclass(frozen=True)
class Method(ABC):
    """A way to compute light, with its options. Every field has a default that suits most scenes."""

    name: ClassVar[str]
    """Name of the method on the command line, in files and in tables."""
    cannot: ClassVar[str]
    """The light that the method leaves out or gets wrong, as the comparison page describes it."""
    solved: ClassVar[type[Solved] | None] = None
    """The class of the solutions that `solve` makes, which can be kept in files; None if the method has none."""
    for_whole_scene: ClassVar[bool] = True
    """Whether a solution serves every purpose. Otherwise a solution is made for a view, for points or for all surfaces;
    its error there is estimated, and it can be refined."""
    has_records: ClassVar[bool] = False
    """Whether indirect light is interpolated between records. Such light has little noise, so pictures use adaptive
    sampling by default."""

    @property
    def options(self) -> Method:
        """This method itself, so that verbs can use methods and solutions in the same way."""
        return self

    def require_match(self, scene: Scene, max_depth: int) -> None:
        """Accept every scene and depth, because nothing was solved."""
        return

    def solve(self, scene: Scene, purpose: Purpose, work: Work, care: Care | None = None) -> Solved:
        """Compute a solution, which can be kept in a file. Raises EclatError if the method has nothing to solve."""
        raise EclatError(
            f"solve: expected one of {', '.join(solving_methods())}, got {self.name}, which has nothing to solve"
        )

    def prepare(self, scene: Scene, purpose: Purpose, work: Work, care: Care | None = None) -> Prepared:
        """Prepare the scene for a purpose, so that pictures or the light at points can be computed."""
        return self.solve(scene, purpose, work, care)

    @property
    def shares_over_time(self) -> bool:
        """Whether `solve_over_time` computes what the pictures of an animation share in which more than the camera moves.
        Otherwise each is prepared anew.
        """
        return False

    def solve_over_time(self, times: Times, work: Work) -> OverTime:
        """Solve for all times of an animation at once. Raises EclatError if the method does not."""
        raise EclatError(f"expected a method that is solved over time, got {self.name}")

    def load_over_time(self, path: str | os.PathLike[str], times: Times, work: Work) -> OverTime:
        """Read what `solve_over_time` computed for the same times and work, from a file. Raises EclatError if it is
        damaged."""
        raise EclatError(f"expected a method that is solved over time, got {self.name}")

    def refine(
        self, solved: Solved, scene: Scene, purpose: Purpose, work: Work, care: Care, max_error: float | None
    ) -> Solved:
        """Solve again with finer settings, until the estimated error is below `max_error`; None takes one step.

        Raises EclatError if the method cannot be refined.
        """
        raise EclatError(
            f"refine: expected records, got a {solved.called}, which cannot be refined: solve the scene again"
        )

    def at_effort(self, share: float, max_error: float) -> Self:
        """Return the method with the given share (0..1) of its effort, or with the given error, depending on its
        options. `compare` uses it for its levels."""
        return self


Source = Method | Prepared
"""The argument of the verbs that determines how light is computed."""

METHODS: dict[str, type[Method]] = {}
"""Maps names to the classes of methods."""

M = TypeVar("M", bound=type[Method])
S = TypeVar("S", bound=Solved)


def register(method: M) -> M:
    """Add a method to `METHODS`, which makes it available in all verbs and commands."""
    METHODS[method.name] = method
    _refuse_misspelt_options(method)
    return method


def _refuse_misspelt_options(method: type[Method]) -> None:
    """Let the class name the most similar option if one that it does not have is given."""
    made, known = method.__init__, [field.name for field in dataclasses.fields(method)]

    @functools.wraps(made)
    def checked(self: Method, *args: Any, **kwargs: Any) -> None:
        refuse_unknown(type(self).__name__, kwargs, known)
        made(self, *args, **kwargs)

    setattr(method, "__init__", checked)  # noqa: B010 - an assignment would be an error of types


def solving_methods() -> list[str]:
    """List the names of the methods whose solutions can be kept."""
    return [name for name, method in METHODS.items() if method.solved is not None]


@typed
def load_solved(path: str | os.PathLike[str], scene: Scene | None = None) -> Solved:
    """Read a solution of any method, which `eclat solve` or `Solved.save` wrote.

    Raises EclatError if the file cannot be read, or if it was solved for another scene than `scene`, if that is given.
    """
    return _load(path, scene)


def merge(first: S, second: S) -> S:
    """Merge two solutions of one scene. The result has the records of both, sorted and without duplicates, or the
    photons of both.

    The order of the two does not matter. Merged photons are statistically equivalent to photons that are traced
    together; merged records differ from records that are solved together.

    Raises EclatError if the methods, scenes or options differ, if both hold the photons of the same seed, or if they
    are solutions of radiosity.
    """
    for solution in (first, second):
        if not isinstance(solution, Solved):
            raise EclatError(f"merge: expected two solutions, got {shown(solution)}")
    merged = first.merge(second)
    assert isinstance(merged, type(first))
    return merged


def _load(path: str | os.PathLike[str], scene: Scene | None) -> Solved:
    solved: Solved = read_saved(path, METHODS)
    if scene is not None:
        solved.require_match(staged(scene), solved.max_depth)
    return solved
