# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What is published: one version everywhere, and a wheel that works where nothing else is installed."""

from __future__ import annotations

import platform
import re
import shutil
import subprocess
import sys
import tarfile
import venv
import zipfile
from pathlib import Path

import pytest

from eclat import _core

ROOT = Path(__file__).resolve().parents[2]


def test_all_places_name_the_same_version() -> None:
    done = subprocess.run([sys.executable, ROOT / "tools/check_version.py"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout
    other = subprocess.run([sys.executable, ROOT / "tools/check_version.py", "v9.9.9"], capture_output=True, text=True)
    assert other.returncode == 1
    assert "tag v9.9.9: expected v" in other.stdout


def test_the_core_needs_no_newer_c_library_than_wheels_promise() -> None:
    # A compiler links to the newest version of each function, std::hypot to that of glibc 2.35.
    name, version = platform.libc_ver()
    if name != "glibc" or tuple(map(int, version.split("."))) > (2, 36):
        pytest.skip("wheels are made with glibc 2.36 at most, and newer ones link to newer versions")
    objdump = shutil.which("objdump")
    if objdump is None:
        pytest.skip("objdump is not installed")
    said = subprocess.run([objdump, "-T", _core.__file__], capture_output=True, text=True, check=True).stdout
    needed = {tuple(map(int, found.split("."))): line for line, found in re.findall(r"(.*GLIBC_([\d.]+).*)", said)}
    assert max(needed) <= (2, 34), needed[max(needed)]


@pytest.mark.full  # Three cores and a clean environment: many minutes.
def test_the_wheel_works_in_a_clean_environment(tmp_path: Path) -> None:
    if not sys.platform.startswith("linux"):
        pytest.skip("tools/make_wheel is for Linux")
    dist = ROOT / "dist"
    subprocess.run([ROOT / "tools/make_wheel", sys.executable], check=True)
    wheel = max(dist.glob("*.whl"), key=lambda file: file.stat().st_mtime)
    sdist = max(dist.glob("*.tar.gz"), key=lambda file: file.stat().st_mtime)
    with tarfile.open(sdist) as archive:
        assert not any(re.search(r"/(tests|benchmarks|web|\.github)/", name) for name in archive.getnames())
    names = zipfile.ZipFile(wheel).namelist()
    assert any(re.match(r"eclat\.libs/libembree", name) for name in names)
    assert any(re.match(r"eclat\.libs/libtbb", name) for name in names)
    assert any(name.endswith("share/man/man1/eclat.1") for name in names)
    assert wheel.stat().st_size < 40e6
    environment = tmp_path / "clean"
    venv.create(environment, with_pip=True)
    subprocess.run([environment / "bin/pip", "install", "--quiet", wheel], check=True)
    subprocess.run([environment / "bin/python", ROOT / "tools/try_wheel.py"], cwd=tmp_path, check=True)
