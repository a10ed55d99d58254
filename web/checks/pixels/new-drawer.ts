/** One renderer or the other. */
import type { View } from "../view.js";
import type { Drawer } from "./drawer.js";
import type { Backend } from "./request.js";
import { WebglDrawer } from "./webgl-drawer.js";
import { WebgpuDrawer } from "./webgpu-drawer.js";

export async function newDrawer(backend: Backend, { width, height }: View): Promise<Drawer> {
  if (backend === "webgl") return new WebglDrawer(width, height);
  return await WebgpuDrawer.create(backend, width, height);
}
