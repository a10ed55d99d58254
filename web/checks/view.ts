/** What a page is asked to draw; give one of `halfHeightM` (orthographic) and `yfovRad` (perspective). */
export interface View {
  width: number;
  height: number;
  /** Column by column; the camera looks along its −Z. */
  worldFromCamera: number[];
  halfHeightM?: number;
  yfovRad?: number;
}

/** What it hands back: linear RGBA, bottom row first. */
export interface Drawing {
  pixels: number[];
  nAnimations: number;
}
