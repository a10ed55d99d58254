/** Asks texts of shaders in WebGL2: a fragment for each question, answers in floats. */

/** A case of shader-cases.ts with its bytes at addresses of this page. */
export interface AskedCase {
  readonly name: string;
  readonly text: string;
  /** An expression of the five vec4s `column0` to `column4`. */
  readonly call: string;
  readonly textures: readonly {
    name: string;
    access: "load" | "linear";
    format: keyof typeof FORMATS;
    width: number;
    height: number;
    layers: number;
    file: string;
  }[];
  readonly uniforms: readonly { name: string; nVec4: number; file: string }[];
  /** Five vec4s a question. */
  readonly questions: string;
}

declare global {
  interface Window {
    /** By case, four floats an answer; a string where its shader wasn't compiled. */
    ask: (cases: readonly AskedCase[]) => Promise<(number[] | string)[]>;
  }
}

const COLUMNS = 5;
const VERTEX = `#version 300 es
void main() {
  gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0);
}`;

const gl = context();
const { RED_INTEGER, RG_INTEGER, RGBA_INTEGER, RGBA, RGB, UNSIGNED_INT, FLOAT, HALF_FLOAT } = gl;
const FORMATS = {
  r32uint: { internal: gl.R32UI, format: RED_INTEGER, type: UNSIGNED_INT, bits: Uint32Array },
  rg32uint: { internal: gl.RG32UI, format: RG_INTEGER, type: UNSIGNED_INT, bits: Uint32Array },
  rgba32uint: { internal: gl.RGBA32UI, format: RGBA_INTEGER, type: UNSIGNED_INT, bits: Uint32Array },
  rgba32float: { internal: gl.RGBA32F, format: RGBA, type: FLOAT, bits: Float32Array },
  rgb9e5ufloat: {
    internal: gl.RGB9_E5,
    format: RGB,
    type: gl.UNSIGNED_INT_5_9_9_9_REV,
    bits: Uint32Array,
  },
  rgba16float: { internal: gl.RGBA16F, format: RGBA, type: HALF_FLOAT, bits: Uint16Array },
} as const;

window.ask = async (cases) => {
  const answers: (number[] | string)[] = [];
  for (const asked of cases) answers.push(await answersOf(asked));
  return answers;
};

function context(): WebGL2RenderingContext {
  const found = document.createElement("canvas").getContext("webgl2");
  if (!found?.getExtension("EXT_color_buffer_float")) throw new Error("no WebGL2 with float targets here");
  return found;
}

async function answersOf(asked: AskedCase): Promise<number[] | string> {
  const program = compiled(fragment(asked));
  if (typeof program === "string") return program;
  gl.useProgram(program);
  const questions = new Float32Array(await bytes(asked.questions));
  const n = questions.length / (4 * COLUMNS);
  const unit = (index: number, name: string): void => {
    gl.activeTexture(gl.TEXTURE0 + index);
    gl.uniform1i(gl.getUniformLocation(program, name), index);
  };
  unit(0, "questions");
  const made: WebGLTexture[] = [texture2d(COLUMNS, n, questions)];
  for (const [i, planned] of asked.textures.entries()) {
    unit(1 + i, planned.name);
    made.push(textureArray(planned, await bytes(planned.file)));
  }
  for (const { name, file } of asked.uniforms) {
    gl.uniform4fv(gl.getUniformLocation(program, name), new Float32Array(await bytes(file)));
  }
  const answers = drawn(n);
  for (const texture of made) gl.deleteTexture(texture);
  gl.deleteProgram(program);
  const error = gl.getError();
  return error ? `WebGL error ${error}` : [...answers];
}

function fragment({ text, call, textures, uniforms }: AskedCase): string {
  const declared = textures.map(({ name, access, format }) => {
    const kind = format.endsWith("uint") ? "usampler2DArray" : "sampler2DArray";
    const sample = `vec4 ${name}_sample(vec2 uv, float layer) { return textureLod(${name}, vec3(uv, layer), 0.0); }`;
    return `uniform highp ${kind} ${name};\n${access === "linear" ? sample : ""}`;
  });
  const columns = Array.from(
    { length: COLUMNS },
    (_, i) => `vec4 column${i} = texelFetch(questions, ivec2(${i}, int(gl_FragCoord.x)), 0);`,
  );
  return `#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D questions;
out vec4 answer;
${declared.join("\n")}
${uniforms.map(({ name, nVec4 }) => `uniform vec4 ${name}[${nVec4}];`).join("\n")}
${text}
void main() {
  ${columns.join("\n  ")}
  answer = vec4(${call}, 1.0);
}`;
}

/** A program, or what the compiler says. */
function compiled(source: string): WebGLProgram | string {
  const program = gl.createProgram();
  for (const [type, text] of [
    [gl.VERTEX_SHADER, VERTEX],
    [gl.FRAGMENT_SHADER, source],
  ] as const) {
    const shader = gl.createShader(type);
    if (!shader) return "the context is lost";
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) return gl.getShaderInfoLog(shader) ?? "?";
    gl.attachShader(program, shader);
    gl.deleteShader(shader);
  }
  gl.linkProgram(program);
  const isLinked = gl.getProgramParameter(program, gl.LINK_STATUS);
  return isLinked ? program : (gl.getProgramInfoLog(program) ?? "?");
}

function texture2d(width: number, height: number, data: Float32Array | null): WebGLTexture {
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, width, height, 0, RGBA, FLOAT, data);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  return texture;
}

function textureArray(planned: AskedCase["textures"][number], data: ArrayBuffer): WebGLTexture {
  const { internal, format, type, bits } = FORMATS[planned.format];
  const { width, height, layers, access } = planned;
  const target = gl.TEXTURE_2D_ARRAY;
  const texture = gl.createTexture();
  gl.bindTexture(target, texture);
  gl.texImage3D(target, 0, internal, width, height, layers, 0, format, type, new bits(data));
  const filter = access === "linear" ? gl.LINEAR : gl.NEAREST;
  gl.texParameteri(target, gl.TEXTURE_MIN_FILTER, filter);
  gl.texParameteri(target, gl.TEXTURE_MAG_FILTER, filter);
  gl.texParameteri(target, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
  gl.texParameteri(target, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
  return texture;
}

/** A row of n pixels. */
function drawn(n: number): Float32Array {
  gl.activeTexture(gl.TEXTURE0 + gl.getParameter(gl.MAX_TEXTURE_IMAGE_UNITS) - 1);
  const target = texture2d(n, 1, null);
  const framebuffer = gl.createFramebuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, target, 0);
  gl.viewport(0, 0, n, 1);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
  const pixels = new Float32Array(4 * n);
  gl.readPixels(0, 0, n, 1, RGBA, FLOAT, pixels);
  gl.deleteFramebuffer(framebuffer);
  gl.deleteTexture(target);
  return pixels;
}

async function bytes(address: string): Promise<ArrayBuffer> {
  const response = await fetch(address);
  if (!response.ok) throw new Error(`${address}: ${response.status}`);
  return response.arrayBuffer();
}
