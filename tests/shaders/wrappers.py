"""Whole compute shaders around texts that have no bindings and no entry point of their own.

Binding 0 holds the questions, five vec4s each, 1 the answers, 2 a sampler; textures follow, then uniforms.
"""

from __future__ import annotations

from typing import Any

from .cases import N_COLUMNS, Shader

GROUP = 64


def wgsl(shader: Shader, view: str | None) -> str:
    """In WGSL."""
    lines = [
        f"@group(0) @binding(0) var<storage, read_write> questions: array<array<vec4f, {N_COLUMNS}>>;",
        "@group(0) @binding(1) var<storage, read_write> answers: array<vec4f>;",
        "@group(0) @binding(2) var linear_sampler: sampler;",
    ]
    for binding, texture in enumerate(shader.textures, 3):
        kind = "u32" if _is_whole(texture) else "f32"
        lines.append(f"@group(0) @binding({binding}) var {texture['name']}: texture_2d_array<{kind}>;")
        if texture["access"] == "linear":
            lines.append(
                f"fn {texture['name']}_sample(uv: vec2f, layer: f32) -> vec4f {{ return "
                f"textureSampleLevel({texture['name']}, linear_sampler, uv, i32(layer), 0.0); }}"
            )
    for binding, uniform in enumerate(shader.uniforms, 3 + len(shader.textures)):
        array = f"array<vec4f, {uniform['nVec4']}>"
        lines.append(f"@group(0) @binding({binding}) var<uniform> {uniform['name']}: {array};")
    call = shader.call(view, lambda i: f"questions[id.x][{i}]")
    return shader.json["directives"] + "\n".join(
        [
            *lines,
            shader.text("wgsl"),
            f"@compute @workgroup_size({GROUP}) fn main(@builtin(global_invocation_id) id: vec3u) {{",
            "    if (id.x < arrayLength(&answers)) {",
            f"        answers[id.x] = vec4f({call}, 1.0);",
            "    }",
            "}",
        ]
    )


def glsl(shader: Shader, view: str | None) -> str:
    """In Vulkan's GLSL, which knows all of GLSL ES 3.00 but its combined samplers."""
    lines = [
        "#version 450",
        "#extension GL_EXT_samplerless_texture_functions : require",
        f"layout(local_size_x = {GROUP}) in;",
        "layout(set = 0, binding = 0, std430) buffer Questions { vec4 questions[]; };",
        "layout(set = 0, binding = 1, std430) buffer Answers { vec4 answers[]; };",
        "layout(set = 0, binding = 2) uniform sampler linear_sampler;",
    ]
    for binding, texture in enumerate(shader.textures, 3):
        prefix = "u" if _is_whole(texture) else ""
        lines.append(
            f"layout(set = 0, binding = {binding}) uniform {prefix}texture2DArray {texture['name']};"
        )
        if texture["access"] == "linear":
            sampler = f"sampler2DArray({texture['name']}, linear_sampler)"
            lines.append(
                f"vec4 {texture['name']}_sample(vec2 uv, float layer) "
                f"{{ return textureLod({sampler}, vec3(uv, layer), 0.0); }}"
            )
    for binding, uniform in enumerate(shader.uniforms, 3 + len(shader.textures)):
        block = f"layout(set = 0, binding = {binding}, std140) uniform {uniform['name']}_block"
        lines.append(f"{block} {{ vec4 {uniform['name']}[{uniform['nVec4']}]; }};")
    return "\n".join([*lines, shader.text("glsl"), "void main() {", *_body(shader, view, "vec4"), "}"])


def hlsl(shader: Shader, view: str | None) -> str:
    """In HLSL of shader model 5."""
    lines = [
        "[[vk::binding(0, 0)]] RWStructuredBuffer<float4> questions : register(u0);",
        "[[vk::binding(1, 0)]] RWStructuredBuffer<float4> answers : register(u1);",
        "[[vk::binding(2, 0)]] SamplerState linear_sampler : register(s0);",
    ]
    for index, texture in enumerate(shader.textures):
        kind = "uint4" if _is_whole(texture) else "float4"
        at = f"[[vk::binding({3 + index}, 0)]]"
        lines.append(f"{at} Texture2DArray<{kind}> {texture['name']} : register(t{index});")
        if texture["access"] == "linear":
            lines.append(
                f"float4 {texture['name']}_sample(float2 uv, float layer) "
                f"{{ return {texture['name']}.SampleLevel(linear_sampler, float3(uv, layer), 0.0); }}"
            )
    for index, uniform in enumerate(shader.uniforms):
        at = f"[[vk::binding({3 + len(shader.textures) + index}, 0)]]"
        block = f"cbuffer {uniform['name']}_block : register(b{index})"
        lines.append(f"{at} {block} {{ float4 {uniform['name']}[{uniform['nVec4']}]; }}")
    body = _body(shader, view, "float4")
    main = f"[numthreads({GROUP}, 1, 1)] void main(uint3 gl_GlobalInvocationID : SV_DispatchThreadID) {{"
    return "\n".join([*lines, shader.text("hlsl"), main, *body, "}"])


def webgl2(shader: Shader, view: str | None, questions: str) -> dict[str, Any]:
    """A case of web/checks/shaders-page.ts, which wraps it there; ``questions`` is a file of vec4s."""
    call = shader.call(view, lambda i: f"column{i}")
    bound = {"textures": shader.textures, "uniforms": shader.uniforms}
    return {"text": shader.text("glsl"), "call": call, **bound, "questions": questions}


def _body(shader: Shader, view: str | None, vec4: str) -> list[str]:
    """The answer to a question; the last groups ask some that nobody reads."""
    call = shader.call(view, lambda i: f"questions[{N_COLUMNS} * int(gl_GlobalInvocationID.x) + {i}]")
    return [f"    answers[gl_GlobalInvocationID.x] = {vec4}({call}, 1.0);"]


def _is_whole(texture: dict) -> bool:
    return texture["format"].endswith("uint")
