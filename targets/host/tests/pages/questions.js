// What the browser's tests ask the page for. Each list is of faults: empty if all is well.

const settled = () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));

const about = (node) =>
  `<${node.tagName.toLowerCase()} ${node.className}> ${node.textContent.trim().slice(0, 40)}`;

const isSeen = (node) => node.checkVisibility() && node.getBoundingClientRect().width > 0;

// Draws plots that nobody has scrolled to yet.
async function drawAll() {
  plots.filter(({ u }) => !u).forEach(draw);
  await settled();
}

async function unfold(isOpen) {
  document.querySelectorAll("details").forEach((of) => (of.open = isOpen));
  await drawAll();
}

// A copy of a canvas to read from: reading from the page's own one often is a warning.
const copy = document.createElement("canvas").getContext("2d", { willReadFrequently: true });

// What a plot's canvas shows, as one number; 0 if nothing.
function inkOf({ u }) {
  const { width, height } = u.ctx.canvas;
  [copy.canvas.width, copy.canvas.height] = [width, height];
  copy.drawImage(u.ctx.canvas, 0, 0);
  const pixels = new Uint32Array(copy.getImageData(0, 0, width, height).data.buffer);
  let sum = 0;
  for (const pixel of pixels) sum = Math.imul(sum, 31) + pixel;
  return sum;
}

// Plots without a drawing.
const undrawn = () =>
  plots.filter((entry) => !entry.u || inkOf(entry) === 0).map(({ holder }) => holder.ariaLabel);

// Texts and boxes that cover each other or stick out of the window.
function faults() {
  const selector =
    "h1, h2, h3, h4, p, nav a, figcaption, .u-wrap, .u-series, .label, .legend li, summary, th, td, pre, .pane";
  const boxes = [...document.querySelectorAll(selector)].filter(isSeen);
  const found = [];
  if (document.documentElement.scrollWidth > innerWidth) {
    const isWide = (node) => node.getBoundingClientRect().right > innerWidth + 1;
    const isClipped = (node) => node.parentElement?.closest(".scroll, .pane, pre, .sheet, div.plot");
    const wide = [...document.querySelectorAll("body *")].filter((of) => isWide(of) && !isClipped(of));
    const names = wide.slice(0, 3).map(about).join(", ");
    found.push(`the page is ${document.documentElement.scrollWidth} wide: ${names}`);
  }
  // A text that is broken covers its lines, not the box around them.
  const pieces = boxes.flatMap((node) => {
    const scrolls = node.closest(".scroll, .pane, pre, .sheet");
    const rect = node.getBoundingClientRect();
    if (!scrolls && (rect.right > innerWidth + 1 || rect.left < -1)) found.push(`sticks out: ${about(node)}`);
    // What a box scrolls away covers nothing.
    const shown = scrolls && scrolls !== node ? scrolls.getBoundingClientRect() : { right: Infinity, bottom: Infinity };
    return [...node.getClientRects()].map(({ left, top, right, bottom }) => ({
      node, left, top, right: Math.min(right, shown.right), bottom: Math.min(bottom, shown.bottom),
    }));
  });
  const sorted = pieces.sort((a, b) => a.top - b.top);
  sorted.forEach((a, place) => {
    for (const b of sorted.slice(place + 1)) {
      if (b.top >= a.bottom - 1) break;
      const across = Math.min(a.right, b.right) - Math.max(a.left, b.left);
      const along = Math.min(a.bottom, b.bottom) - b.top;
      if (across <= 1 || along <= 1 || a.node.contains(b.node) || b.node.contains(a.node)) continue;
      found.push(`${about(a.node)} and ${about(b.node)}`);
    }
  });
  return found.slice(0, 10);
}

// Colours -----------------------------------------------------------------------------------------

function luminance(color) {
  const [red, green, blue] = color.match(/[\d.]+/g).map((value) => {
    const share = value / 255;
    return share <= 0.03928 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4;
  });
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
}

function groundOf(node) {
  for (let at = node; at; at = at.parentElement) {
    const ground = getComputedStyle(at).backgroundColor;
    if (!/, 0\)$|transparent/.test(ground)) return ground;
  }
  return "rgb(255, 255, 255)";
}

// The contrast of a text, faded as much as it and all around it are.
function contrastOf(node) {
  let opacity = 1;
  for (let at = node; at; at = at.parentElement) opacity *= getComputedStyle(at).opacity;
  const ground = groundOf(node);
  const [ink, behind] = [getComputedStyle(node).color, ground].map((color) => color.match(/[\d.]+/g).slice(0, 3));
  const faded = ink.map((value, k) => opacity * value + (1 - opacity) * behind[k]);
  const lights = [luminance(`rgb(${faded})`), luminance(ground)].sort((a, b) => a - b);
  return (lights[1] + 0.05) / (lights[0] + 0.05);
}

// Texts with less contrast than WCAG's 4.5 (3 for what is muted on purpose).
function faintTexts() {
  const nodes = [...document.querySelectorAll("h1, h2, h3, p, td, th, a, summary, figcaption, i, .label")];
  const faint = nodes.filter(isSeen).filter((node) => contrastOf(node) < 4);
  return faint.map(about).slice(0, 10);
}

// Names of lines and variants that are illegible while they are off, or look much as if they were on.
async function wrongWhenOff() {
  const names = [...document.querySelectorAll(`${TESTED.names}, ${TESTED.switches}`)].filter(isSeen);
  const wrong = [];
  for (const name of names) {
    const text = name.querySelector(".u-label, span");
    const contrasts = [];
    for (let click = 0; click < 2; click++) {
      name.click();
      await null;
      contrasts.push(contrastOf(text));
    }
    const [off, on] = contrasts.sort((a, b) => a - b);
    if (off < 3 || off > on / 2) wrong.push(`${about(name)}: ${off.toFixed(1)} and ${on.toFixed(1)}`);
  }
  return wrong.slice(0, 10);
}

const isDark = () =>
  luminance(groundOf(document.body)) < 0.05 && plots[0].u.axes[0].stroke() !== "#1f2328";

// Plots -------------------------------------------------------------------------------------------

function pointOf(plot, x, y) {
  const { over } = plots[plot].u;
  over.scrollIntoView({ block: "center", behavior: "instant" });
  const rect = over.getBoundingClientRect();
  return [rect.left + x * rect.width, rect.top + y * rect.height];
}

// What a plot says of the values below the mouse.
const told = (plot) => plots[plot].u.root.querySelector(".u-legend, .readout").innerText;

const scaleOf = (plot) => ["min", "max"].map((end) => Math.round(plots[plot].u.scales.x[end]));

// Labels of ticks that state another number than their place's.
function misstatedTicks() {
  const wrong = [];
  for (const { u, plot, holder } of plots) {
    for (const [k, { ticks }] of [plot.x, plot.y].entries()) {
      const { _splits: places, _values: labels } = u.axes[k];
      const isWrong = (label, at) =>
        label !== "" && Math.abs(label.replace("\u2212", "-") - places[at]) > 1e-3 * Math.abs(places[1] - places[0]);
      if (!ticks) wrong.push(...labels.filter(isWrong).map((label) => `${label} of ${holder.ariaLabel}`));
    }
  }
  return wrong.slice(0, 10);
}

// Texts on a plot's canvas, with the boxes that their ink covers. Their pixels are the page's: the
// tests' screen has one for each.
async function written({ u }) {
  const { ctx } = u;
  const texts = [];
  ctx.fillText = (text, x, y) => {
    const of = ctx.measureText(text);
    const ends = [
      [x - of.actualBoundingBoxLeft, y - of.actualBoundingBoxAscent],
      [x + of.actualBoundingBoxRight, y + of.actualBoundingBoxDescent],
    ];
    const [one, other] = ends.map(([x, y]) => ctx.getTransform().transformPoint({ x, y }));
    const [left, right] = [one.x, other.x].sort((a, b) => a - b);
    const [top, bottom] = [one.y, other.y].sort((a, b) => a - b);
    texts.push({ text, left, top, right, bottom });
  };
  u.redraw();
  await null;
  delete ctx.fillText;
  return texts;
}

// Titles and ticks of axes with less than two pixels between them, or cut at the edge of their plot.
async function crowdedAxes() {
  const crowded = [];
  for (const entry of plots) {
    const { u, plot, holder } = entry;
    const texts = (await written(entry)).filter(({ text }) => text !== "");
    const isNear = (a, b) =>
      a.left < b.right + 2 && b.left < a.right + 2 && a.top < b.bottom + 2 && b.top < a.bottom + 2;
    const isCut = (of) => of.left < 0 || of.top < 0 || of.right > u.width || of.bottom > u.height;
    const tell = (...of) => crowded.push(`${of.map(({ text }) => text).join(" and ")} of ${holder.ariaLabel}`);
    texts.forEach((a, place) => {
      if (isCut(a)) tell(a);
      texts.slice(place + 1).filter((b) => isNear(a, b)).forEach((b) => tell(a, b));
    });
    const titles = [plot.x, plot.y].filter(({ title }) => !texts.some(({ text }) => text === title));
    crowded.push(...titles.map(({ title }) => `no ${title} at ${holder.ariaLabel}`));
  }
  return crowded.slice(0, 10);
}

// Plots whose room was another one before they were drawn.
async function grownPlots() {
  const high = () => plots.map(({ holder }) => holder.getBoundingClientRect().height);
  const before = high();
  await drawAll();
  const after = high();
  const grown = plots.filter((_, k) => Math.abs(after[k] - before[k]) >= 0.5);
  return grown.map(({ holder }) => holder.ariaLabel).slice(0, 10);
}

// Names in legends that switch nothing, or leave the drawing as it was.
async function deadNames() {
  const dead = [];
  for (const entry of plots) {
    const { u, plot, holder } = entry;
    const drawn = inkOf(entry);
    for (const [k, of] of plot.series.entries()) {
      const name = u.root.querySelectorAll(".u-series")[k + 1]?.querySelector("th");
      const state = () => [u.series[k + 1].show, name?.getAttribute("aria-pressed")].join();
      const before = state();
      name?.click();
      await null;
      const [after, redrawn] = [state(), inkOf(entry)];
      name?.click();
      await null;
      const isDrawn = of.x.length > 0;
      if (before === after || state() !== before || (isDrawn && drawn === redrawn)) {
        dead.push(`${of.name} of ${holder.ariaLabel}`);
      }
    }
  }
  return dead;
}

// Bars of the page that are tall enough to be pointed at: plot, series and place.
const barsOfPage = () =>
  plots.flatMap(({ plot }, at) =>
    plot.bars.flatMap((of) => {
      const [low, high] = plot.y.range;
      const isTall = (k) => of.y[k] > low + 0.1 * (high - low);
      return of.x.map((_, k) => ({ at, of, k })).filter(({ k }) => isTall(k));
    }),
  ).filter((_, place) => place % 7 === 0);

// The window's point in the lower part of a bar.
function placeOfBar(bar) {
  const { at, of, k } = barsOfPage()[bar];
  const { u, plot } = plots[at];
  u.over.scrollIntoView({ block: "center", behavior: "instant" });
  const rect = u.over.getBoundingClientRect();
  const [low, high] = plot.y.range;
  const x = u.valToPos(of.x[k] + (of.ends[0] + of.ends[1]) / 2, "x");
  return [rect.left + x, rect.top + u.valToPos(low + 0.04 * (high - low), "y")];
}

// A bar below the mouse whose name is not marked alone, or whose value is not told.
function untoldOfBar(bar) {
  const { at, of, k } = barsOfPage()[bar];
  const { u, plot } = plots[at];
  const names = [...u.root.querySelectorAll(".u-series.below")].map((row) => row.innerText);
  const value = digits(of.y[k], plot.y);
  const isTold = names.length === 1 && names[0].includes(of.name) && names[0].includes(value);
  return isTold ? [] : [`${of.name} ${value}: ${names.join()}`];
}

// Other controls ----------------------------------------------------------------------------------

// Controls of each kind that a test presses.
const TESTED = {
  plots: ".u-over",
  names: ".u-series:not(:first-child) th",
  switches: "button[data-variant]",
  headings: "button.sort",
  links: ".linked button, .linked .line",
  details: "summary",
  anchors: "a[href^='#']",
};

const kindsOfControls = () =>
  Object.keys(TESTED).filter((kind) => document.querySelector(TESTED[kind]) != null);

const controls = () => [
  ...document.querySelectorAll("a, button, summary, input, select, textarea, [role=button], [tabindex]"),
];

// Controls of a kind that no test presses.
const untestedControls = () =>
  controls()
    .filter((of) => !of.matches(Object.values(TESTED).join()))
    .map(about);

// What looks as if it reacted to the mouse but that no key reaches.
const mouseOnly = () =>
  [...document.querySelectorAll("body *")]
    .filter((of) => getComputedStyle(of).cursor === "pointer" && isSeen(of))
    .filter((of) => !of.closest("a, button, summary, [tabindex]"))
    .map(about)
    .slice(0, 10);

// Controls that do not take the focus, or do not show it.
function unfocusable() {
  const found = controls().filter((of) => {
    if (!isSeen(of)) return false;
    of.focus({ focusVisible: true });
    const { outlineStyle, outlineWidth } = getComputedStyle(of);
    const isShown = outlineStyle !== "none" && parseFloat(outlineWidth) >= 1;
    return document.activeElement !== of || !isShown;
  });
  return found.map(about).slice(0, 10);
}

// What a key can change of the page.
const state = () =>
  JSON.stringify([
    plots.map(({ u }) => u.series.map((of) => of.show)),
    [...document.querySelectorAll(".linked-to")].map((of) => of.textContent),
  ]);

// Elements with the role of a button that Enter or the space bar does not press.
function deadKeys() {
  const dead = [];
  for (const control of document.querySelectorAll("[role=button]")) {
    for (const key of ["Enter", " "]) {
      document.querySelectorAll(".linked-to").forEach((of) => of.classList.remove("linked-to"));
      const before = state();
      const event = new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true });
      control.dispatchEvent(event);
      if (state() === before) dead.push(`${about(control)}, ${key}`);
    }
  }
  return dead.slice(0, 10);
}

// What of the page a switch can change.
const shown = () =>
  JSON.stringify([
    [...document.querySelectorAll("figure")].map((of) => of.hidden),
    plots.map(({ u }) => u.series.map((of) => of.show)),
  ]);

function deadSwitches() {
  const buttons = [...document.querySelectorAll("button[data-variant]")];
  return buttons
    .filter((button) => {
      const before = shown();
      button.click();
      const after = shown();
      const isOff = button.getAttribute("aria-pressed") === "false";
      button.click();
      return before === after || !isOff || shown() !== before;
    })
    .map(about);
}

// Headings whose click leaves their column unsorted, upwards or downwards.
function deadHeadings() {
  const buttons = [...document.querySelectorAll("button.sort")];
  return buttons
    .filter((button) => {
      const heading = button.closest("th");
      const { tBodies } = heading.closest("table");
      const rows = () => (tBodies.length > 1 ? [...tBodies].map((of) => of.rows[0]) : [...tBodies[0].rows]);
      const keys = () => rows().map((row) => keyOf(row, columnOf(heading)));
      const ascends = (all) => all.every((key, k) => k === 0 || compared(all[k - 1], key) <= 0);
      button.click();
      const isUp = ascends(keys());
      button.click();
      return !isUp || !ascends(keys().reverse());
    })
    .map(about);
}

// Fields, formulas and lines of formulas that mark nothing in another pane.
function deadLinks() {
  const box = document.querySelector(".linked");
  const dead = [];
  for (const control of box?.querySelectorAll("button, .line[role]") ?? []) {
    control.click();
    const panes = [...box.querySelectorAll(".pane")];
    const marked = panes.filter((pane) => pane.querySelector(".linked-to"));
    if (marked.length < 2 || !control.classList.contains("linked-to")) dead.push(about(control));
  }
  return dead;
}

// Texts that are marked after a click on the element with a text.
function linkedTo(selector, text) {
  const box = document.querySelector(".linked");
  [...box.querySelectorAll(selector)].find((node) => node.textContent.includes(text)).click();
  return marked();
}

const marked = () =>
  [...document.querySelectorAll(".linked-to")].map((node) => node.textContent.trim().slice(0, 60));

const markedPanes = () =>
  [...document.querySelectorAll(".pane")].map((pane) => pane.querySelector(".linked-to") != null);

function deadDetails() {
  return [...document.querySelectorAll("details")]
    .filter((details) => {
      const content = details.querySelector(":scope > :not(summary)");
      const before = details.open;
      details.querySelector("summary").click();
      const isDead = details.open === before || content.checkVisibility() !== details.open;
      details.open = before;
      return isDead;
    })
    .map(about);
}

const deadAnchors = () =>
  [...document.querySelectorAll("a[href^='#']")]
    .filter((link) => !document.getElementById(link.hash.slice(1)))
    .map(about);

// Waits until the page stands still for some frames.
async function scrolled() {
  for (let still = 0, before = scrollY; still < 6; still = scrollY === before ? still + 1 : 0) {
    before = scrollY;
    await settled();
  }
}

// A heading that its link of the navigation misses by more than a few pixels, from the top of the page,
// scrolling there or at once.
async function missedHeading(place, isSmooth) {
  const link = document.querySelectorAll("nav a")[place];
  document.documentElement.style.scrollBehavior = isSmooth ? "smooth" : "auto";
  scrollTo({ top: 0, behavior: "instant" });
  await settled();
  link.click();
  await scrolled();
  const { top } = document.querySelector(`${link.hash} h2`).getBoundingClientRect();
  return Math.abs(top) <= 4 ? [] : [`${about(link)}: ${Math.round(top)} pixels`];
}

// Tables -------------------------------------------------------------------------------------------

const wideTables = () =>
  [...document.querySelectorAll(".scroll")].filter((box) => box.scrollWidth > box.clientWidth + 1);

// Wide tables whose first column scrolls away, or leaves no room for two columns of figures.
function namelessRows() {
  const nameless = wideTables().filter((box) => {
    const names = box.querySelector("thead tr").cells[0];
    const rectOf = (of) => of.getBoundingClientRect();
    box.scrollLeft = box.scrollWidth;
    const isHeld = Math.abs(rectOf(names).left - rectOf(box).left) < 1;
    const figures = [...box.querySelectorAll("thead th.number")].sort((a, b) => rectOf(a).left - rectOf(b).left);
    if (figures.length > 0) box.scrollLeft += rectOf(figures[0]).left - rectOf(names).right;
    const isSeen = (of) => rectOf(of).left > rectOf(names).right - 2 && rectOf(of).right < rectOf(box).right + 2;
    const count = figures.filter(isSeen).length;
    box.scrollLeft = 0;
    return !isHeld || count < Math.min(2, figures.length);
  });
  return nameless.map(about);
}

// Words of rows' names that break.
function brokenWords() {
  const broken = [];
  for (const cell of document.querySelectorAll("tbody th, tbody td:first-child")) {
    const texts = document.createTreeWalker(cell, NodeFilter.SHOW_TEXT);
    while (texts.nextNode()) {
      for (const { 0: word, index } of texts.currentNode.data.matchAll(/[\p{L}\d_]+/gu)) {
        const range = document.createRange();
        range.setStart(texts.currentNode, index);
        range.setEnd(texts.currentNode, index + word.length);
        if (range.getClientRects().length > 1) broken.push(`${word} of ${about(cell)}`);
      }
    }
  }
  return broken.slice(0, 10);
}
