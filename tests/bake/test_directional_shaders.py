"""The shader code of docs/directional.md says what the reference says."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from irradia.bake.directional_modes import MODES, SurfaceFrame
from irradia.scene.tangents import RNM_BASIS

from .light_fields import AXES, BITANGENT, NORMAL, TANGENT, some_fields

TEXTURES = {
    "directionMap": "direction",
    "rnm0": "rnm_0",
    "rnm1": "rnm_1",
    "rnm2": "rnm_2",
    "shL0": "sh_l0",
    "shX": "sh_x",
    "shY": "sh_y",
    "shZ": "sh_z",
    "shDirection": "sh_direction",
}


class Vec3(np.ndarray):
    """Enough of GLSL's vector for the documented lines."""

    x = property(lambda self: float(self[0]))
    y = property(lambda self: float(self[1]))
    z = property(lambda self: float(self[2]))
    rgb = property(lambda self: self)


def vec3(*values) -> Vec3:
    return np.broadcast_to(np.array(values, np.float64), 3).copy().view(Vec3)


FUNCTIONS = {
    "vec3": vec3,
    "dot": lambda a, b: float(np.dot(a, b)),
    "length": lambda a: float(np.linalg.norm(a)),
    "sqrt": np.sqrt,
    "max": np.maximum,
    "min": np.minimum,
}


def shader(repo_root: Path, mode: str) -> str:
    """The code under a mode's heading as Python: declarations lose their types."""
    section = (repo_root / "docs" / "directional.md").read_text("utf-8").split(f"\n## {mode}\n")[1]
    code = section.split("```glsl\n")[1].split("```")[0]
    code = re.sub(r"//.*", "", code)
    return re.sub(r"^(?:vec3|float) (\w+ =.*?);\s*$", r"\1", code, flags=re.MULTILINE)


@pytest.mark.parametrize("mode", MODES)
def test_documented_shader_gives_what_the_reference_gives(repo_root, mode):
    code = shader(repo_root, mode)
    surface = SurfaceFrame(NORMAL, TANGENT, BITANGENT)
    for field in some_fields(6):
        plain = field.over_pi(NORMAL)[None]
        maps = MODES[mode].encode(plain, field.moments(MODES[mode].moments)[None], NORMAL[None])
        normal = np.array([0.4, -0.3, 0.8]) @ AXES / np.linalg.norm([0.4, -0.3, 0.8])
        known = {
            **FUNCTIONS,
            "n": vec3(*normal),
            "s": vec3(*NORMAL),
            "tangent": vec3(*TANGENT),
            "bitangent": vec3(*BITANGENT),
            "plain": vec3(*plain[0]),
            "uv": None,
            "texture": lambda name, _uv, maps=maps: vec3(*maps[TEXTURES[name]][0]),
            **{name: name for name in TEXTURES},
            **{f"b{k}": vec3(*axis) for k, axis in enumerate(RNM_BASIS)},
        }
        exec(code, known)
        expected = MODES[mode].irradiance_over_pi(plain, maps, normal, surface)[0]
        np.testing.assert_allclose(known["light"], expected, rtol=1e-6)
