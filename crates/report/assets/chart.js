// Charts on the page: featherbench.chart(element, series, shape, open) draws into an element, and again when its width changes. What series and shapes
// are stands in the file of `draw`. The names of series switch them on and off, a rectangle zooms, and `open` is called with a clicked point's target.
featherbench.chart = (() => {
  const { drawing, make, variable } = featherbench;
  const { svg, sample, text, measure } = featherbench.marks;
  const NAMES = 12.5;
  // Marks answer within this many pixels; a pointer that moves less than DRAG is a click; a rectangle thinner than THIN means its length alone.
  const NEAR = 24;
  const DRAG = 5;
  const THIN = 10;

  const charts = new WeakMap();

  function chart(element, series, shape, open) {
    const state = charts.get(element) ?? create(element);
    const numbered = series.map((one, k) => ({ ...one, points: one.points ?? [], k }));
    Object.assign(state, { series: numbered, shape, open });
    // A zoom outlives another theme, not other numbers.
    const key = JSON.stringify([shape.x.title, shape.y.title, drawing.home(numbered, shape, "x"), drawing.home(numbered, shape, "y")]);
    if (key !== state.key) state.zoom = null;
    state.key = key;
    list(state);
    render(state);
  }

  function create(element) {
    const state = { element, hidden: new Set(), zoom: null, spots: [], spot: null, start: null };
    state.svg = svg("svg", { role: "img", tabindex: 0 });
    state.over = svg("g", { class: "over", "pointer-events": "none" });
    state.tip = make("div", { className: "chart-tip", role: "status", hidden: true });
    state.names = make("div", { className: "chart-names", role: "group", ariaLabel: "Series" });
    state.back = make("button", { type: "button", className: "chart-back", hidden: true }, "Reset zoom");
    const kept = make("button", { type: "button", className: "chart-save" }, "Save as SVG");
    state.figure = make("div", { className: "chart-figure" }, state.svg, state.tip);
    element.replaceChildren(state.figure, make("div", { className: "chart-side" }, state.names, make("div", { className: "chart-tools" }, state.back, kept)));
    state.back.addEventListener("click", () => zoom(state, null));
    kept.addEventListener("click", () => save(state));
    listen(state);
    new ResizeObserver(() => { if (state.series && state.figure.clientWidth !== state.width) render(state); }).observe(state.figure);
    charts.set(element, state);
    return state;
  }

  function render(state) {
    const { element, figure, shape } = state;
    const [width, height] = [figure.clientWidth, figure.clientHeight];
    hide(state);
    // What is not on the page has no size; it is drawn when it gets one.
    if (width < 60 || height < 60) return;
    const series = state.series.filter((one) => !state.hidden.has(one.name));
    const { elements, spots, whole } = drawing.draw({ series, shape, zoom: state.zoom, width, height, clip: `${element.id}-clip` });
    Object.assign(state, { width, height, spots, whole });
    const about = `${element.getAttribute("aria-label") ?? "Chart"}: ${spots.length} points in ${new Set(spots.map((spot) => spot.series)).size} series`;
    const attributes = { viewBox: `0 0 ${width} ${height}`, "aria-label": about, "font-family": variable("--sans"), fill: variable("--ink") };
    for (const [name, value] of Object.entries(attributes)) state.svg.setAttribute(name, value);
    state.svg.replaceChildren(...elements, state.over);
    state.back.hidden = state.zoom === null;
  }

  // --- The names of the series.

  function list(state) {
    state.names.replaceChildren(...state.series.filter((one) => one.name).map((one) => entry(state, one)));
  }

  function entry(state, one) {
    const picture = svg("svg", { width: 28, height: 16, "aria-hidden": "true" }, sample(one, variable("--panel")));
    const button = make("button", { type: "button", title: "Click: on or off. Double click: alone." }, picture, make("span", {}, one.name), make("i", {}, one.note ?? ""));
    button.setAttribute("aria-pressed", String(!state.hidden.has(one.name)));
    button.addEventListener("click", () => {
      if (!state.hidden.delete(one.name)) state.hidden.add(one.name);
      press(state);
    });
    button.addEventListener("dblclick", () => {
      const others = state.series.map(({ name }) => name).filter((name) => name && name !== one.name);
      // A second double click brings all back.
      const alone = !state.hidden.has(one.name) && others.every((name) => state.hidden.has(name));
      state.hidden = new Set(alone ? [] : others);
      press(state);
    });
    for (const [kind, pale] of [["pointerenter", true], ["focus", true], ["pointerleave", false], ["blur", false]]) {
      button.addEventListener(kind, () => dim(state, pale ? one.k : null));
    }
    return button;
  }

  function press(state) {
    const named = state.series.filter((one) => one.name);
    [...state.names.children].forEach((button, index) => button.setAttribute("aria-pressed", String(!state.hidden.has(named[index].name))));
    render(state);
  }

  // All but one series become pale, as long as its name is pointed at.
  function dim(state, k) {
    const known = k !== null && state.svg.querySelector(`[data-k="${k}"]`) !== null;
    for (const part of state.svg.querySelectorAll("[data-k]")) part.style.opacity = known && part.dataset.k !== String(k) ? 0.12 : "";
  }

  // --- Pointing, clicking, walking.

  function listen(state) {
    const on = (kind, task) => state.svg.addEventListener(kind, task);
    on("pointerdown", (event) => {
      if (event.button !== 0) return;
      state.start = position(state, event);
      // A finger scrolls the page; a mouse that leaves the figure goes on drawing its rectangle.
      if (event.pointerType !== "touch") state.svg.setPointerCapture(event.pointerId);
    });
    const zooms = (event) => event.pointerType !== "touch" && state.whole && dragged(state, event);
    on("pointermove", (event) => (zooms(event) ? stretch(state, event) : point(state, event)));
    on("pointerup", (event) => {
      if (zooms(event)) zoom(state, corners(state, event));
      else if (state.start && !dragged(state, event)) choose(state, near(state, ...position(state, event)));
      state.start = null;
    });
    for (const kind of ["pointercancel", "pointerleave"]) on(kind, () => { state.start = null; hide(state); });
    on("blur", () => hide(state));
    on("dblclick", () => zoom(state, null));
    state.element.addEventListener("keydown", (event) => walk(state, event));
  }

  // Where an event is, in the units of the drawing.
  function position(state, event) {
    const box = state.svg.getBoundingClientRect();
    return [((event.clientX - box.left) * state.width) / box.width, ((event.clientY - box.top) * state.height) / box.height];
  }

  function dragged(state, event) {
    if (!state.start) return false;
    const [x, y] = position(state, event);
    return Math.hypot(x - state.start[0], y - state.start[1]) >= DRAG;
  }

  // The nearest mark; of those at one place the uppermost.
  function near(state, x, y) {
    let [found, least] = [null, NEAR];
    for (const spot of state.spots) {
      const distance = Math.hypot(spot.x - x, spot.y - y);
      if (distance <= least) [found, least] = [spot, distance];
    }
    return found;
  }

  function point(state, event) {
    const spot = near(state, ...position(state, event));
    if (spot !== state.spot) show(state, spot);
  }

  function choose(state, spot) {
    if (!spot?.point.target || !state.open) return;
    hide(state);
    state.open(spot.point.target);
  }

  function hide(state) {
    show(state, null);
  }

  // A ring about the mark, and beside it its lines and the name of its series.
  function show(state, spot) {
    state.spot = spot;
    state.over.replaceChildren();
    state.svg.style.cursor = spot?.point.target ? "pointer" : "";
    state.tip.hidden = !spot;
    if (!spot) return;
    const { series, x, y } = spot;
    state.over.append(svg("circle", { cx: x, cy: y, r: 4 + series.mark.size / 2, fill: "none", stroke: variable("--ink"), "stroke-width": 1.5 }));
    const picture = svg("svg", { width: 28, height: 16, "aria-hidden": "true" }, sample(series, variable("--panel")));
    const lines = (spot.point.tip ?? []).map((words, index) => make("div", {}, index === 0 ? make("b", {}, words) : words));
    state.tip.replaceChildren(...lines, make("div", { className: "chart-whose" }, picture, series.name));
    // Right of the mark and above it, on the other side where there is no room.
    const { offsetWidth: width, offsetHeight: height } = state.tip;
    state.tip.style.left = `${Math.max(0, x + 14 + width <= state.width ? x + 14 : x - 14 - width)}px`;
    state.tip.style.top = `${y - 10 - height >= 0 ? y - 10 - height : y + 14}px`;
  }

  // Arrows along a series, and to the nearest mark of the next one; Enter opens, Escape goes back to the whole.
  function walk(state, event) {
    if (event.key === "Escape" && state.zoom) {
      zoom(state, null);
    } else if (event.key === "Escape") {
      hide(state);
    } else if (event.target === state.svg && event.key === "Enter") {
      choose(state, state.spot);
    } else if (event.target === state.svg && event.key.startsWith("Arrow")) {
      event.preventDefault();
      const next = neighbour(state, event.key);
      if (next) show(state, next);
    }
  }

  function neighbour(state, key) {
    const { spot, spots } = state;
    if (!spot) return spots[0];
    const forward = key === "ArrowRight" || key === "ArrowDown" ? 1 : -1;
    if (key === "ArrowRight" || key === "ArrowLeft") {
      const own = spots.filter(({ series }) => series === spot.series).sort((a, b) => a.x - b.x);
      return own[own.indexOf(spot) + forward];
    }
    const series = [...new Set(spots.map((one) => one.series))];
    const other = series[series.indexOf(spot.series) + forward];
    return spots.filter((one) => one.series === other).sort((a, b) => Math.abs(a.x - spot.x) - Math.abs(b.x - spot.x))[0];
  }

  // --- Zoom.

  // The rectangle from where the drag began, inside the box; a thin one goes over all of the box in the other direction.
  function corners(state, event) {
    const { box } = state.whole;
    const [x, y] = position(state, event);
    const within = (value, least, most) => Math.min(Math.max(value, least), most);
    const between = (a, b, least, most) => (Math.abs(a - b) < THIN ? [least, most] : [a, b].map((value) => within(value, least, most)).sort((one, other) => one - other));
    const [left, right] = between(state.start[0], x, box.left, box.right);
    const [top, bottom] = between(state.start[1], y, box.top, box.bottom);
    return { left, right, top, bottom };
  }

  function stretch(state, event) {
    hide(state);
    const { left, right, top, bottom } = corners(state, event);
    state.over.append(svg("rect", { class: "zoom", x: left, y: top, width: right - left, height: bottom - top, fill: variable("--accent"), "fill-opacity": 0.12, stroke: variable("--accent") }));
  }

  // To a rectangle on the screen, or back to the whole.
  function zoom(state, rectangle) {
    if (rectangle) {
      const { x, y } = state.whole;
      const wanted = { x: [x.back(rectangle.left), x.back(rectangle.right)], y: [y.back(rectangle.bottom), y.back(rectangle.top)] };
      // Beyond a millionth of the range numbers and labels are rounding alone.
      const enough = (range) => range[1] - range[0] > 1e-6 * Math.max(1, Math.abs(range[0]));
      if (enough(wanted.x) && enough(wanted.y)) state.zoom = wanted;
    } else {
      state.zoom = null;
    }
    render(state);
  }

  // --- The figure as a file.

  // The drawing with its names on the right, on paper of the page's colour: it needs nothing of the page.
  function figure(state) {
    const series = state.series.filter((one) => one.name && !state.hidden.has(one.name));
    const widest = (texts) => Math.max(0, ...texts.map((words) => measure([words ?? ""], NAMES)));
    const notes = widest(series.map((one) => one.note));
    const side = 40 + widest(series.map((one) => one.name)) + (notes > 0 ? notes + 14 : 0);
    const edge = 16;
    const [width, height] = [state.width + side + 2 * edge, Math.max(state.height, 50 + 21 * series.length) + 2 * edge].map(Math.ceil);
    const copy = state.svg.cloneNode(true);
    copy.querySelector(".over").remove();
    for (const name of ["tabindex", "style"]) copy.removeAttribute(name);
    for (const [name, value] of Object.entries({ width, height, viewBox: `${-edge} ${-edge} ${width} ${height}` })) copy.setAttribute(name, value);
    copy.prepend(svg("title", {}, state.svg.getAttribute("aria-label")), svg("rect", { x: -edge, y: -edge, width, height, fill: variable("--panel") }));
    series.forEach((one, index) => {
      const row = svg("g", { transform: `translate(${state.width} ${34 + 21 * index})` }, sample(one, variable("--panel")));
      row.append(text([one.name], 34, 12, { "font-size": NAMES }));
      if (one.note) row.append(text([one.note], side, 12, { "font-size": NAMES, "font-style": "italic", "text-anchor": "end", fill: variable("--soft") }));
      copy.append(row);
    });
    return new XMLSerializer().serializeToString(copy);
  }

  function save(state) {
    const address = URL.createObjectURL(new Blob([figure(state)], { type: "image/svg+xml" }));
    make("a", { href: address, download: `featherbench-${state.element.id}.svg` }).click();
    setTimeout(() => URL.revokeObjectURL(address), 1000);
  }

  return Object.assign(chart, { figure: (element) => figure(charts.get(element)) });
})();
