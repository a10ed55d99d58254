import assert from "node:assert/strict";
import { test } from "node:test";
import { readField, readFieldBin } from "@irradia/runtime";
import { refuses, survives } from "./hostile.js";
import { type Entry, withAbout, withHeader } from "./safetensors-file.js";
import { decoder, vector } from "./vectors.js";

const unzstd = await decoder();
const grid = vector("hash-fp16").bytes;
const coded = vector("hash-int8").bytes;
const packed = vector("hash-int4-packed").bytes;
const bin = vector("hash-bin").bytes;

function entry(header: Record<string, unknown>, name: string): Entry {
  return header[name] as Entry;
}

function withWord(bytes: Uint8Array, at: number, value: number): Uint8Array {
  const copy = bytes.slice();
  new DataView(copy.buffer).setUint32(at, value, true);
  return copy;
}

test("a file cut short anywhere is refused", () => {
  for (const bytes of [grid, coded]) {
    for (let n = 0; n < bytes.length; n++) refuses(() => readField(bytes.subarray(0, n)), /./);
  }
  for (let n = 0; n < packed.length; n++) refuses(() => readField(packed.subarray(0, n), { unzstd }), /./);
});

test("a .bin cut short is refused, unless what is left is as long as another network", () => {
  // It says neither how many inputs it has nor outputs: without the padding of one of them it is whole again.
  const taken = Array.from(bin, (_, n) => n).filter((n) => survives(bin.subarray(0, n), readFieldBin));
  assert.deepEqual(
    taken.map((n) => bin.length - n),
    [2 * (8 * 3 + 9), 2 * 8 * 3, 2 * 9],
  );
});

test("a header longer than the file is refused", () => {
  const copy = grid.slice();
  new DataView(copy.buffer).setBigUint64(0, 0xffffffffffffffffn, true);
  refuses(() => readField(copy), /absurd/);
  new DataView(copy.buffer).setBigUint64(0, 1n << 40n, true);
  refuses(() => readField(copy), /header of 1099511627776 bytes/);
});

test("tensors that overlap, leave gaps or lie outside are refused", () => {
  const shifted = (by: number) => (header: Record<string, unknown>) => {
    const { data_offsets: offsets } = entry(header, "mlp.1.bias");
    entry(header, "mlp.1.bias").data_offsets = [offsets[0] + by, offsets[1] + by];
  };
  refuses(() => readField(withHeader(grid, shifted(-2))), /expected '.*' at \d+, found it at/);
  refuses(() => readField(withHeader(grid, shifted(2))), /expected '.*' at \d+, found it at/);
  refuses(() => readField(withHeader(grid, shifted(1 << 20))), /expected '.*' at \d+/);
  refuses(() => readField(withHeader(grid, shifted(-(1 << 20)))), /found -/);
});

test("bytes that belong to no tensor are refused", () => {
  refuses(() => readField(Uint8Array.of(...grid, 0, 0)), /expected \d+ bytes of tensors, found/);
});

test("counts too large for any file are refused before memory is asked for", () => {
  const shape = [2 ** 40, 2 ** 40];
  refuses(
    () => readField(withHeader(grid, (h) => Object.assign(entry(h, "mlp.0.bias"), { shape }))),
    /expected .* bytes/,
  );
  const huge = { type: "hash", n_levels: 32, log2_table_size: 28, n_features: 16 };
  refuses(
    () => readField(withAbout(grid, ({ spec }) => Object.assign(spec.position, huge))),
    /expected shape|missing/,
  );
  refuses(
    () =>
      readField(
        withAbout(coded, (about) => {
          about.quantised["position.level.0"].block = 2 ** 40;
        }),
      ),
    /block: expected a whole number/,
  );
});

test("numbers that aren't finite are refused", () => {
  const spoilt = (bytes: Uint8Array, fill: number[]): Uint8Array => {
    const copy = bytes.slice();
    copy.set(fill, copy.length - fill.length);
    return copy;
  };
  refuses(() => readField(spoilt(grid, [0x00, 0x7e])), /infinite or not numbers/);
  refuses(() => readField(spoilt(vector("hash-fp32").bytes, [0, 0, 0x80, 0x7f])), /infinite or not numbers/);
  refuses(() => readFieldBin(spoilt(bin, [0x00, 0x7c])), /infinite or not numbers/);
  refuses(() => readFieldBin(withWord(bin, 36, 0x7fc00000)), /expected a box/);
});

test("other files are refused by what they are", () => {
  refuses(
    () =>
      readField(
        withHeader(grid, (header) => {
          header.__metadata__ = { format: "pt" };
        }),
      ),
    /safetensors without 'irradia.field'/,
  );
  refuses(() => readField(new TextEncoder().encode("glTF is no field at all")), /./);
  refuses(() => readFieldBin(withWord(bin, 0, 3)), /0 to 2 as encoding, found 3/);
  refuses(() => readFieldBin(withWord(bin, 8, 100)), /tables of a power of two, found 100/);
  refuses(() => readFieldBin(withWord(bin, 24, 7)), /are no network/);
});

test("unknown keys are refused, and the nearest is named", () => {
  const renamed = withAbout(grid, ({ spec }) => {
    spec.position.n_level = spec.position.n_levels;
  });
  refuses(() => readField(renamed), /unknown key 'n_level'[\s\S]*Did you mean 'n_levels'\?/);
  refuses(
    () => readField(withAbout(grid, ({ spec }) => Object.assign(spec, { activation: "rely" }))),
    /'relu'/,
  );
});

test("missing, unknown and misshapen tensors are refused by name", () => {
  const rename = (header: Record<string, unknown>): void => {
    header["mlp.0.bias2"] = header["mlp.0.bias"];
    delete header["mlp.0.bias"];
  };
  refuses(() => readField(withHeader(grid, rename)), /'mlp.0.bias' is missing/);
  const transpose = (header: Record<string, unknown>): void =>
    void entry(header, "mlp.0.weight").shape.reverse();
  refuses(
    () => readField(withHeader(grid, transpose)),
    /mlp.0.weight: expected shape \(8,9\), found \(9,8\)/,
  );
  refuses(() => readField(withAbout(grid, ({ spec }) => Object.assign(spec, { n_hidden_layers: 1 }))), /./);
});

test("JSON that nests too deep is refused", () => {
  const deep = `${'{"type":"composite","parts":['.repeat(5000)}${"]}".repeat(5000)}`;
  const file = withHeader(grid, (header) => {
    header.__metadata__["irradia.field"] = deep;
  });
  refuses(() => readField(file), /nests over 128 deep/);
});

test("composites of many parts, or deep in each other, are refused", () => {
  const composite = (parts: unknown[]): unknown => ({ type: "composite", parts });
  const withPosition = (position: unknown) =>
    withAbout(grid, ({ spec }) => Object.assign(spec, { position }));
  const identity = { type: "identity" };
  refuses(
    () => readField(withPosition(composite(Array(17).fill(identity)))),
    /parts: expected 1 to 16 parts, found 17/,
  );
  refuses(() => readField(withPosition(composite([]))), /expected 1 to 16 parts, found 0/);
  let deep: unknown = identity;
  for (let i = 0; i < 4; i++) deep = composite([deep]);
  refuses(() => readField(withPosition(deep)), /at most 3 deep/);
});

test("keys that name an object's inner parts are keys like others", () => {
  const polluted = withHeader(grid, (header) => {
    header.__metadata__["irradia.field"] = '{"__proto__":{"version":1},"constructor":1}';
  });
  refuses(() => readField(polluted), /unknown key '__proto__'/);
  assert.equal("version" in {}, false);
});

test("a packed file says what is missing, and can't unpack without bounds", () => {
  refuses(() => readField(packed), /there is no decoder[\s\S]*zstddec/);
  refuses(() => readField(packed, { unzstd, maxBytes: 100 }), /at most 100 bytes unpacked/);
  const bomb = packed.slice();
  bomb.set([0xff, 0xff, 0xff, 0xff], 5);
  refuses(() => readField(bomb, { unzstd }), /./);
  refuses(() => readField(packed, { unzstd: () => new Uint8Array(3) }), /unpacked, found 3/);
  refuses(
    () =>
      readField(packed, {
        unzstd: () => {
          throw new Error("broken");
        },
      }),
    /can't be unpacked: broken/,
  );
});

test("a reader of a view at an odd address reads the same field", () => {
  const odd = new Uint8Array(coded.length + 1);
  odd.set(coded, 1);
  assert.deepEqual(readField(odd.subarray(1)).tensors, readField(coded).tensors);
});
