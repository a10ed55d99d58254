/** When a page's first picture is done. */
import type { PerspectiveCamera, WebGLRenderer } from "three";
import { cameraOf } from "../pixels/camera.js";
import type { View } from "../view.js";

declare global {
  interface Window {
    /** Set before the page's own scripts run. */
    view: View;
    /** Milliseconds since the page was asked for. */
    firstPictureMs?: number;
    /** Mean of its red, green and blue, so that nobody times a black picture. */
    firstPictureMean?: number;
  }
}

export function newCamera(): PerspectiveCamera {
  return cameraOf(window.view);
}

export function firstPicture(renderer: WebGLRenderer, draw: () => void): void {
  const { width, height } = window.view;
  renderer.setSize(width, height);
  document.body.append(renderer.domElement);
  draw();
  const gl = renderer.getContext();
  const pixels = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  window.firstPictureMs = performance.now();
  window.firstPictureMean =
    pixels.reduce((sum, value, i) => sum + (i % 4 < 3 ? value : 0), 0) / (3 * width * height);
}
