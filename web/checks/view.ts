/** What a page is asked to draw: an orthographic view, in metres. */
export interface View {
  width: number;
  height: number;
  eye: [number, number, number];
  target: [number, number, number];
  up: [number, number, number];
  halfHeight: number;
}

/** What it hands back: linear RGBA, bottom row first. */
export interface Drawing {
  pixels: number[];
  nAnimations: number;
}
