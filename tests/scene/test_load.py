"""One way in for files and built-in scenes."""

from __future__ import annotations

import subprocess
import sys

import pytest

import irradia.scene
import irradia.scene.gltf
from irradia.core.errors import InputError
from irradia.scene.load import LoadOptions, load_scene


def test_file_is_loaded_by_its_path(shared_assets):
    scene = load_scene(str(shared_assets / "antique-camera" / "AntiqueCamera.gltf"))
    assert scene.name == "AntiqueCamera"


def test_builtin_scene_is_loaded_by_name():
    scene = load_scene("builtin:cornell")
    assert scene.n_triangles > 10
    assert scene.document is not None


def test_unknown_builtin_scene_lists_the_known_ones():
    with pytest.raises(InputError, match="cornell"):
        load_scene("builtin:cornel")


def test_options_reach_the_import(shared_assets):
    path = str(shared_assets / "antique-camera" / "AntiqueCamera.gltf")
    with pytest.raises(InputError, match="no variant 'red'"):
        load_scene(path, LoadOptions(variant="red"))


@pytest.mark.parametrize("package", [irradia.scene, irradia.scene.gltf])
def test_public_names_are_real(package):
    assert all(hasattr(package, name) for name in package.__all__)


def test_import_is_light():
    heavy = ("mitsuba", "drjit", "numba", "scipy", "matplotlib", "xatlas", "pyoidn", "DracoPy")
    code = f"import sys, irradia.scene.load; print([m for m in {heavy} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
