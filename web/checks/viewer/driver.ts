/** Drives the viewer in a browser as a person would, and looks at what comes of it. */
import type { Page } from "playwright-core";

/** What the page offers to scripts; `web/viewer/src/main.ts` puts it there. */
interface Viewer {
  readonly ready: Promise<void>;
  readonly state: { readonly value: Record<string, unknown>; set(patch: Record<string, unknown>): void };
  readonly status: {
    readonly value: Readonly<Record<string, unknown>>;
    subscribe(listener: (now: { readonly isOpening: boolean }) => void): () => void;
  };
  picture(): Promise<Blob>;
  settled(): Promise<void>;
}

declare global {
  var irradiaViewer: Viewer;
}

/** What `<html data-…>` says. */
export type Told = Readonly<Record<string, string | undefined>>;

export class Driver {
  /** Everything that the page said on the console, and what it threw. */
  readonly complaints: string[] = [];

  constructor(
    readonly page: Page,
    readonly base: string,
  ) {
    page.on("console", (message) => this.complaints.push(`${message.type()}: ${message.text()}`));
    page.on("pageerror", (error) => this.complaints.push(String(error.stack)));
  }

  /** Opens the viewer anew. */
  async open(query: string): Promise<Told> {
    await this.page.goto("about:blank");
    await this.page.goto(`${this.base}${query}`);
    await this.page.waitForFunction("globalThis.irradiaViewer");
    await this.page.evaluate(() => irradiaViewer.ready);
    return this.told();
  }

  /** Drops files that are served under these addresses; waits until the page has made of them what it can. */
  drop(...addresses: string[]): Promise<Told> {
    return this.dropOneAfterAnother(addresses);
  }

  /** Drops some files, and others at once, without waiting for what becomes of the first. */
  async dropOneAfterAnother(...groups: string[][]): Promise<Told> {
    await this.page.evaluate(dropped, groups);
    await this.page.evaluate(() => irradiaViewer.settled());
    return this.told();
  }

  /** Drops a file or a folder of this machine, as a file manager does. */
  async dropPath(path: string): Promise<void> {
    const session = await this.page.context().newCDPSession(this.page);
    const data = { items: [], files: [path], dragOperationsMask: 1 };
    const waiting = this.page.evaluate(untilOpened);
    for (const type of ["dragEnter", "dragOver", "drop"] as const) {
      await session.send("Input.dispatchDragEvent", { type, x: 100, y: 100, data });
    }
    await waiting;
  }

  async set(patch: Record<string, unknown>): Promise<void> {
    await this.page.evaluate(async (wanted) => {
      irradiaViewer.state.set(wanted);
      await irradiaViewer.settled();
    }, patch);
  }

  async settled(): Promise<void> {
    await this.page.evaluate(() => irradiaViewer.settled());
  }

  /** The canvas as PNG, base64. */
  picture(): Promise<string> {
    return this.page.evaluate(async () => {
      const bytes = new Uint8Array(await (await irradiaViewer.picture()).arrayBuffer());
      return btoa(bytes.reduce((text, byte) => text + String.fromCharCode(byte), ""));
    });
  }

  told(): Promise<Told> {
    return this.page.evaluate(() => ({ ...document.documentElement.dataset }));
  }

  /** A key of the page's status that JSON can hold. */
  status(key: string): Promise<unknown> {
    return this.page.evaluate((name) => irradiaViewer.status.value[name], key);
  }

  state(): Promise<Record<string, unknown>> {
    return this.page.evaluate(() => irradiaViewer.state.value);
  }

  /** The words of all elements that match. */
  texts(selector: string): Promise<string[]> {
    return this.page.locator(selector).allInnerTexts();
  }
}

async function dropped(groups: string[][]): Promise<void> {
  const transfers: DataTransfer[] = [];
  for (const addresses of groups) {
    const transfer = new DataTransfer();
    for (const address of addresses) {
      const bytes = await (await fetch(address)).arrayBuffer();
      transfer.items.add(new File([bytes], address.split("/").at(-1) ?? address));
    }
    transfers.push(transfer);
  }
  let hasBegun = false;
  const done = new Promise<void>((resolve) => {
    const end = irradiaViewer.status.subscribe(({ isOpening }) => {
      hasBegun ||= isOpening;
      if (!hasBegun || isOpening) return;
      end();
      resolve();
    });
  });
  for (const dataTransfer of transfers) {
    const options = { dataTransfer, bubbles: true, cancelable: true };
    document.body.dispatchEvent(new DragEvent("dragenter", options));
    document.body.dispatchEvent(new DragEvent("drop", options));
  }
  await done;
}

/** Resolves when the page has begun to open something and is done with it. */
function untilOpened(): Promise<void> {
  return new Promise((resolve) => {
    let hasBegun = false;
    const end = irradiaViewer.status.subscribe(({ isOpening }) => {
      hasBegun ||= isOpening;
      if (!hasBegun || isOpening) return;
      end();
      resolve();
    });
  });
}
