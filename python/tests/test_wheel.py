"""The script that puts the licences of libraries into a wheel."""

import doctest
import importlib.util
import pathlib
import shutil
import zipfile
from typing import Any

import pytest

SCRIPT = pathlib.Path(__file__).parents[1] / "licences_of_libraries.py"


@pytest.fixture
def script() -> Any:
    pytest.importorskip("auditwheel")
    spec = importlib.util.spec_from_file_location("licences_of_libraries", SCRIPT)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _wheel(path: pathlib.Path, library: str) -> None:
    with zipfile.ZipFile(path, "w") as file:
        file.writestr(f"gridlock.libs/{library}", "")
        file.writestr("gridlock-1.dist-info/WHEEL", "Wheel-Version: 1.0\nRoot-Is-Purelib: false\nTag: py3-none-any\n")
        file.writestr("gridlock-1.dist-info/METADATA", "Metadata-Version: 2.1\nName: gridlock\nVersion: 1\n")
        file.writestr("gridlock-1.dist-info/RECORD", "")


def test_the_examples_of_its_docstrings_are_true(script: Any) -> None:
    result = doctest.testmod(script)
    assert result.attempted > 0 and result.failed == 0


@pytest.mark.skipif(shutil.which("dpkg-query") is None, reason="the packages of Debian are asked")
def test_a_library_brings_the_licence_of_its_package_and_what_this_refers_to(script: Any, tmp_path: pathlib.Path) -> None:
    (tmp_path / "repaired").mkdir()
    _wheel(tmp_path / "repaired" / "gridlock-1-py3-none-any.whl", "libtbb-0f1e2d3c.so.12.8")
    script.main(str(tmp_path / "repaired" / "gridlock-1-py3-none-any.whl"), str(tmp_path))
    with zipfile.ZipFile(tmp_path / "gridlock-1-py3-none-any.whl") as file:
        names = set(file.namelist())
    assert {"gridlock.libs/licenses/libtbb12.txt", "gridlock.libs/licenses/Apache-2.0"} <= names


@pytest.mark.skipif(shutil.which("dpkg-query") is None, reason="the packages of Debian are asked")
def test_a_library_of_no_package_is_refused_and_no_wheel_is_written(script: Any, tmp_path: pathlib.Path) -> None:
    (tmp_path / "repaired").mkdir()
    _wheel(tmp_path / "repaired" / "gridlock-1-py3-none-any.whl", "libofnobody-0f1e2d3c.so.1")
    with pytest.raises(SystemExit, match="no Debian package has libofnobody.so.1"):
        script.main(str(tmp_path / "repaired" / "gridlock-1-py3-none-any.whl"), str(tmp_path))
    assert not (tmp_path / "gridlock-1-py3-none-any.whl").exists()
