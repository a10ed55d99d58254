"use strict";

const MAX_ZOOM = 32;
const PIXELS_FROM_ZOOM = 3; // from here on single pixels are shown, not smoothed

/** One stage: layers that share a view (zoom and pan) and a dividing line between two of them. */
function setUpStage(section) {
  const stage = section.querySelector(".stage");
  const divider = section.querySelector(".divider");
  const buttons = [...section.querySelectorAll("[data-show]")];
  const baked = stage.querySelector('[data-layer="baked"]');
  const reference = stage.querySelector('[data-layer="reference"]');
  const view = { zoom: 1, x: 0, y: 0 }; // screen = picture * zoom + (x, y)
  let split = 0.5; // of the stage's width
  let drag = null;

  function draw() {
    const { width } = stage.getBoundingClientRect();
    stage.style.setProperty("--view", `translate(${view.x}px, ${view.y}px) scale(${view.zoom})`);
    stage.style.setProperty("--split", `${split * 100}%`);
    stage.classList.toggle("pixels", view.zoom >= PIXELS_FROM_ZOOM);
    divider.setAttribute("aria-valuenow", Math.round(split * 100));
    // The cut stands still on the screen while the pictures move below it.
    const cut = (split * width - view.x) / view.zoom;
    const cuts = stage.dataset.mode === "slider";
    baked.style.clipPath = cuts ? `inset(0 ${Math.max(width - cut, 0)}px 0 0)` : "";
    reference.style.clipPath = cuts ? `inset(0 0 0 ${Math.max(cut, 0)}px)` : "";
  }

  function show(mode) {
    stage.dataset.mode = mode;
    for (const button of buttons) button.setAttribute("aria-pressed", button.dataset.show === mode);
    draw();
  }

  function moveSplit(to) {
    split = Math.min(Math.max(to, 0), 1);
    draw();
  }

  function keepInside() {
    const { width, height } = stage.getBoundingClientRect();
    view.x = Math.min(0, Math.max(view.x, width * (1 - view.zoom)));
    view.y = Math.min(0, Math.max(view.y, height * (1 - view.zoom)));
  }

  function zoomAbout(x, y, factor) {
    const zoom = Math.min(Math.max(view.zoom * factor, 1), MAX_ZOOM);
    view.x = x - ((x - view.x) * zoom) / view.zoom;
    view.y = y - ((y - view.y) * zoom) / view.zoom;
    view.zoom = zoom;
    keepInside();
    draw();
  }

  stage.addEventListener("wheel", (event) => {
    event.preventDefault();
    const box = stage.getBoundingClientRect();
    zoomAbout(event.clientX - box.left, event.clientY - box.top, Math.exp(-event.deltaY * 0.0015));
  }, { passive: false });

  stage.addEventListener("dblclick", () => {
    Object.assign(view, { zoom: 1, x: 0, y: 0 });
    draw();
  });

  stage.addEventListener("pointerdown", (event) => {
    const slides = event.target === divider || (view.zoom === 1 && stage.dataset.mode === "slider");
    drag = { slides, x: event.clientX - view.x, y: event.clientY - view.y };
    stage.setPointerCapture(event.pointerId);
    stage.classList.toggle("panning", !slides);
    if (slides) slideTo(event);
  });

  function slideTo(event) {
    const box = stage.getBoundingClientRect();
    moveSplit((event.clientX - box.left) / box.width);
  }

  stage.addEventListener("pointermove", (event) => {
    if (!drag) return;
    if (drag.slides) return slideTo(event);
    view.x = event.clientX - drag.x;
    view.y = event.clientY - drag.y;
    keepInside();
    draw();
  });

  for (const end of ["pointerup", "pointercancel"]) {
    stage.addEventListener(end, () => {
      drag = null;
      stage.classList.remove("panning");
    });
  }

  stage.addEventListener("keydown", (event) => {
    const step = event.shiftKey ? 0.1 : 0.01;
    if (event.key === "ArrowLeft") moveSplit(split - step);
    else if (event.key === "ArrowRight") moveSplit(split + step);
    else return;
    event.preventDefault();
  });

  for (const image of section.querySelectorAll("[data-copy]")) {
    image.src = stage.querySelector(`[data-layer="${image.dataset.copy}"]`).src;
  }
  for (const button of buttons) button.addEventListener("click", () => show(button.dataset.show));
  new ResizeObserver(() => { keepInside(); draw(); }).observe(stage);
  draw();
  return { section, buttons };
}

const stages = [...document.querySelectorAll(".comparison")].map(setUpStage);

/** Number keys act on the view nearest to the middle of the window. */
document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || !/^[1-9]$/.test(event.key) || !stages.length) return;
  const middle = innerHeight / 2;
  const distance = ({ section }) => {
    const box = section.getBoundingClientRect();
    return Math.abs((box.top + box.bottom) / 2 - middle);
  };
  const nearest = stages.reduce((a, b) => (distance(b) < distance(a) ? b : a));
  nearest.buttons[Number(event.key) - 1]?.click();
});

/** The viewer takes the place of the button that asks for it. */
for (const live of document.querySelectorAll("[data-live]")) {
  const button = live.querySelector("button");
  button.addEventListener("click", () => {
    const frame = document.createElement("iframe");
    Object.assign(frame, { src: live.dataset.live, title: "Live view", allow: "fullscreen" });
    button.replaceWith(frame);
    frame.focus();
  });
}

/** A click on a heading sorts its table by that column; another turns the order round. */
for (const table of document.querySelectorAll("table.sortable")) {
  const headings = [...table.querySelectorAll("th")];
  const body = table.tBodies[0];
  table.querySelector("thead").addEventListener("click", (event) => {
    const button = event.target.closest("button");
    if (!button) return;
    const column = Number(button.dataset.column);
    const heading = headings[column];
    const falling = heading.getAttribute("aria-sort") === "ascending";
    for (const each of headings) each.removeAttribute("aria-sort");
    heading.setAttribute("aria-sort", falling ? "descending" : "ascending");
    const value = (row) => row.cells[column].dataset.value ?? "";
    const order = (a, b) => value(a).localeCompare(value(b), undefined, { numeric: true });
    const numbers = (a, b) => Number(value(a)) - Number(value(b));
    const rows = [...body.rows];
    const compare = rows.every((row) => Number.isFinite(Number(value(row)))) ? numbers : order;
    rows.sort((a, b) => (falling ? compare(b, a) : compare(a, b)));
    body.append(...rows);
  });
}

const lightbox = document.getElementById("lightbox");
for (const image of document.querySelectorAll(".page img, .pair img")) {
  image.addEventListener("click", () => {
    lightbox.querySelector("img").src = image.src;
    lightbox.showModal();
  });
}
lightbox.addEventListener("click", () => lightbox.close());

document.getElementById("theme").addEventListener("click", () => {
  const root = document.documentElement;
  const dark = root.dataset.theme
    ? root.dataset.theme === "dark"
    : matchMedia("(prefers-color-scheme: dark)").matches;
  root.dataset.theme = dark ? "light" : "dark";
});
