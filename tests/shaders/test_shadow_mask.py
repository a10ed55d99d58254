"""A shadow mask's channel is the share of its light that arrives."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from . import wrappers
from .cases import Questions, Shader
from .lavapipe import Lavapipe, spirv

SHADERS = Path(__file__).resolve().parents[2] / "shaders"
# The mask's texel is the tangent of a question, the channel its page.
ENTRIES = {
    "wgsl": """
fn irradia_light(mask: vec4f, channel: f32) -> vec3f { return vec3f(irradia_shadow(mask, i32(channel))); }""",
    "glsl": """
vec3 irradia_light(vec4 mask, float channel) { return vec3(irradia_shadow(mask, int(channel))); }""",
    "hlsl": """
float3 irradia_light(float4 mask, float channel) { return irradia_shadow(mask, int(channel)); }""",
}
CHANNELS = (-1, 0, 1, 2, 3)


@pytest.mark.parametrize("language", ENTRIES)
def test_each_light_reads_its_own_channel(language: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(5)
    masks = rng.random((len(CHANNELS), 4)).astype(np.float32)
    nothing = np.zeros((len(CHANNELS), 3))
    asked = Questions(nothing, nothing, nothing, masks, nothing[:, :2], np.array(CHANNELS))
    piece = (SHADERS / language / f"shadow-mask.{language}").read_text(encoding="utf-8")
    bound = {"directives": "", "textures": [], "uniforms": [], "inputs": ["tangent", "page"]}
    shader = Shader(tmp_path, {"texts": {language: piece + ENTRIES[language]}, **bound})
    code = getattr(wrappers, language)(shader, None)
    if language != "wgsl":
        code = spirv(code, language, tmp_path, "shadow-mask")
    found = Lavapipe().ask(shader, code, asked.packed())[:, 0]
    np.testing.assert_array_equal(found, [1.0, *masks[[1, 2, 3, 4], [0, 1, 2, 3]]])
