/** Looking about with the pointer, and which way the keys want to go; fly and walk share it. */

/** What the hands asked for since the last frame. */
export interface Wish {
  /** Radians to the left, and up. */
  readonly yaw: number;
  readonly pitch: number;
  /** Right, up and forward, each −1 … 1, times `speed`: for as long as the frame lasts. */
  readonly move: readonly [number, number, number];
  /** The same in seconds of moving: how far a hand went, whatever the time it took. */
  readonly stride: readonly [number, number, number];
  readonly speed: number;
}

const RAD_PER_PX = 0.004;
const STRIDE_S_PER_PX = 0.012;
/** Of `PointerEvent.button`. */
const RIGHT_BUTTON = 2;
const FAST = 4;
const KEYS: Readonly<Record<string, readonly [axis: 0 | 1 | 2, sign: 1 | -1]>> = {
  KeyW: [2, 1],
  ArrowUp: [2, 1],
  KeyS: [2, -1],
  ArrowDown: [2, -1],
  KeyD: [0, 1],
  ArrowRight: [0, 1],
  KeyA: [0, -1],
  ArrowLeft: [0, -1],
  KeyE: [1, 1],
  KeyQ: [1, -1],
};

export class Look {
  readonly #held = new Set<string>();
  readonly #pointers = new Map<number, { x: number; y: number; strides: boolean }>();
  readonly #end = new AbortController();
  readonly #onInput: () => void;
  #yaw = 0;
  #pitch = 0;
  #stride: [number, number, number] = [0, 0, 0];
  #isFast = false;

  /** @param onInput told whenever there is something to do in the next frame */
  constructor(element: HTMLElement, onInput: () => void) {
    this.#onInput = onInput;
    const { signal } = this.#end;
    element.addEventListener("pointerdown", (event) => this.#down(element, event), { signal });
    element.addEventListener("pointermove", (event) => this.#move(event), { signal });
    for (const end of ["pointerup", "pointercancel"] as const) {
      element.addEventListener(end, (event) => this.#pointers.delete(event.pointerId), { signal });
    }
    element.addEventListener("contextmenu", (event) => event.preventDefault(), { signal });
    window.addEventListener("keydown", (event) => this.#key(event, true), { signal });
    window.addEventListener("keyup", (event) => this.#key(event, false), { signal });
    window.addEventListener("blur", () => this.#held.clear(), { signal });
  }

  /** Whether a key is held, so that frames go on. */
  get isMoving(): boolean {
    return this.#held.size > 0;
  }

  /** Hands over what has come together, and begins anew. */
  take(): Wish {
    const move: [number, number, number] = [0, 0, 0];
    for (const code of this.#held) {
      const [axis, sign] = KEYS[code] ?? [0, 1];
      move[axis] += sign;
    }
    const [yaw, pitch, stride] = [this.#yaw, this.#pitch, this.#stride];
    [this.#yaw, this.#pitch, this.#stride] = [0, 0, [0, 0, 0]];
    return { yaw, pitch, move, stride, speed: this.#isFast ? FAST : 1 };
  }

  dispose(): void {
    this.#end.abort();
  }

  #down(element: HTMLElement, event: PointerEvent): void {
    const strides = event.button === RIGHT_BUTTON;
    this.#pointers.set(event.pointerId, { x: event.clientX, y: event.clientY, strides });
    element.setPointerCapture(event.pointerId);
  }

  /** One finger or the mouse looks, two fingers or its right button walk. */
  #move(event: PointerEvent): void {
    const last = this.#pointers.get(event.pointerId);
    if (!last) return;
    const [dx, dy] = [event.clientX - last.x, event.clientY - last.y];
    this.#pointers.set(event.pointerId, { ...last, x: event.clientX, y: event.clientY });
    if (this.#pointers.size === 1 && !last.strides) {
      this.#yaw += dx * RAD_PER_PX;
      this.#pitch += dy * RAD_PER_PX;
    } else {
      const share = STRIDE_S_PER_PX / this.#pointers.size; // each finger reports its own way
      this.#stride[0] -= dx * share;
      this.#stride[2] += dy * share;
    }
    this.#onInput();
  }

  #key(event: KeyboardEvent, isDown: boolean): void {
    this.#isFast = event.shiftKey;
    if (!(event.code in KEYS)) return;
    if (!isDown) this.#held.delete(event.code);
    else if (!isForControl(event)) {
      this.#held.add(event.code);
      event.preventDefault();
      this.#onInput();
    }
  }
}

/** Take letters, and arrows; take arrows alone. */
const TYPED = "select, textarea, [contenteditable], input:not([type='radio'], [type='range'])";
const STEPPED = "input, [role='slider']";

/** Whether a key belongs to a control of the page, or to the browser. */
export function isForControl(event: KeyboardEvent): boolean {
  if (event.ctrlKey || event.metaKey || event.altKey) return true;
  if (!(event.target instanceof Element)) return false;
  return event.target.closest(event.key.startsWith("Arrow") ? `${TYPED}, ${STEPPED}` : TYPED) !== null;
}
