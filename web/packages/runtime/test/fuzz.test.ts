/** Random damage to every vector: each file is read, or refused with a clear error, whatever lies around it. */
import assert from "node:assert/strict";
import { test } from "node:test";
import { type Field, FieldEvaluator, packField, planFieldTextures, WEBGPU_LIMITS } from "@irradia/runtime";
import { corrupted, corruptedJson, survives } from "./hostile.js";
import { Random } from "./random.js";
import { putTogether, takeApart } from "./safetensors-file.js";
import { decoder, readAny, vectors } from "./vectors.js";

const ROUNDS = 120;
const MAX_BYTES = 1 << 20;
const unzstd = await decoder();

/** All that a field's file leads to, in numbers. */
function everything(field: Field): unknown {
  const light = new FieldEvaluator(field).irradiance([0.3, 1, 2], [0, 0.6, 0.8]);
  const { tables, constants } = packField(field, planFieldTextures(field, WEBGPU_LIMITS));
  return [light, tables.map((words) => [...words]), [...constants], field.frame];
}

for (const [index, { name, file, bytes }] of vectors().entries()) {
  const read = (data: Uint8Array): unknown =>
    everything(readAny(file, data, { unzstd, maxBytes: MAX_BYTES }));

  test(`${name} survives random bytes`, () => {
    const random = new Random(index);
    let refused = 0;
    for (let i = 0; i < ROUNDS; i++) refused += survives(corrupted(bytes, random), read) ? 0 : 1;
    assert.ok(refused > ROUNDS / 4, `only ${refused} of ${ROUNDS} were refused: the damage is too light`);
  });

  if (file.endsWith(".safetensors")) {
    test(`${name} survives hostile values in its JSON`, () => {
      const random = new Random(1000 + index);
      const parts = takeApart(bytes);
      const about = JSON.parse(parts.header.__metadata__["irradia.field"] ?? "");
      let refused = 0;
      for (let i = 0; i < ROUNDS; i++) {
        const inner = JSON.stringify(corruptedJson(about, random));
        const header = random.below(2)
          ? corruptedJson(parts.header, random)
          : { ...parts.header, __metadata__: { "irradia.field": inner } };
        refused += survives(putTogether({ header, data: parts.data }), read) ? 0 : 1;
      }
      assert.ok(refused > ROUNDS / 4, `only ${refused} of ${ROUNDS} were refused: the damage is too light`);
    });
  }
}
