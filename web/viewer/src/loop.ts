/** Draws when something has changed, and only then; a picture at rest is then measured. */
import type { WebGPURenderer } from "three/webgpu";

/** Milliseconds without change after which a picture counts as at rest. */
const REST_MS = 250;
const LONGEST_STEP_S = 0.1;

export interface LoopOptions {
  readonly renderer: WebGPURenderer;
  /** Frames after which what was asked for is on the canvas. */
  readonly nFramesToSettle: number;
  /** @returns whether more is to come in the next frame */
  readonly move: (seconds: number) => boolean;
  readonly draw: () => void;
  /** What takes time, and needs a picture that stands still. */
  readonly measure: () => Promise<void>;
  readonly onTime: (gpuMs: number | undefined, cpuMs: number) => void;
  readonly onError: (error: unknown) => void;
}

export class Loop {
  readonly #options: LoopOptions;
  #isDirty = true;
  #isStopped = false;
  /** Counts changes; a picture of the change in `#measured` has been measured. */
  #change = 0;
  #measured = -1;
  #isTiming = false;
  #isMeasuring = false;
  #changedAt = 0;
  #lastAt = 0;
  #nDrawn = 0;
  #waiting: (() => void)[] = [];

  constructor(options: LoopOptions) {
    this.#options = options;
    requestAnimationFrame((now) => this.#tick(now));
  }

  /** Whether the picture on the canvas is what was last asked for. */
  get isDrawn(): boolean {
    return !this.#isDirty && this.#nDrawn > 0;
  }

  /** Draws again at the next frame. */
  invalidate(): void {
    this.#isDirty = true;
    this.#change += 1;
    this.#changedAt = performance.now();
  }

  /** Resolves when frames have been drawn from now on and the picture has been measured. */
  async settled(): Promise<void> {
    this.invalidate();
    const until = this.#nDrawn + this.#options.nFramesToSettle;
    await new Promise<void>((resolve) => {
      const check = (): void => {
        if (this.#isStopped) resolve();
        else if (this.#nDrawn < until) {
          this.#isDirty = true;
          this.#waiting.push(check);
        } else if (this.#measured === this.#change) resolve();
        else this.#waiting.push(check);
      };
      check();
    });
  }

  stop(): void {
    this.#isStopped = true;
    this.#wake();
  }

  #tick(now: number): void {
    if (this.#isStopped) return;
    requestAnimationFrame((next) => this.#tick(next));
    const seconds = Math.min((now - this.#lastAt) / 1000, LONGEST_STEP_S);
    this.#lastAt = now;
    try {
      if (this.#options.move(seconds)) this.invalidate();
      if (this.#isDirty) this.#draw();
      else if (this.#isDue()) void this.#measure();
    } catch (error) {
      this.#measured = this.#change;
      this.#options.onError(error);
    }
    this.#wake();
  }

  #draw(): void {
    this.#isDirty = false;
    const start = performance.now();
    this.#nDrawn += 1;
    this.#options.draw();
    void this.#time(performance.now() - start);
  }

  #isDue(): boolean {
    const isAtRest = performance.now() - this.#changedAt > REST_MS;
    return this.#measured !== this.#change && !this.#isMeasuring && isAtRest;
  }

  async #measure(): Promise<void> {
    const change = this.#change;
    this.#isMeasuring = true;
    try {
      await this.#options.measure();
    } catch (error) {
      if (!this.#isStopped) this.#options.onError(error);
    }
    this.#measured = change;
    this.#isMeasuring = false;
  }

  /** Reads the GPU's clock; three.js forgets queries that nobody reads, with a warning. */
  async #time(cpuMs: number): Promise<void> {
    const { renderer, onTime } = this.#options;
    if (!(renderer.backend as { trackTimestamp?: boolean }).trackTimestamp) return onTime(undefined, cpuMs);
    if (this.#isTiming) return;
    this.#isTiming = true;
    const gpuMs = await renderer.resolveTimestampsAsync("render").catch(() => undefined);
    this.#isTiming = false;
    if (!this.#isStopped) onTime(gpuMs || undefined, cpuMs);
  }

  #wake(): void {
    const waiting = this.#waiting;
    this.#waiting = [];
    for (const check of waiting) check();
  }
}
