import { TriPlane } from "../../field/encodings/tri-plane.js";
import type { TableTexture } from "../field-textures.js";
import { type EncodingShader, featuresPerTexel, scalesOf, tableOf } from "./encoding-shader.js";

export const triPlaneShader: EncodingShader<TriPlane> = {
  type: TriPlane.type,
  piece: "tri-plane",
  function: "irradia_table_tri_plane",
  record(planes, place) {
    const table = tableOf(place);
    const { scale, offset } = planes.texelFromUnit;
    const [first, shift] = scalesOf(table, 0, place.firstScale);
    const perPlane = scalesPerPlane(planes, table);
    return [
      [place.firstColumn, planes.nFeatures, featuresPerTexel(table), table.entry.texelsPerEntry],
      [scale, offset, planes.resolution, 0],
      [first, first + perPlane, first + 2 * perPlane, shift],
    ];
  },
  /** Four texels on each of three planes. */
  cost({ nFeatures }, place) {
    const values = 12 * nFeatures;
    return { flops: 2 * values + 3 * 4, fetches: 12 * tableOf(place).entry.texelsPerEntry };
  },
};

/** Blocks don't straddle planes; a block of several planes is the only one. */
function scalesPerPlane({ resolution, nFeatures }: TriPlane, table: TableTexture): number {
  const block = table.tensors[0]?.block;
  return block ? Math.floor((resolution * resolution * nFeatures) / block) : 0;
}
