# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The options `--workers` and `--scheduler`, by which a command computes in many processes or on many machines."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from eclat.cli.command import option, together
from eclat.cli.parameters import Number
from eclat.errors import EclatError

MACHINES = "Machines"

farm_options = together(
    option(
        "--workers",
        type=Number(int, 1, 1024),
        metavar="N",
        section=MACHINES,
        help="Compute in N processes on this machine, which Dask starts and replaces if they die [one process].",
    ),
    option(
        "--scheduler",
        metavar="ADDRESS",
        section=MACHINES,
        help="Compute on the workers of the Dask scheduler at this address, such as tcp://192.168.1.10:8786. The result has "
        "the bits of one machine. Schedulers run any code that they get, so use them in trusted networks only.",
    ),
)
"""Adds the options `--workers` and `--scheduler`."""


@contextmanager
def on_farm(flags: Mapping[str, Any]) -> Iterator[None]:
    """Compute on the workers that the flags ask for, if they do. Raises EclatError if there are none."""
    workers, scheduler = flags["workers"], flags["scheduler"]
    if workers is None and scheduler is None:
        yield
        return
    if workers is not None and scheduler is not None:
        raise EclatError("expected --workers or --scheduler, got both")
    from eclat.farm.farm import Farm

    with Farm.local(workers, flags["threads"]) if scheduler is None else Farm.connect(scheduler):
        yield
