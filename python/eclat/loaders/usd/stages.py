# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Open USD stages, and read values of their attributes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, warn
from eclat.files.arrays import read_file
from eclat.files.confinement import check_confined
from eclat.loaders.budget import count_file
from eclat.loaders.optional import optional_module

MOST_REPORTS = 5
"""The largest number of problems that USD reports about a file of which each becomes a warning."""
LONGEST = 300
"""The largest number of characters of such a report that are shown."""


def pxr(module: str) -> Any:
    """Import a module of `usd-core`, such as "UsdGeom". Raises EclatError if the package is not installed."""
    return optional_module(f"pxr.{module}", "usd", "USD files")


@dataclass(frozen=True)
class Stage:
    """An open stage, the time at which it is read, and its units."""

    stage: Any
    name: str
    """The name of the file, for messages."""
    time: Any
    metres: float
    """The length of a unit in metres."""
    z_up: bool
    reports: set[str]
    """What `once` has warned about."""

    def where(self, prim: Any) -> str:
        """Return the file and the path of a prim, for messages."""
        return f"{self.name}, {prim.GetPath()}"

    def value(self, attribute: Any, default: Any = None) -> Any:
        """Return the value of an attribute, or `default` if the attribute is invalid or has none.

        Raises EclatError if the file gives the value a type that the schema does not know.
        """
        if not attribute:
            return default
        if attribute.ValueMightBeTimeVarying():
            self.once("motion", "values that change over time are those of the first time")
        found = attribute.Get(self.time)
        if type(found).__name__ == "UnregisteredValue":
            raise EclatError(f"{self.name}, {attribute.GetPath()}: expected a value of a known type, got another")
        return default if found is None else found

    def number(self, attribute: Any, default: float) -> float:
        """Return a finite number. Raises EclatError if the value is not one."""
        number = float(self.value(attribute, default))
        if not abs(number) < 3.4e38:  # the largest value of a 32-bit float
            raise EclatError(f"{self.name}, {attribute.GetPath()}: expected a finite number, got {number}")
        return number

    def once(self, what: str, message: str) -> None:
        """Warn about `what` unless the same has been warned about before."""
        if what not in self.reports:
            self.reports.add(what)
            warn(f"{self.name}: {message}")


@contextmanager
def opened(path: Path) -> Iterator[Stage]:
    """Open a USD file for the body of this context; what USD reports meanwhile becomes warnings.

    Raises
    ------
    EclatError : the file or a layer of it cannot be read or lies outside the root folder, or the package is not installed.
    """
    usd, tools, geometry = pxr("Usd"), pxr("UsdUtils"), pxr("UsdGeom")
    read_file(path, where=path.name, limit=1 << 32)
    listener = tools.CoalescingDiagnosticDelegate()
    try:
        try:
            stage = usd.Stage.Open(str(path))
        except pxr("Tf").ErrorException as error:
            listener.TakeUncoalescedDiagnostics()
            raise EclatError(f"{path.name}: expected a USD file, got an error: {_reason(error)}") from None
        _check_layers(stage, path)
        _warn_of(listener, path.name)
        start = stage.GetStartTimeCode() if stage.HasAuthoredTimeCodeRange() else None
        yield Stage(
            stage=stage,
            name=path.name,
            time=usd.TimeCode.EarliestTime() if start is None or not np.isfinite(start) else usd.TimeCode(start),
            metres=_metres(geometry.GetStageMetersPerUnit(stage), path.name),
            z_up=geometry.GetStageUpAxis(stage) == geometry.Tokens.z,
            reports=set(),
        )
        _warn_of(listener, path.name)
    finally:
        # What is left in the listener would be printed when it is deleted.
        listener.TakeUncoalescedDiagnostics()


@contextmanager
def guarded(name: str) -> Iterator[None]:
    """Turn what the package raises about damaged values in the body of this context into EclatError.

    It raises its own exceptions where it cannot unpack a value, and those of Python where a value has no form in Python.
    """
    try:
        yield
    except UnicodeDecodeError:
        raise EclatError(f"{name}: expected names in UTF-8, got other bytes") from None
    except pxr("Tf").ErrorException as error:
        raise EclatError(f"{name}: expected valid values, got an error: {_reason(error)}") from None
    except TypeError as error:
        if "to_python" not in str(error):
            raise
        raise EclatError(f"{name}: expected values of known types, got another: {_short(str(error))}") from None


def _metres(unit: float, name: str) -> float:
    if not (np.isfinite(unit) and unit > 0):
        warn(f"{name}: expected a metersPerUnit above 0, got {unit}; 0.01 is used instead, as without one")
        return 0.01
    return float(unit)


def _check_layers(stage: Any, path: Path) -> None:
    """Count the files of a stage. Raises EclatError if one of them lies outside the root folder."""
    for layer in stage.GetUsedLayers():
        # The path of a layer in an archive has the name of the file inside in brackets.
        real = layer.realPath.partition("[")[0]
        if not real:
            continue
        check_confined(real, path.name)
        count_file(Path(real), Path(real).stat().st_size)


def _reason(error: Exception) -> str:
    """Return the first sentence of an error of USD, without the place in its sources."""
    try:
        text = str(error.args[0] if error.args else error)
    except UnicodeDecodeError:
        return "what it says is not in UTF-8"
    return _short(text.partition(" : '")[2] or text)


def _short(text: str) -> str:
    # What follows names the stage by its address in memory.
    line = " ".join(text.split()).partition(" (instantiating stage")[0].rstrip("' ")
    return line if len(line) <= LONGEST else line[:LONGEST] + "…"


def _warn_of(listener: Any, name: str) -> None:
    """Warn about what USD reported."""
    reports = list(dict.fromkeys(_commentary(report) for report in listener.TakeUncoalescedDiagnostics()))
    for report in reports[:MOST_REPORTS]:
        warn(f"{name}: USD reports: {report}")
    if len(reports) > MOST_REPORTS:
        warn(f"{name}: USD reports {len(reports) - MOST_REPORTS} more problems of this file")


def _commentary(report: Any) -> str:
    try:
        return _short(report.commentary)
    except UnicodeDecodeError:
        return "a problem whose description is not in UTF-8"


def matrix(value: Any) -> NDArray[np.float64]:
    """Return a matrix of USD, which multiplies rows from the right, as a 4×4 matrix that multiplies columns."""
    return np.array(value, dtype=np.float64).T
