"""Where the page is found."""

import os
import pathlib

import pytest

import gridlock.playground


def _put_page(folder: pathlib.Path) -> str:
    folder.mkdir(parents=True)
    page = folder / "playground.html"
    page.write_text("page")
    return os.fspath(page)


@pytest.mark.parametrize(
    ("package", "page"),
    [
        ("env/lib/python3.11/site-packages/gridlock", "env/share/gridlock/web"),
        ("sources/python/gridlock", "sources/build-web/page"),
        ("sources/build/python/gridlock", "sources/build-web/page"),
    ],
)
def test_the_page_is_found_from_where_the_package_is(
    package: str, page: str, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("GRIDLOCK_PLAYGROUND", raising=False)
    monkeypatch.setenv("PATH", os.fspath(tmp_path))
    monkeypatch.setattr(gridlock.playground, "__file__", os.fspath(tmp_path / package / "playground.py"))
    assert gridlock.playground.find_page() is None
    expected = _put_page(tmp_path / page)
    assert gridlock.playground.find_page() == expected
    assert gridlock.playground.find_folder() is None
    (tmp_path / page / "index.html").touch()
    assert gridlock.playground.find_folder() == os.fspath(tmp_path / page)


def test_the_page_is_found_beside_a_program_that_was_installed_elsewhere(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("GRIDLOCK_PLAYGROUND", raising=False)
    monkeypatch.setattr(gridlock.playground, "__file__", os.fspath(tmp_path / "a/b/c/d/gridlock/playground.py"))
    program = tmp_path / "prefix" / "bin" / "gridlock"
    program.parent.mkdir(parents=True)
    program.write_text("#!/bin/sh\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", os.fspath(program.parent))
    expected = _put_page(tmp_path / "prefix/share/gridlock/web")
    assert gridlock.playground.find_page() == expected
