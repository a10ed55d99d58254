"""Runs compute shaders on Mesa's software Vulkan, which is the same on every machine."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from .cases import Shader
from .wrappers import GROUP

SETUP = "run `make setup-dev`"
_SAMPLED = {"rgba32float": "unfilterable-float", "rgb9e5ufloat": "float", "rgba16float": "float"}
# Compiling takes nearly all of the time: vectors of four lanes, no optimisation, and nothing left on disk.
_QUICK_TO_COMPILE = {
    "LP_NATIVE_VECTOR_WIDTH": "128",
    "GALLIVM_PERF": "nopt",
    "MESA_SHADER_CACHE_DISABLE": "true",
}
_TEXEL_BYTES = {
    "r32uint": 4,
    "rg32uint": 8,
    "rgba32uint": 16,
    "rgba32float": 16,
    "rgb9e5ufloat": 4,
    "rgba16float": 8,
}


def spirv(source: str, stage: str, folder: Path, name: str) -> bytes:
    """GLSL (stage ``glsl``) or HLSL (``hlsl``) compiled by glslang, whose complaints fail the test."""
    program = shutil.which("glslangValidator")
    if program is None:
        pytest.fail(f"glslangValidator is missing: {SETUP}")
    text, binary = folder / f"{name}.{stage}", folder / f"{name}.{stage}.spv"
    text.write_text(source, encoding="utf-8")
    language = ["-D", "-e", "main", "--hlsl-enable-16bit-types"] if stage == "hlsl" else []
    command = [program, *language, "-V", "--target-env", "vulkan1.1", "-S", "comp", "-o", binary, text]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False)
    if done.returncode:
        pytest.fail(f"{name} as {stage}: {done.stdout[-4000:]}{done.stderr[-1000:]}")
    return binary.read_bytes()


class Lavapipe:
    """The device. Fields that differ only in numbers share a pipeline."""

    def __init__(self) -> None:
        os.environ |= _QUICK_TO_COMPILE
        try:
            import wgpu
        except ImportError:
            pytest.fail(f"the Python package wgpu is missing: {SETUP}")
        adapters = wgpu.gpu.enumerate_adapters_sync()
        found = [a for a in adapters if "llvmpipe" in a.info["device"] and a.info["backend_type"] == "Vulkan"]
        if not found:
            pytest.fail(f"lavapipe is missing: {SETUP}")
        self._wgpu = wgpu
        self._device = found[0].request_device_sync(required_features=["shader-f16"])
        self._pipelines: dict[str | bytes, tuple] = {}

    def ask(self, shader: Shader, code: str | bytes, questions: np.ndarray) -> np.ndarray:
        """The answers (Q, 3) to questions (Q, 5, 4).

        Args:
            shader: What is bound.
            code: A whole shader of :mod:`wrappers`, as WGSL or as SPIR-V.
            questions: float32.
        """
        n_groups = -(-len(questions) // GROUP)
        padded = np.zeros((n_groups * GROUP, *questions.shape[1:]), np.float32)
        padded[: len(questions)] = questions
        usage = self._wgpu.BufferUsage
        asked = self._device.create_buffer_with_data(data=padded, usage=usage.STORAGE)
        answers = self._device.create_buffer(
            size=16 * len(padded), usage=usage.STORAGE | usage.COPY_SRC | usage.COPY_DST
        )
        resources = [
            ({"buffer": {"type": "storage"}}, {"buffer": asked}),
            ({"buffer": {"type": "storage"}}, {"buffer": answers}),
            ({"sampler": {"type": "filtering"}}, self._sampler()),
            *[self._texture(texture, shader.data(texture)) for texture in shader.textures],
            *[self._uniform(shader.data(uniform)) for uniform in shader.uniforms],
        ]
        self._dispatch(code, resources, n_groups)
        found = np.frombuffer(self._device.queue.read_buffer(answers), np.float32).reshape(-1, 4)
        assert (found[:, 3] == 1.0).all(), "some questions weren't answered"
        return found[: len(questions), :3].astype(np.float64)

    def _dispatch(self, code: str | bytes, resources: list, n_groups: int) -> None:
        if code not in self._pipelines:
            self._pipelines[code] = self._pipeline(code, [kind for kind, _ in resources])
        layout, pipeline = self._pipelines[code]
        group = self._device.create_bind_group(
            layout=layout,
            entries=[{"binding": i, "resource": resource} for i, (_, resource) in enumerate(resources)],
        )
        encoder = self._device.create_command_encoder()
        work = encoder.begin_compute_pass()
        work.set_pipeline(pipeline)
        work.set_bind_group(0, group)
        work.dispatch_workgroups(n_groups)
        work.end()
        self._device.queue.submit([encoder.finish()])

    def _pipeline(self, code: str | bytes, kinds: list[dict]) -> tuple:
        visible = self._wgpu.ShaderStage.COMPUTE
        layout = self._device.create_bind_group_layout(
            entries=[{"binding": i, "visibility": visible, **kind} for i, kind in enumerate(kinds)]
        )
        pipeline = self._device.create_compute_pipeline(
            layout=self._device.create_pipeline_layout(bind_group_layouts=[layout]),
            compute={"module": self._device.create_shader_module(code=code), "entry_point": "main"},
        )
        return layout, pipeline

    def _sampler(self) -> object:
        return self._device.create_sampler(mag_filter="linear", min_filter="linear")

    def _uniform(self, data: bytes) -> tuple[dict, object]:
        buffer = self._device.create_buffer_with_data(data=data, usage=self._wgpu.BufferUsage.UNIFORM)
        return {"buffer": {"type": "uniform"}}, {"buffer": buffer}

    def _texture(self, plan: dict, data: bytes) -> tuple[dict, object]:
        usage = self._wgpu.TextureUsage
        size = (plan["width"], plan["height"], plan["layers"])
        texture = self._device.create_texture(
            size=size, format=plan["format"], usage=usage.TEXTURE_BINDING | usage.COPY_DST
        )
        layout = {
            "bytes_per_row": plan["width"] * _TEXEL_BYTES[plan["format"]],
            "rows_per_image": plan["height"],
        }
        self._device.queue.write_texture({"texture": texture}, data, layout, size)
        kind = {"sample_type": _SAMPLED.get(plan["format"], "uint"), "view_dimension": "2d-array"}
        return {"texture": kind}, texture.create_view(dimension="2d-array")
