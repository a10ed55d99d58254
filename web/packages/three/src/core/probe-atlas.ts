/** A grid of our probes as the texture of three.js' LightProbeGrid. */
import { expect, type ProbeGrid, type Probes } from "@irradia/runtime";
import { Data3DTexture, DataUtils, HalfFloatType, LinearFilter, Vector3 } from "three";

const N_VOLUMES = 7;
const N_NUMBERS = 27;
const PADDING = 1;
const HALF_MAX = 65504;

/** What LightProbeGrid keeps: one cell a probe, the probe in its middle. */
export interface ProbeAtlas {
  readonly size: Vector3;
  readonly centre: Vector3;
  readonly shape: readonly [number, number, number];
  readonly texture: Data3DTexture;
}

/**
 * Seven volumes behind one another along z, each with its first and last slice repeated; together they hold 27
 * numbers a probe, nine coefficients of radiance times RGB. As `irradia.formats.three_probes` writes it.
 *
 * @throws InputError where the probes stand in no grid
 */
export function probeAtlas(probes: Probes): ProbeAtlas {
  const { structure } = probes;
  expect(
    structure?.kind === "grid",
    "expected probes in a grid",
    "probes",
    "Bake with --probes grid:SPACING.",
  );
  const { origin, spacing, shape } = structure;
  const size = new Vector3(...shape).multiply(new Vector3(...spacing));
  const centre = new Vector3(...origin)
    .addScaledVector(new Vector3(...spacing), -0.5)
    .addScaledVector(size, 0.5);
  return { size, centre, shape: [shape[0], shape[1], shape[2]], texture: atlasTexture(probes, structure) };
}

function atlasTexture(probes: Probes, { shape: [nx, ny, nz] }: ProbeGrid): Data3DTexture {
  const nSlices = nz + 2 * PADDING;
  const texels = new Uint16Array(4 * nx * ny * nSlices * N_VOLUMES);
  for (let volume = 0; volume < N_VOLUMES; volume++) {
    for (let slice = 0; slice < nSlices; slice++) {
      const z = Math.min(Math.max(slice - PADDING, 0), nz - 1);
      const first = 4 * nx * ny * (volume * nSlices + slice);
      for (let i = 0; i < nx * ny; i++)
        writeTexel(texels, first + 4 * i, probes, nx * ny * z + i, 4 * volume);
    }
  }
  const texture = new Data3DTexture(texels, nx, ny, nSlices * N_VOLUMES);
  texture.type = HalfFloatType;
  texture.minFilter = texture.magFilter = LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

/** Four of a probe's numbers. */
function writeTexel(texels: Uint16Array, at: number, probes: Probes, probe: number, first: number): void {
  for (let c = 0; c < 4 && first + c < N_NUMBERS; c++) {
    const bits = probes.coefficients[N_NUMBERS * probe + first + c] ?? 0;
    const value = DataUtils.fromHalfFloat(bits) * probes.scale;
    texels[at + c] = DataUtils.toHalfFloat(Math.min(Math.max(value, -HALF_MAX), HALF_MAX));
  }
}
