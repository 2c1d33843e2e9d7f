"""The types of the package are those that mypy --strict finds."""

import pathlib
import subprocess
import sys

import gridlock


def test_the_package_its_studies_and_its_example_are_typed(root):
    package = pathlib.Path(gridlock.__file__).parent
    result = subprocess.run([sys.executable, "-m", "mypy", "--strict", "gridlock", "gridlock_studies", root / "examples/gallery.py"],
                            cwd=package.parent, capture_output=True, text=True)
    assert result.returncode == 0, result.stdout
