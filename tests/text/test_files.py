"""Files are replaced whole or not at all."""

import errno
import os
import stat

import pytest

from fuzzyarm.base.files import confined, demand_allowed, stamp_of, write_atomically


def test_a_file_is_written_and_replaced(tmp_path):
    path = tmp_path / "x.lut"
    write_atomically(path, "one\n")
    write_atomically(path, b"two\n")
    assert path.read_bytes() == b"two\n"
    assert [p.name for p in tmp_path.iterdir()] == ["x.lut"]


def test_the_stamp_is_that_of_what_was_written_and_not_of_who_came_after(tmp_path, monkeypatch):
    path, replace = tmp_path / "x.lut", os.replace
    assert write_atomically(path, "mine") == stamp_of(path)
    os.link(path, tmp_path / "also.lut")  # written through
    assert write_atomically(path, "mine too") == stamp_of(path)
    (tmp_path / "also.lut").unlink()

    def overtaken(name, target):
        replace(name, target)
        target.write_text("theirs")

    monkeypatch.setattr(os, "replace", overtaken)
    assert write_atomically(path, "mine") != stamp_of(path)


def test_the_mode_of_an_existing_file_is_kept(tmp_path):
    path = tmp_path / "x.lut"
    path.write_text("old")
    path.chmod(0o640)
    write_atomically(path, "new")
    assert path.stat().st_mode & 0o777 == 0o640


def test_a_failing_write_leaves_the_old_file_and_nothing_else(tmp_path, monkeypatch):
    path = tmp_path / "x.lut"
    path.write_text("old")

    def fail(*_):
        raise OSError("the disk is full")

    monkeypatch.setattr(os, "replace", fail)
    with pytest.raises(OSError, match="full"):
        write_atomically(path, "new")
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["x.lut"]


def test_the_error_names_the_file_that_was_asked_for(tmp_path):
    path = tmp_path / "none" / "x.lut"
    with pytest.raises(FileNotFoundError) as caught:
        write_atomically(path, "x")
    assert caught.value.filename == str(path)


def test_a_folder_is_no_file_and_is_named(tmp_path):
    path = tmp_path / "x.lut"
    path.mkdir()
    with pytest.raises(IsADirectoryError) as caught:
        write_atomically(path, "x")
    assert caught.value.filename == str(path)
    assert [p.name for p in tmp_path.iterdir()] == ["x.lut"]


def test_a_file_that_may_not_be_written_stays(tmp_path, monkeypatch):
    path = tmp_path / "x.lut"
    path.write_text("old")
    # The superuser may write everything, so the answer of the system is put in its mouth.
    monkeypatch.setattr(os, "access", lambda asked, mode: not (asked == path and mode == os.W_OK))
    with pytest.raises(PermissionError) as caught:
        write_atomically(path, "new")
    assert caught.value.filename == str(path)
    assert path.read_text() == "old"


def test_a_link_goes_on_leading_to_the_file(tmp_path):
    path, link = tmp_path / "x.lut", tmp_path / "link.lut"
    path.write_text("old")
    link.symlink_to(path)
    write_atomically(link, "new")
    assert link.is_symlink()
    assert path.read_text() == "new"


def test_a_pipe_is_written_through(tmp_path):
    path = tmp_path / "pipe"
    os.mkfifo(path)
    reading = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    write_atomically(path, "new\n")
    assert os.read(reading, 100) == b"new\n"
    os.close(reading)
    assert stat.S_ISFIFO(path.stat().st_mode)


def test_every_name_of_a_file_has_the_new_text(tmp_path):
    path, other = tmp_path / "x.lut", tmp_path / "y.lut"
    path.write_text("a longer old text")
    other.hardlink_to(path)
    write_atomically(path, "new")
    assert other.read_text() == path.read_text() == "new"
    assert other.samefile(path)


@pytest.mark.parametrize("links", [1, 2])
def test_a_full_disk_names_the_file_that_was_asked_for(links, tmp_path, monkeypatch):
    path = tmp_path / "x.lut"
    path.write_text("old")
    if links > 1:
        (tmp_path / "y.lut").hardlink_to(path)
    full = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def open_full(*_, **__):
        raise full

    monkeypatch.setattr(os, "fdopen", open_full)
    monkeypatch.setattr("builtins.open", open_full)
    with pytest.raises(OSError, match="No space left") as caught:
        write_atomically(path, "new")
    assert caught.value.filename == str(path)
    assert path.stat().st_nlink == links


def test_a_circle_of_links_is_a_file_that_cannot_be_opened(tmp_path):
    one, other = tmp_path / "a.frb", tmp_path / "b.frb"
    one.symlink_to(other)
    other.symlink_to(one)
    with confined(tmp_path):
        demand_allowed(one)
        with pytest.raises(OSError, match="symbolic links"):
            one.read_text()
