// A chart as elements of SVG: `drawing.draw(view)` has no memory and handles no events.
//
// The view is { series, shape, zoom, width, height, clip }. A series is { name, note, ink, points, mark, line, broad, guide }:
//   points  { x, y, left, right, low, high, symbol, hollow, label, soft, tip, target }: intervals, a label beside the mark, the lines of its tip, and
//           what a click opens; all but x and y may be absent
//   mark    { symbol, size, opacity }; where it is absent, points have no marks
//   line    { width, dash, opacity, step, path }; the path is [x, y] each, that of the points unless it is given
//   broad   [x, y] each: a broad pale line under everything, for fits
//   guide   a value of y: a line from edge to edge, which is no value of its own
// The shape is { x, y, bands, empty }. An axis is { title, log, range, ticks, least, turn }: ticks are [value, text, exponent], `least` is the value that
// stands for all below it, `turn` lets labels stand aslant. Bands are [from, to, ink] along y. `empty` is written where there is nothing to draw.
featherbench.drawing = (() => {
  const { axes, variable } = featherbench;
  const { svg, mark, line, bar, text, measure, shorten } = featherbench.marks;
  const SMALL = 12;
  const SIZE = 13;
  // The slope of labels that would touch when level, in degrees.
  const SLOPE = 38;

  // --- Ranges and ticks.

  const along = (points) => points.map(({ x, y }) => [x, y]);
  const path = (series) => series.line?.path ?? (series.line ? along(series.points) : []);

  // All numbers of a series along an axis: marks, intervals and lines are to be seen whole.
  function numbers(series, key) {
    const index = key === "x" ? 0 : 1;
    const ends = key === "x" ? ["x", "left", "right"] : ["y", "low", "high"];
    const lines = [...path(series), ...(series.broad ?? [])].map((point) => point[index]);
    return [...series.points.flatMap((point) => ends.map((end) => point[end])), ...lines, key === "y" ? series.guide : undefined];
  }

  // The range that an axis has by itself; bands are to be seen whatever the values are.
  function home(series, shape, key) {
    const axis = shape[key];
    if (axis.range) return axis.range.map((value) => axes.inner(axis.log, value));
    const bands = key === "y" ? (shape.bands ?? []).flatMap(([from, to]) => [from, to]) : [];
    return axes.range(axis.log, [...series.flatMap((one) => numbers(one, key)), ...bands]);
  }

  // Ticks and labels: an axis's own, or even ones. Below the least value nothing is told apart, and its label says so.
  function ticks(axis, range, count, floored) {
    if (axis.ticks) {
      const found = axis.ticks.filter(([value]) => axes.fits(axis.log, value)).map(([value, ...label]) => ({ value, label, place: axes.inner(axis.log, value) }));
      const kept = found.filter(({ place }) => place >= range[0] && place <= range[1]);
      return { major: kept.map(({ value }) => value), minor: [], labels: kept.map(({ label }) => label) };
    }
    const above = (value) => !floored || value > 0.99 * axis.least;
    const found = axes.ticks(axis.log, range, Math.floor(count));
    const major = found.major.filter(above);
    const labels = axes.labels(major).map(([words, ...exponent], index) => [(floored && major[index] < 1.01 * axis.least ? "≤ " : "") + words, ...exponent]);
    return { major, minor: found.minor.filter(above), labels };
  }

  const widest = (labels) => Math.max(0, ...labels.map((label) => measure(label, SMALL)));

  // Scales, ticks, and the box between the axes; null where no point has a place.
  function plan({ series, shape, zoom, width, height }) {
    const placed = (point) => axes.fits(shape.x.log, point.x) && axes.fits(shape.y.log, point.y);
    if (!series.some((one) => one.points.some(placed))) return null;
    const [across, up] = [zoom?.x ?? home(series, shape, "x"), zoom?.y ?? home(series, shape, "y")];
    const own = (shape.x.ticks ?? []).map(([, ...label]) => label);
    const turned = Boolean(shape.x.turn) && (widest(own) + 10) * own.length > width - 80;
    const slope = (SLOPE * Math.PI) / 180;
    const tall = turned ? widest(own) * Math.sin(slope) + 18 : 22;
    const box = { top: shape.y.title ? 34 : 12, bottom: height - tall - (shape.x.title ? 26 : 6), right: width - 14 };
    const floored = shape.y.least !== undefined && series.some((one) => one.points.some((point) => point.y <= shape.y.least));
    const yTicks = ticks(shape.y, up, (box.bottom - box.top) / 38, floored);
    // The first label that stands aslant needs room on the left.
    box.left = Math.max(36, widest(yTicks.labels) + 14, turned ? measure(own[0], SMALL) * Math.cos(slope) - 10 : 0);
    const xTicks = ticks(shape.x, across, (box.right - box.left) / 75, false);
    return { box, turned, tall, xTicks, yTicks, x: axes.scale(shape.x.log, across, box.left, box.right), y: axes.scale(shape.y.log, up, box.bottom, box.top) };
  }

  // --- Axes.

  function drawGrid({ box, x, y, xTicks, yTicks }) {
    const up = (value) => `M${x.at(value).toFixed(1)} ${box.top}V${box.bottom}`;
    const across = (value) => `M${box.left} ${y.at(value).toFixed(1)}H${box.right}`;
    const lines = (kind) => [...xTicks[kind].map(up), ...yTicks[kind].map(across)].join("");
    const ends = [...xTicks.major.map((value) => `M${x.at(value).toFixed(1)} ${box.bottom}v5`), ...yTicks.major.map((value) => `M${box.left} ${y.at(value).toFixed(1)}h-5`)];
    return svg("g", { fill: "none" },
      svg("path", { class: "minor", d: lines("minor"), stroke: variable("--line"), opacity: 0.45 }),
      svg("path", { class: "major", d: lines("major"), stroke: variable("--line") }),
      svg("path", { d: `${ends.join("")}M${box.left} ${box.top}V${box.bottom}H${box.right}`, stroke: variable("--soft"), opacity: 0.7 }));
  }

  // Labels from left to right; one that would touch its neighbour is left out.
  function drawAcross({ box, x, xTicks, turned }) {
    const group = svg("g", { class: "xticks", fill: variable("--soft"), "font-size": SMALL, "text-anchor": turned ? "end" : "middle" });
    let end = -Infinity;
    xTicks.major.forEach((value, index) => {
      const [place, half] = [x.at(value), turned ? SMALL * 0.55 : 4 + measure(xTicks.labels[index], SMALL) / 2];
      if (place - half < end) return;
      end = place + half;
      const below = box.bottom + (turned ? 14 : 19);
      group.append(text(xTicks.labels[index], place, below, turned ? { transform: `rotate(${-SLOPE} ${place.toFixed(1)} ${below})` } : {}));
    });
    return group;
  }

  function drawUp({ box, y, yTicks }) {
    const group = svg("g", { class: "yticks", fill: variable("--soft"), "font-size": SMALL, "text-anchor": "end" });
    yTicks.major.forEach((value, index) => group.append(text(yTicks.labels[index], box.left - 9, y.at(value) + 4, {})));
    return group;
  }

  // A title over its axis lies flat: long ones have room, and no head is turned. The other is in the middle of its axis, never beyond the edge.
  function drawTitles({ shape, width }, { box, tall }) {
    const style = { fill: variable("--ink"), "font-size": SIZE };
    const [words, above] = [shape.x.title, shape.y.title].map((title) => shorten(title ?? "", SIZE, width - 4));
    const half = measure([words], SIZE) / 2;
    const middle = Math.min(Math.max((box.left + box.right) / 2, half), width - half);
    return [text([above], 0, 15, { class: "ytitle", ...style }), text([words], middle, box.bottom + tall + 18, { class: "xtitle", "text-anchor": "middle", ...style })];
  }

  // --- Series.

  const inside = (box, x, y) => x >= box.left - 0.5 && x <= box.right + 0.5 && y >= box.top - 0.5 && y <= box.bottom + 0.5;

  function drawBands(bands, { box, y }) {
    return bands.map(([from, to, ink]) => {
      const [top, bottom] = [y.at(to), y.at(from)];
      return svg("rect", { class: "band", x: box.left, width: box.right - box.left, y: top.toFixed(1), height: Math.max(1, bottom - top).toFixed(1), fill: ink, opacity: 0.7 });
    });
  }

  // Broad lines, guides, and lines, in this order. A point that has no place is left out of its line.
  function drawLines(series, { box, x, y }) {
    const place = (points) => points.filter(([a, b]) => axes.fits(x.log, a) && axes.fits(y.log, b)).map(([a, b]) => [x.at(a), y.at(b)]);
    const guide = (value) => (axes.fits(y.log, value) ? [[box.left, y.at(value)], [box.right, y.at(value)]] : []);
    const all = [
      ...series.map((one) => [one, place(one.broad ?? []), { width: 5, opacity: 0.18 }]),
      ...series.map((one) => [one, guide(one.guide), one.line]),
      ...series.map((one) => [one, place(path(one)), one.line]),
    ];
    return all.filter(([, points]) => points.length > 1).map(([one, points, style]) => tagged(line(points, style, one.ink), one));
  }

  // What belongs to a series can be found by its number.
  function tagged(element, series) {
    element.setAttribute("data-k", series.k);
    return element;
  }

  // An interval whose end has no place goes on to the edge; one that is absent ends at the mark.
  function drawBars(series, point, { box, x, y }) {
    const end = (scale, value, other, edge) => (value === null || value === undefined ? scale.at(other) : axes.fits(scale.log, value) ? scale.at(value) : edge);
    const found = [];
    const has = (...values) => values.some((value) => value !== null && value !== undefined);
    if (has(point.left, point.right)) found.push(bar(true, y.at(point.y), end(x, point.left, point.x, box.left), end(x, point.right, point.x, box.right), series.ink));
    if (has(point.low, point.high)) found.push(bar(false, x.at(point.x), end(y, point.low, point.y, box.bottom), end(y, point.high, point.y, box.top), series.ink));
    return found.map((element) => tagged(element, series));
  }

  // The marks that are inside the box, from the undermost to the uppermost, with their places.
  function spotsOf(series, { box, x, y }) {
    const found = [];
    for (const one of series) {
      for (const point of one.points) {
        if (!axes.fits(x.log, point.x) || !axes.fits(y.log, point.y)) continue;
        const spot = { series: one, point, x: x.at(point.x), y: y.at(point.y) };
        if (inside(box, spot.x, spot.y)) found.push(spot);
      }
    }
    return found;
  }

  function drawMark({ series, point, x, y }, paper) {
    const { symbol, size, opacity } = series.mark;
    const element = mark({ symbol: point.symbol ?? symbol, hollow: point.hollow, size, ink: series.ink, paper }, x, y);
    element.setAttribute("class", "mark");
    if (opacity !== undefined) element.setAttribute("opacity", opacity);
    return tagged(element, series);
  }

  // Labels beside their marks: the first of six places that touches no other label, no mark and no edge; the first place where all do.
  function drawLabels(spots, box) {
    const taken = spots.map((spot) => [spot.x - 7, spot.y - 7, spot.x + 7, spot.y + 7]);
    const touches = ([left, top, right, bottom]) => left < box.left || right > box.right || top < box.top || bottom > box.bottom
      || taken.some(([l, t, r, b]) => left < r && right > l && top < b && bottom > t);
    // From right to left: the first place, on the right, is then free for the mark that has nothing beside it.
    const labelled = spots.filter(({ point }) => point.label).sort((a, b) => b.x - a.x);
    return labelled.map(({ series, point, x, y }) => {
      const width = measure([point.label], SMALL);
      const around = [[10, -10], [10, 19], [-10 - width, -10], [-10 - width, 19], [-width / 2, -14], [-width / 2, 23]];
      const boxes = around.map(([dx, dy]) => [x + dx, y + dy - SMALL, x + dx + width, y + dy + 2]);
      const chosen = Math.max(0, boxes.findIndex((one) => !touches(one)));
      taken.push(boxes[chosen]);
      const [dx, dy] = around[chosen];
      return tagged(text([point.label], x + dx, y + dy, { "font-size": SMALL, fill: variable(point.soft ? "--soft" : "--ink") }), series);
    });
  }

  // --- The whole.

  function nothing({ shape, width, height }) {
    const words = shorten(shape.empty ?? "no values to draw", SIZE, width - 4);
    return text([words], width / 2, height / 2, { class: "nothing", "text-anchor": "middle", "font-size": SIZE, fill: variable("--soft") });
  }

  // The elements, the marks' places and the scales of a view.
  function draw(view) {
    const whole = plan(view);
    if (!whole) return { elements: [nothing(view)], spots: [], whole };
    const { box } = whole;
    const spots = spotsOf(view.series, whole);
    const paper = variable("--panel");
    // A zoom cuts through lines and bars.
    const clip = svg("clipPath", { id: view.clip }, svg("rect", { x: box.left, y: box.top, width: box.right - box.left, height: box.bottom - box.top }));
    const cut = (name, children) => svg("g", { class: name, "clip-path": `url(#${view.clip})` }, ...children);
    const marked = spots.filter(({ series }) => series.mark);
    const elements = [
      svg("defs", {}, clip), cut("bands", drawBands(view.shape.bands ?? [], whole)), drawGrid(whole), drawAcross(whole), drawUp(whole), ...drawTitles(view, whole),
      cut("lines", drawLines(view.series, whole)), svg("g", { class: "marks" }, ...marked.map((spot) => drawMark(spot, paper))),
      // Above the marks, because an interval may be shorter than its mark.
      cut("bars", spots.flatMap(({ series, point }) => drawBars(series, point, whole))), svg("g", { class: "labels" }, ...drawLabels(marked, box)),
    ];
    return { elements, spots: marked, whole };
  }

  return { draw, home };
})();
