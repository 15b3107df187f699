# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Files are whole or as they were, whatever fails."""

from __future__ import annotations

import errno
import os
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from eclat.errors import EclatError
from eclat.files.atomic_file import check_writable, write_file, write_files


def test_a_new_file_has_the_permissions_that_open_would_give(tmp_path: Path) -> None:
    before = os.umask(0o027)
    try:
        write_file(tmp_path / "new", b"abc")
    finally:
        os.umask(before)
    assert (tmp_path / "new").read_bytes() == b"abc"
    assert (tmp_path / "new").stat().st_mode & 0o777 == 0o640


def test_an_old_file_is_replaced_and_keeps_its_permissions(tmp_path: Path) -> None:
    path = tmp_path / "old"
    path.write_bytes(b"old")
    path.chmod(0o604)
    write_file(path, b"new")
    assert path.read_bytes() == b"new"
    assert path.stat().st_mode & 0o777 == 0o604


def test_a_symbolic_link_is_kept_when_its_target_is_written(tmp_path: Path) -> None:
    (tmp_path / "target").write_bytes(b"old")
    (tmp_path / "link").symlink_to("target")
    write_file(tmp_path / "link", b"new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "target").read_bytes() == b"new"


def test_a_name_as_long_as_the_file_system_allows(tmp_path: Path) -> None:
    path = tmp_path / ("x" * 255)
    write_file(path, b"new")
    assert path.read_bytes() == b"new"


@pytest.mark.parametrize("step", ["fsync", "replace", "chmod"])
@pytest.mark.parametrize("failure", [OSError(errno.ENOSPC, "No space left on device"), KeyboardInterrupt()])
def test_a_failure_in_any_step_leaves_the_old_file_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, step: str, failure: BaseException
) -> None:
    path = tmp_path / "picture.png"
    path.write_bytes(b"old")

    def fail(*arguments: object) -> None:
        raise failure

    monkeypatch.setattr(os, step, fail)
    expected = EclatError if isinstance(failure, OSError) else KeyboardInterrupt
    with pytest.raises(expected) as caught:
        write_file(path, b"new")
    if expected is EclatError:
        assert str(caught.value) == f"{path}: the file cannot be written: No space left on device"
    assert path.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["picture.png"]


@pytest.fixture
def tiny_disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of 64 kB."""
    folder = tmp_path / "disk"
    folder.mkdir()
    if shutil.which("mount") is None:
        pytest.skip("needs the program mount")
    made = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", folder], capture_output=True, check=False)
    if made.returncode:
        pytest.skip("needs the right to mount a tmpfs")
    yield folder
    subprocess.run(["umount", folder], check=True)


def test_a_full_file_system_is_reported(tiny_disk: Path) -> None:
    path = tiny_disk / "picture.exr"
    path.write_bytes(b"old")
    with pytest.raises(EclatError, match="No space left on device"):
        write_file(path, bytes(1 << 20))
    assert path.read_bytes() == b"old"
    assert os.listdir(tiny_disk) == ["picture.exr"]


def test_bad_places_are_named(tmp_path: Path) -> None:
    missing = tmp_path / "no" / "picture.png"
    with pytest.raises(EclatError) as caught:
        check_writable(missing)
    assert (
        str(caught.value)
        == f"{missing}: the file cannot be written, because the folder {missing.parent} does not exist"
    )
    with pytest.raises(EclatError) as caught:
        check_writable(tmp_path)
    assert str(caught.value) == (
        f"{tmp_path}: the file cannot be written, because this is the name of a folder or a device"
    )


def test_a_set_of_files_is_written_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    one, two, three = (tmp_path / name for name in ("one", "two", "three"))
    write_files({one: b"1", two: b"2", three: b"3"})
    three.unlink()
    real = os.replace

    def failing(at: Path, error: BaseException) -> None:
        def replace(source: str, target: str | Path) -> None:
            if Path(target) == at and Path(source).read_bytes() == b"new":
                raise error
            real(source, target)

        monkeypatch.setattr(os, "replace", replace)

    for at in (one, two, three):
        for error, kind in (
            (OSError(28, "No space left on device"), EclatError),
            (KeyboardInterrupt(), KeyboardInterrupt),
        ):
            failing(at, error)
            with pytest.raises(kind):
                write_files({three: b"new", two: b"new", one: b"new"})
            assert sorted(path.name for path in tmp_path.iterdir()) == ["one", "two"]
            assert (one.read_bytes(), two.read_bytes()) == (b"1", b"2")
    monkeypatch.setattr(os, "replace", real)
    with pytest.raises(EclatError, match="does not exist"):
        write_files({one: b"new", tmp_path / "none" / "x": b"new"})
    assert one.read_bytes() == b"1"
    write_files({three: b"new", one: b"new"})
    assert sorted(path.name for path in tmp_path.iterdir()) == ["one", "three", "two"]


def test_names_that_are_too_long_are_refused_before_the_work(tmp_path: Path) -> None:
    with pytest.raises(EclatError, match="cannot be written: File name too long"):
        check_writable(tmp_path / ("n" * 300 + ".exr"))
