// The page's controls: plots (drawn by uPlot), switches of variants, tables that sort.
"use strict";

// Keyboard ----------------------------------------------------------------------------------------

// Whether a key presses a button.
const presses = ({ key }) => key === "Enter" || key === " ";

// Makes an element that reacts to clicks a button for the keyboard, too.
function pressable(node) {
  node.tabIndex = 0;
  node.setAttribute("role", "button");
  node.addEventListener("keydown", (event) => {
    if (!presses(event)) return;
    event.preventDefault();
    node.click();
  });
}

// Where a key leads from a place among `count` ones.
function led(key, place, count) {
  const to = { ArrowUp: place - 1, ArrowDown: place + 1, Home: 0, End: count - 1 }[key];
  return to == null ? undefined : Math.max(0, Math.min(count - 1, to));
}

// One of many controls is a stop of the tab key, from which the arrow keys lead to the others.
function oneStop(controls) {
  controls.forEach((node, place) => {
    node.tabIndex = place === 0 ? 0 : -1;
    node.addEventListener("focus", () => {
      controls.forEach((other) => (other.tabIndex = other === node ? 0 : -1));
    });
    node.addEventListener("keydown", (event) => {
      const to = led(event.key, place, controls.length);
      if (to == null) return;
      event.preventDefault();
      controls[to].focus();
    });
  });
}

// Plots -------------------------------------------------------------------------------------------

// Steps of the grid on which points stand (plot.rs).
const GRID = 4096;
// Height of a row of marks above a plot, and of the text in it, in pixels.
const ROW = 17;
const FONT = "12px system-ui, sans-serif";
// Indices of the variants that are switched off.
const off = new Set();
// Plots with their elements, in the order of the page.
const plots = [];

const dark = matchMedia("(prefers-color-scheme: dark)");

// Measures texts as plots write them.
const pen = document.createElement("canvas").getContext("2d");
pen.font = FONT;
const widthOf = (text) => pen.measureText(text).width;

// A colour of the data in the scheme of the page: the style sheet knows those that differ.
function ink(color) {
  const name = "--c" + color.slice(1);
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim() || color;
}

function themed(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

const DIGITS = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

// The whole numbers in a text (plot.rs, `packed`).
function unpacked(text) {
  const numbers = [];
  let [number, weight] = [0, 1];
  for (const letter of text) {
    const digit = DIGITS.indexOf(letter);
    number += (digit % 32) * weight;
    weight *= 32;
    if (digit >= 32) continue;
    numbers.push(number % 2 ? -(number - 1) / 2 : number / 2);
    [number, weight] = [0, 1];
  }
  return numbers;
}

// Places on the grid as values of an axis.
function decoded(steps, [from, to]) {
  let place = 0;
  return unpacked(steps).map((step) => from + ((place += step) / GRID) * (to - from));
}

// A value with the digits that its axis can tell apart; the name of the nearest tick, where ticks
// have names.
function digits(value, { range: [from, to], log, ticks }) {
  if (value == null) return "\u2013";
  if (log) return String(Number((10 ** value).toPrecision(2)));
  if (ticks) return named(value, ticks);
  const places = Math.min(9, Math.max(0, 3 - Math.floor(Math.log10(Math.abs(to - from)))));
  return value.toFixed(places).replace("-", "\u2212");
}

// The plot's data with values in place of steps.
function prepared(holder) {
  const plot = JSON.parse(holder.querySelector("script").textContent);
  let before;
  for (const of of plot.elements) {
    if (of.y == null) continue;
    // Signals of one record share their places.
    of.x = of.x == null ? [...before] : decoded(of.x, plot.x.range);
    before = of.x;
    for (const name of ["y", "least", "most"]) {
      if (of[name]) of[name] = decoded(of[name], plot.y.range);
    }
    if (of.kind !== "series") continue;
    // uPlot needs ascending places; two values at one are a step.
    const least = (plot.x.range[1] - plot.x.range[0]) * 1e-6;
    for (let k = 1; k < of.x.length; k++) of.x[k] = Math.max(of.x[k], of.x[k - 1] + least);
  }
  plot.series = plot.elements.filter((of) => of.kind === "series");
  plot.first = plot.elements.findIndex((of) => of.kind === "series");
  plot.marks = plot.elements.filter((of) => of.kind === "mark");
  plot.bars = plot.series.filter((of) => of.shape === "bars");
  return plot;
}

// One table of values for all series; the ends of the axis are among its places.
function table(plot) {
  const ends = [plot.x.range, [null, null]];
  if (plot.series.length === 0) return ends;
  const tables = plot.series.map((of) => [of.x, of.y]);
  return uPlot.join([...tables, ends]).slice(0, -1);
}

// Rows for the marks above a plot, so that no text crosses another or another's line.
function stacked(plot, width) {
  const [from, to] = plot.x.range;
  const placed = [];
  for (const mark of plot.marks) {
    const end = ((mark.at - from) / (to - from)) * width;
    const start = end - widthOf(mark.text) - 8;
    const under = placed.filter((other) => other.end > start);
    mark.row = under.reduce((row, other) => Math.max(row, other.mark.row + 1), 0);
    placed.push({ mark, end });
  }
  return plot.marks.reduce((rows, mark) => Math.max(rows, mark.row + 1), 0);
}

// An axis in the page's colours.
function axis(of, isUpright) {
  const options = {
    label: of.title,
    labelFont: FONT,
    labelSize: 20,
    font: FONT,
    stroke: themed("--ink"),
    grid: { stroke: ink("#E3E6EA"), width: 1 },
    ticks: { stroke: ink("#6B727B"), width: 1, size: 4 },
    border: { show: true, stroke: ink("#6B727B"), width: 1 },
    space: isUpright ? 26 : 44,
  };
  if (isUpright) {
    // A tick, a gap, the longest label, and a gap before the title.
    options.size = (u, labels) => 4 + 5 + Math.ceil(Math.max(0, ...(labels ?? []).map(widthOf))) + 4;
  } else {
    options.size = 30;
    if (of.title.endsWith("degrees")) options.incrs = [0.1, 0.2, 0.5, 1, 2, 5, 10, 30, 60, 90, 180];
  }
  if (of.ticks) {
    options.splits = () => of.ticks.map(([at]) => at);
    options.values = () => of.ticks.map(([, label]) => label);
    options.filter = (u, splits) => splits;
  } else {
    options.values = (u, splits) => {
      const step = splits.length > 1 ? splits[1] - splits[0] : 1;
      const isExact = (places) => Math.abs(step - step.toFixed(places)) < 1e-6 * step;
      const places = [...Array(10).keys()].find(isExact) ?? 9;
      return splits.map((at) => (at == null ? "" : at.toFixed(places).replace("-", "\u2212")));
    };
  }
  return options;
}

// The scales: all of the axis at first and after a double click, else what was zoomed to.
function scales(plot) {
  const [from, to] = plot.x.range;
  const [low, high] = plot.y.range;
  const isAll = (least, most) => least == null || (least <= from && most >= to);
  return {
    x: { time: false, range: (u, least, most) => (isAll(least, most) ? [from, to] : [least, most]) },
    y: {
      range: (u, least, most) => {
        if (plot.series.length === 0) return least == null ? [low, high] : [least, most];
        // Bars stand on the lower edge, and may be cut at the upper one.
        if (plot.bars.length > 0) return [low, high];
        // Room for what was switched on.
        return [Math.min(low, least ?? low), Math.max(high, most ?? high)];
      },
    },
  };
}

// Height of a plot without its legend, and of what stands above its area, at a width; in pixels.
function heightsAt(plot, width) {
  const [wide, high] = plot.size;
  const rows = stacked(plot, width - 76);
  const hasLabels = plot.elements.some((of) => of.kind === "label") || plot.bars.length > 0;
  const above = hasLabels ? 20 : 10;
  const top = Math.max(above, rows * ROW + 6);
  // The axes take 50 pixels below, and about 64 at the side.
  const height = plot.square ? width - 64 - 12 + 50 + top : Math.max(230, (width * high) / wide);
  return { height: Math.round(height), top };
}

// What uPlot is to draw, at a width in pixels.
function options(plot, width) {
  const isPlane = plot.series.length === 0;
  const { height, top } = heightsAt(plot, width);
  return {
    width,
    height,
    // A label at the end of the axis stands half beside it.
    padding: [top, Math.max(12, Math.ceil(widthOf(plot.x.range[1].toFixed(0)) / 2) + 1), 0, 4],
    scales: scales(plot),
    axes: [axis(plot.x, false), axis(plot.y, true)],
    series: [
      { label: plot.x.title, value: (u, value) => digits(value, plot.x) },
      ...plot.series.map((of) => ({
        label: of.name,
        stroke: ink(of.stroke.color),
        width: of.stroke.width,
        dash: of.stroke.dash ?? undefined,
        show: !of.off && !off.has(of.variant),
        spanGaps: true,
        points: { show: of.x.length === 1 && !of.shape },
        value: (u, value) => digits(value, plot.y),
        fill: of.shape === "bars" ? ink(of.stroke.color) : undefined,
        paths: of.shape ? (u) => shape(u, of) : undefined,
      })),
      ...(isPlane ? [{ label: plot.y.title, show: false }] : []),
    ],
    cursor: {
      drag: { x: true, y: isPlane, uni: 8 },
      points: { show: !plot.series.some((of) => of.shape) },
      sync: isPlane ? undefined : { key: keyOfAxis(plot.x), setSeries: false, scales: ["x", null] },
    },
    legend: { show: !isPlane },
    hooks: {
      drawAxes: [(u) => overlay(u, plot, (place) => plot.first < 0 || place < plot.first)],
      draw: [
        (u) => overlay(u, plot, (place) => plot.first >= 0 && place > plot.first),
        (u) => labels(u, plot),
      ],
      setCursor: [(u) => readout(u, plot), (u) => markBar(u, plot)],
      setSeries: [(u, index, change) => toggled(u, plot, index, change)],
    },
  };
}

// The bars or level lines of a series, as uPlot draws them.
function shape(u, of) {
  const path = new Path2D();
  const [from, to] = of.ends;
  const floor = u.valToPos(u.scales.y.min, "y", true);
  of.x.forEach((x, k) => {
    const [left, right] = [from, to].map((end) => u.valToPos(x + end, "x", true));
    const top = u.valToPos(of.y[k], "y", true);
    if (of.shape === "bars") {
      path.rect(left, top, right - left, floor - top);
    } else {
      path.moveTo(left, top);
      path.lineTo(right, top);
    }
  });
  return of.shape === "bars" ? { fill: path, flags: 1 } : { stroke: path, flags: 1 };
}

// Marks the name of the bar below the pointer.
function markBar(u, plot) {
  const [x, y] = [u.posToVal(u.cursor.left, "x"), u.posToVal(u.cursor.top, "y")];
  plot.bars.forEach((of) => {
    const place = plot.series.indexOf(of) + 1;
    const isHit = (at, k) => x >= at + of.ends[0] && x <= at + of.ends[1] && y <= of.y[k];
    const isMarked = u.cursor.left >= 0 && u.series[place].show && of.x.some(isHit);
    u.root.querySelectorAll(".u-series")[place]?.classList.toggle("below", isMarked);
  });
}

// The bands of shown series, and the elements that are no series.
function overlay(u, plot, isMine) {
  const { ctx, bbox } = u;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  plot.elements.forEach((of, place) => {
    if (of.kind === "series" && place >= plot.first && !isMine(plot.first - 1)) return;
    if (of.kind === "series") {
      const shown = u.series[1 + plot.series.indexOf(of)].show;
      if (shown && of.least.length > 0) band(u, of);
    } else if (isMine(place)) {
      element(u, of);
    }
  });
  ctx.restore();
}

function trace(u, xs, ys) {
  xs.forEach((x, k) => u.ctx.lineTo(u.valToPos(x, "x", true), u.valToPos(ys[k], "y", true)));
}

function band(u, of) {
  u.ctx.beginPath();
  trace(u, of.x, of.most);
  trace(u, of.x.toReversed(), of.least.toReversed());
  u.ctx.globalAlpha = 0.22;
  u.ctx.fillStyle = ink(of.stroke.color);
  u.ctx.fill();
  u.ctx.globalAlpha = 1;
}

// Draws a line, an area, a dot, a cross or the line of a mark.
function element(u, of) {
  const { ctx, bbox } = u;
  const ratio = devicePixelRatio;
  const at = of.at?.length === 2 && of.at.map((value, k) => u.valToPos(value, "xy"[k], true));
  ctx.beginPath();
  ctx.setLineDash((of.stroke?.dash ?? []).map((length) => length * ratio));
  ctx.globalAlpha = of.opacity ?? of.stroke?.opacity ?? 1;
  ctx.lineWidth = (of.stroke?.width ?? of.width ?? 1) * ratio;
  ctx.strokeStyle = ctx.fillStyle = ink(of.stroke?.color ?? of.color ?? "#6B727B");
  if (of.kind === "mark") {
    const x = u.valToPos(of.at, "x", true);
    ctx.setLineDash([2 * ratio, 3 * ratio]);
    ctx.moveTo(x, bbox.top);
    ctx.lineTo(x, bbox.top + bbox.height);
  } else if (of.kind === "dot") {
    ctx.arc(...at, of.radius * ratio, 0, 2 * Math.PI);
  } else if (of.kind === "cross") {
    const size = 4 * ratio;
    ctx.lineWidth = 2 * ratio;
    for (const side of [-1, 1]) {
      ctx.moveTo(at[0] - size, at[1] - side * size);
      ctx.lineTo(at[0] + size, at[1] + side * size);
    }
  } else if (of.x) {
    trace(u, of.x, of.y);
  }
  if (of.kind === "area" || (of.kind === "dot" && of.width == null)) ctx.fill();
  else ctx.stroke();
  ctx.globalAlpha = 1;
  ctx.setLineDash([]);
}

// Texts in and above a plot, as elements of the page: they have the page's font, and a test can
// tell whether they overlap. One that would cover an earlier one is left out.
function labels(u, plot) {
  const wrap = u.root.querySelector(".u-wrap");
  wrap.querySelectorAll(".label").forEach((old) => old.remove());
  const taken = [];
  for (const of of [...plot.elements, ...cutBars(u, plot)]) {
    if (of.kind !== "label" && of.kind !== "mark") continue;
    const { text, place } = of.kind === "mark" ? ofMark(u, of) : ofLabel(u, of);
    if (!place) continue;
    const node = document.createElement("span");
    node.className = "label";
    node.textContent = text;
    if (of.color) node.style.color = ink(of.color);
    wrap.append(node);
    const { width, height } = node.getBoundingClientRect();
    const left = Math.max(0, Math.min(place.x - place.anchor[0] * width, u.width - width));
    const top = place.y - place.anchor[1] * height;
    const covers = (other) =>
      left < other.right && other.left < left + width && top < other.bottom && other.top < top + height;
    if (taken.some(covers)) {
      node.remove();
      continue;
    }
    taken.push({ left, top, right: left + width, bottom: top + height });
    node.style.left = `${left}px`;
    node.style.top = `${top}px`;
  }
}

// The values of bars that are cut at the upper edge, as texts above it.
function cutBars(u, plot) {
  const shown = plot.bars.filter((of) => u.series[plot.series.indexOf(of) + 1].show);
  return shown.flatMap((of) =>
    of.x.flatMap((x, k) => {
      if (of.y[k] <= plot.y.range[1]) return [];
      const at = [x + (of.ends[0] + of.ends[1]) / 2, plot.y.range[1]];
      return [{ kind: "label", at, text: of.y[k].toFixed(0), offset: [0, -3], anchor: [0.5, 1] }];
    }),
  );
}

const isWithin = (value, scale) => value >= scale.min && value <= scale.max;

// A mark's text ends at its line, in its row above the plot.
function ofMark(u, of) {
  if (!isWithin(of.at, u.scales.x)) return {};
  const x = u.valToPos(of.at, "x") + u.over.offsetLeft - 4;
  const y = u.over.offsetTop - of.row * ROW - 2;
  return { text: of.text, place: { x, y, anchor: [1, 1] } };
}

function ofLabel(u, of) {
  if (!isWithin(of.at[0], u.scales.x)) return {};
  const [x, y] = of.at.map((value, k) => u.valToPos(value, "xy"[k]));
  const place = {
    x: x + u.over.offsetLeft + of.offset[0],
    y: y + u.over.offsetTop + of.offset[1],
    anchor: of.anchor,
  };
  return { text: of.text, place };
}

// The pointer's place, below a plot without series.
function readout(u, plot) {
  const line = u.root.querySelector(".readout");
  if (!line) return;
  const value = (at, scale) => (at >= 0 ? u.posToVal(at, scale) : null);
  line.textContent = toldOf(plot, value(u.cursor.left, "x"), value(u.cursor.top, "y"));
}

const toldOf = ({ x, y }, ...at) => `${x.title}: ${digits(at[0], x)}, ${y.title}: ${digits(at[1], y)}`;

// A line for what is told of the pointer's place, without one yet.
function lineOf(plot) {
  const line = document.createElement("p");
  line.className = "readout";
  line.textContent = toldOf(plot);
  return line;
}

// The name of the nearest tick.
function named(value, ticks) {
  const apart = ([at]) => Math.abs(at - value);
  return ticks.reduce((best, tick) => (apart(tick) < apart(best) ? tick : best))[1];
}

// The names of a legend as buttons.
function watchNames(u, plot) {
  if (plot.series.length === 0) return;
  u.root.querySelectorAll(".u-series th").forEach((name, place) => {
    if (place === 0) return;
    pressable(name);
    name.setAttribute("aria-pressed", u.series[place].show);
  });
}

// Plots that are read and zoomed together: signals over the same axis.
const keyOfAxis = ({ title, ticks }) => title + JSON.stringify(ticks);

function together(entry) {
  const isMate = ({ u, plot }) =>
    u && plot.series.length > 0 && keyOfAxis(plot.x) === keyOfAxis(entry.plot.x);
  return entry.plot.series.length > 0 ? plots.filter(isMate) : [entry];
}

// Shows a share of what a plot and its mates show now, around the pointer; all of it without one.
function zoom(entry, share) {
  const { plot, u } = entry;
  for (const name of plot.series.length > 0 ? ["x"] : ["x", "y"]) {
    const { min, max } = u.scales[name];
    const at = u.posToVal(name === "x" ? u.cursor.left : u.cursor.top, name);
    const [from, to] = plot[name].range;
    const least = share ? Math.max(from, at + (min - at) * share) : from;
    const most = share ? Math.min(to, at + (max - at) * share) : to;
    together(entry).forEach((mate) => mate.u.setScale(name, { min: least, max: most }));
  }
}

// Arrow keys move the pointer of a plot, + and - zoom around it, 0 shows all.
function watchKeys(entry) {
  const { u } = entry;
  u.over.tabIndex = 0;
  u.over.setAttribute("role", "application");
  u.over.setAttribute("aria-label", "Plot: arrow keys read values, + and - zoom, 0 shows all");
  u.over.addEventListener("keydown", (event) => {
    const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const shares = { "+": 0.5, "-": 2, 0: null };
    const { clientWidth: wide, clientHeight: high } = u.over;
    // Begins in the middle.
    const place = u.cursor.left >= 0 ? [u.cursor.left, u.cursor.top] : [wide / 2, high / 2];
    const [right, down] = moves[event.key] ?? [0, 0];
    if (!(event.key in moves) && !(event.key in shares)) return;
    event.preventDefault();
    const within = (value, most) => Math.max(0, Math.min(most - 1, value));
    const left = within(place[0] + (right * wide) / 60, wide);
    // Heard by the plots that are read together.
    u.setCursor({ left, top: within(place[1] + (down * high) / 30, high) }, true, true);
    if (event.key in shares) zoom(entry, shares[event.key]);
  });
}

// Two fingers zoom a plot and its mates: the values below them stay below them. One finger scrolls
// the page, a double tap shows all.
function watchFingers(entry) {
  const { plot, u } = entry;
  const axes = plot.series.length > 0 ? ["x"] : ["x", "y"];
  let values;
  const fingers = ({ targetTouches: touches }) => {
    const { left, top } = u.over.getBoundingClientRect();
    return [...touches].map(({ clientX, clientY }) => ({ x: clientX - left, y: clientY - top }));
  };
  const begin = (event) => {
    const places = fingers(event);
    const valueOf = (name) => places.map((place) => u.posToVal(place[name], name));
    values = places.length === 2 ? axes.map(valueOf) : null;
    // The page neither scrolls nor zooms.
    if (values) event.preventDefault();
  };
  const move = (event) => {
    if (!values) return;
    event.preventDefault();
    const places = fingers(event);
    axes.forEach((name, axis) => {
      const [one, other] = places.map((place) => place[name]);
      const [of, and] = values[axis];
      // Fingers side by side say nothing of the other axis.
      if (Math.abs(other - one) < 20) return;
      const perPixel = (and - of) / (other - one);
      const ends = name === "x" ? [0, u.over.clientWidth] : [u.over.clientHeight, 0];
      const [least, most] = ends.map((end) => of + (end - one) * perPixel);
      const [from, to] = plot[name].range;
      const scale = { min: Math.max(from, least), max: Math.min(to, most) };
      if (least < most) together(entry).forEach((mate) => mate.u.setScale(name, scale));
    });
  };
  const heard = { passive: false };
  u.over.addEventListener("touchmove", move, heard);
  for (const change of ["touchstart", "touchend", "touchcancel"]) {
    u.over.addEventListener(change, begin, heard);
  }
}

// A click on a variant's name in a legend holds for the page.
function toggled(u, plot, index, change) {
  const of = plot.series[index - 1];
  if (!of || change.show == null) return;
  of.off = !change.show;
  u.root.querySelectorAll(".u-series th")[index]?.setAttribute("aria-pressed", change.show);
  if (of.variant != null) switchVariant(of.variant, change.show);
}

// A legend as uPlot writes it, before it tells values.
function legendOf(plot) {
  const legend = document.createElement("table");
  legend.className = "u-legend u-inline u-live";
  for (const name of [plot.x.title, ...plot.series.map((of) => of.name)]) {
    const row = legend.insertRow();
    row.className = "u-series";
    row.innerHTML = '<th><div class="u-marker"></div><div class="u-label"></div></th><td class="u-value">\u2013</td>';
    row.querySelector(".u-label").textContent = name;
  }
  return legend;
}

// Keeps the room of a plot that is not drawn yet: if plots grew on the way to a link's heading, the
// link would miss it. Only the browser knows how many lines a legend has.
function reserve({ holder, plot, width }) {
  holder.querySelector(".reserved")?.remove();
  if (width === 0) return;
  const root = document.createElement("div");
  root.className = "uplot reserved";
  const area = document.createElement("div");
  Object.assign(area.style, { width: `${width}px`, height: `${heightsAt(plot, width).height}px` });
  root.append(area, plot.series.length > 0 ? legendOf(plot) : lineOf(plot));
  holder.append(root);
}

// Draws a plot, or draws it anew: another width, another scheme.
function draw(entry) {
  const { holder, plot, width } = entry;
  if (width === 0) return;
  holder.querySelector(".reserved")?.remove();
  entry.u?.destroy();
  entry.u = new uPlot(options(plot, width), table(plot), holder);
  // uPlot does so later; until then the page would be shorter.
  entry.u.root.querySelector(".u-wrap").style.height = `${entry.u.height}px`;
  watchNames(entry.u, plot);
  watchKeys(entry);
  watchFingers(entry);
  if (plot.series.length === 0) entry.u.root.append(lineOf(plot));
}

// Draws plots when they come near the screen: a page has dozens.
function watchPlots() {
  const near = new IntersectionObserver(
    (seen) => {
      for (const { target, isIntersecting } of seen) {
        const entry = plots.find(({ holder }) => holder === target);
        if (isIntersecting && !entry.u) draw(entry);
      }
    },
    { rootMargin: "600px" },
  );
  const resized = new ResizeObserver((seen) => {
    for (const { target } of seen) {
      const entry = plots.find(({ holder }) => holder === target);
      const width = Math.floor(target.clientWidth);
      // None while its figure is hidden.
      if (width === 0 || width === entry.width) continue;
      entry.width = width;
      if (entry.u) draw(entry);
      else reserve(entry);
    }
  });
  for (const holder of document.querySelectorAll("div.plot")) {
    plots.push({ holder, plot: prepared(holder), width: Math.floor(holder.clientWidth) });
  }
  // Widths are read before: each that is read after a change costs a layout of the page.
  plots.forEach(reserve);
  for (const { holder } of plots) {
    near.observe(holder);
    resized.observe(holder);
  }
  dark.addEventListener("change", () => plots.filter(({ u }) => u).forEach(draw));
}

// Switches ----------------------------------------------------------------------------------------

// Shows or hides a variant: its figures, its lines in all plots, its buttons.
function switchVariant(variant, isOn) {
  if (off.has(variant) !== isOn) return;
  if (isOn) off.delete(variant);
  else off.add(variant);
  for (const button of document.querySelectorAll(`button[data-variant="${variant}"]`)) {
    button.setAttribute("aria-pressed", isOn);
  }
  for (const figure of document.querySelectorAll(`figure[data-variant="${variant}"]`)) {
    figure.hidden = !isOn;
  }
  for (const { plot, u } of plots) {
    plot.series.forEach((of, k) => {
      if (of.variant === variant && u && u.series[k + 1].show !== isOn) {
        u.setSeries(k + 1, { show: isOn });
      }
    });
  }
}

function watchSwitches() {
  for (const button of document.querySelectorAll("button[data-variant]")) {
    const variant = Number(button.dataset.variant);
    button.addEventListener("click", () => switchVariant(variant, off.has(variant)));
  }
}

// Tables ------------------------------------------------------------------------------------------

// The cell of a row that covers a column.
function cellAt(row, column) {
  let place = 0;
  for (const cell of row.cells) {
    place += cell.colSpan;
    if (place > column) return cell;
  }
  return undefined;
}

// What a row is sorted by: its number where it has one, else its text.
function keyOf(row, column) {
  const text = cellAt(row, column)?.innerText.trim() ?? "";
  const number = parseFloat(text.replace(/\u2212/g, "-").replace(/[^\d.+\-e].*$/, ""));
  return { text, number };
}

function compared(a, b) {
  if (Number.isNaN(a.number) !== Number.isNaN(b.number)) return Number.isNaN(a.number) ? 1 : -1;
  return Number.isNaN(a.number) ? a.text.localeCompare(b.text) : a.number - b.number;
}

// The column of a heading; the second row of headings stands below those of a group.
function columnOf(heading) {
  const [upper, lower] = heading.closest("thead").rows;
  let column = 0;
  const below = [...(lower?.cells ?? [])];
  for (const cell of upper.cells) {
    if (cell === heading) return column;
    if (cell.classList.contains("group")) {
      const place = below.splice(0, cell.colSpan).indexOf(heading);
      if (place >= 0) return column + place;
    }
    column += cell.colSpan;
  }
  return column;
}

// Sorts a table by a column; groups of rows keep together and are sorted by their first row.
function sort(heading) {
  const table = heading.closest("table");
  const column = columnOf(heading);
  const isUp = heading.getAttribute("aria-sort") !== "ascending";
  table.querySelectorAll("th[aria-sort]").forEach((th) => th.removeAttribute("aria-sort"));
  heading.setAttribute("aria-sort", isUp ? "ascending" : "descending");
  const bodies = [...table.tBodies];
  const parts = bodies.length > 1 ? bodies : [...bodies[0].rows];
  const rowOf = (part) => (part.rows ? part.rows[0] : part);
  const keys = new Map(parts.map((part) => [part, keyOf(rowOf(part), column)]));
  parts.sort((a, b) => (isUp ? 1 : -1) * compared(keys.get(a), keys.get(b)));
  (bodies.length > 1 ? table : bodies[0]).append(...parts);
}

// Names of rows that stay readable while a table scrolls sideways: lines break between settings, else
// after a key, never inside of a word; a group's name can move in its cell, as wide as the table.
function nameRows() {
  for (const code of document.querySelectorAll("th code")) {
    const settings = code.innerHTML.split(/<wbr>|(?<=:)/);
    const breakable = settings.map((of) => `<span>${of.replace("=", "=<wbr>")}</span>`);
    code.innerHTML = breakable.join("");
  }
  for (const cell of document.querySelectorAll("tbody th[colspan]")) {
    const name = document.createElement("span");
    name.append(...cell.childNodes);
    cell.append(name);
  }
}

function watchTables() {
  for (const table of document.querySelectorAll("table")) {
    const rows = table.tBodies.length > 1 ? table.tBodies.length : table.tBodies[0]?.rows.length;
    if (!table.tHead || rows < 2 || table.classList.contains("verdict")) continue;
    for (const heading of table.tHead.querySelectorAll("th:not(.group)")) {
      const button = document.createElement("button");
      button.className = "sort";
      button.append(...heading.childNodes);
      heading.append(button);
      button.addEventListener("click", () => sort(heading));
    }
  }
}

// Links -------------------------------------------------------------------------------------------

// The places in a text as "3 7-9".
function places(text) {
  return text
    .split(" ")
    .filter(Boolean)
    .flatMap((part) => {
      const [from, to = from] = part.split("-").map(Number);
      return Array.from({ length: to - from + 1 }, (_, k) => from + k);
    });
}

// Marks fields, formulas and lines of code that belong together; each pane shows its first one,
// except the one that was clicked in.
function mark(box, clicked, marked) {
  box.querySelectorAll(".linked-to").forEach((old) => old.classList.remove("linked-to"));
  for (const pane of box.querySelectorAll(".pane")) {
    const inside = marked.filter((node) => pane.contains(node));
    inside.forEach((node) => node.classList.add("linked-to"));
    if (inside.length > 0 && !pane.contains(clicked)) pane.scrollTop = inside[0].offsetTop - 40;
  }
}

function watchLinks() {
  for (const box of document.querySelectorAll(".linked")) {
    const fields = [...box.querySelectorAll("[data-formulas]")];
    const formulas = [...box.querySelectorAll("[data-lines]")];
    const lines = [...box.querySelectorAll(".line")];
    const ofField = fields.map((field) => places(field.dataset.formulas).map((k) => formulas[k]));
    const ofFormula = formulas.map((of) => places(of.dataset.lines).map((k) => lines[k]));
    const linesOf = (chosen) => chosen.flatMap((of) => ofFormula[formulas.indexOf(of)]);
    const fieldsOf = (chosen) =>
      fields.filter((_, k) => ofField[k].some((of) => chosen.includes(of)));
    // The others belong to no formula.
    const linked = lines.filter((line) => ofFormula.some((of) => of.includes(line)));
    linked.forEach(pressable);
    [fields, formulas, linked].forEach(oneStop);
    box.addEventListener("click", ({ target }) => {
      const clicked = target.closest("button, .line[role]");
      if (!clicked) return;
      const place = fields.indexOf(clicked);
      let chosen = place >= 0 ? ofField[place] : [clicked];
      if (lines.includes(clicked)) {
        chosen = formulas.filter((_, k) => ofFormula[k].includes(clicked));
      }
      // A field shows what follows from it, not all else that this follows from.
      const above = place >= 0 ? [clicked] : fieldsOf(chosen);
      const below = lines.includes(clicked) ? [clicked] : linesOf(chosen);
      mark(box, clicked, [...above, ...chosen, ...below]);
    });
  }
}

nameRows();
watchPlots();
watchSwitches();
watchLinks();
watchTables();
