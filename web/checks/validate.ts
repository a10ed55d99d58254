/**
 * Validates a .glb with Khronos' validator, and its IRRADIA_lighting objects with our JSON schemas.
 *
 *   node dist/checks/validate.js SCENE.glb SCHEMA_FOLDER
 *
 * Prints the validator's errors and warnings, and the schemas' complaints, as JSON.
 */
import { readdirSync, readFileSync } from "node:fs";
import path from "node:path";
import { Ajv2020 } from "ajv/dist/2020.js";
import validator from "gltf-validator";

const NAME = "IRRADIA_lighting";
const ROOT = "glTF.IRRADIA_lighting.schema.json";
const NODE = "node.IRRADIA_lighting.schema.json";

interface Extensible {
  extensions?: Record<string, unknown>;
}

function complaints(schemas: Ajv2020, id: string, holder: Extensible, pointer: string): string[] {
  const value = holder.extensions?.[NAME];
  if (value === undefined || schemas.validate(id, value)) return [];
  return (schemas.errors ?? []).map((e) => `${pointer}/extensions/${NAME}${e.instancePath}: ${e.message}`);
}

const [scene, folder] = process.argv.slice(2);
if (!scene || !folder) throw new Error("usage: validate.js SCENE.glb SCHEMA_FOLDER");
const bytes = readFileSync(scene);
const report = await validator.validateBytes(new Uint8Array(bytes), { maxIssues: 0 });
const schemas = new Ajv2020({ strict: true, strictRequired: false });
for (const file of readdirSync(folder).filter((name) => name.endsWith(".schema.json"))) {
  schemas.addSchema(JSON.parse(readFileSync(path.join(folder, file), "utf8")));
}
const document = JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12)).toString("utf8"));
const nodes: Extensible[] = document.nodes ?? [];
process.stdout.write(
  JSON.stringify({
    issues: report.issues.messages.filter((message) => message.severity < 2),
    complaints: [
      ...complaints(schemas, ROOT, document, ""),
      ...nodes.flatMap((node, index) => complaints(schemas, NODE, node, `/nodes/${index}`)),
    ],
  }),
);
