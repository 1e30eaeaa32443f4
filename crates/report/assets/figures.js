// The plots. They are drawn anew when a choice or the theme changes; a click on a mark opens its rows.
featherbench.ready(() => {
  const { byId, chunks, short, variable, make } = featherbench;
  const overview = chunks.get("overview");
  const figures = chunks.get("figures");
  if (!overview || !figures) return;

  const SYMBOLS = ["circle", "square", "diamond", "triangle-up", "cross", "star", "pentagon", "hexagram"];
  const DASHES = ["solid", "dash", "dot", "dashdot", "longdash", "longdashdot"];
  const COLOURS = 8;
  const HALF_ULP = 2 ** -53;
  const ZERO = 1e-18;
  const colour = (index) => variable(`--series-${index % COLOURS}`);
  // The plotting script reads a little markup in its texts: names are data and must stay text.
  const plain = (text) => String(text).replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");
  const joined = (...parts) => plain(parts.filter(Boolean).join(" · "));

  function layout(x, y) {
    const axis = (title) => ({
      title: { text: title, standoff: 12 }, type: "log", exponentformat: "power", gridcolor: variable("--line"), zeroline: false,
      linecolor: variable("--soft"), ticks: "outside", tickcolor: variable("--soft"), minor: { ticks: "outside", ticklen: 2, tickcolor: variable("--line") },
    });
    return {
      paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
      font: { family: variable("--sans"), size: 13, color: variable("--ink") },
      margin: { l: 76, r: 16, t: 34, b: 56 },
      modebar: { bgcolor: "rgba(0,0,0,0)", color: variable("--soft"), activecolor: variable("--accent") },
      hovermode: "closest", hoverlabel: { bgcolor: variable("--panel"), bordercolor: variable("--line"), font: { color: variable("--ink") }, align: "left" },
      legend: innerWidth < 760 ? { orientation: "h", y: -0.22 } : { x: 1.01, y: 1 },
      xaxis: { ...axis(x), dtick: undefined }, yaxis: axis(y),
    };
  }

  function draw(id, traces, shape) {
    const element = byId(id);
    if (typeof Plotly === "undefined") {
      element.replaceChildren(make("p", { className: "empty" }, "plotly.min.js is missing: the plot cannot be drawn."));
      return;
    }
    const config = { responsive: true, displaylogo: false, modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"] };
    Plotly.react(element, traces, shape, config);
    if (!element.dataset.live) {
      element.dataset.live = "yes";
      element.on("plotly_click", (event) => {
        const target = event.points[0]?.customdata;
        if (target) featherbench.open(`model-${target.model}`, target.filters, overview.models[target.model].name);
      });
    }
  }

  function choices(select, values) {
    for (const value of values) if (value !== "") select.append(make("option", { value }, value));
  }

  // --- Error against depth.

  function drawDepth() {
    const plot = figures.errors[byId("depth-quantity").value];
    const family = byId("depth-family").value;
    const kind = byId("depth-case").value;
    const gates = new Map();
    const methods = new Map();
    const traces = [];
    let deepest = 1;
    for (const trace of plot.traces) {
      const index = methods.get(trace.engine) ?? 0;
      methods.set(trace.engine, index + 1);
      // A model's worst row.
      const worst = new Map();
      for (const [model, pointCase, value, bound] of trace.points) {
        const about = overview.models[model];
        if ((family !== "" && about.family !== family) || (kind !== "" && pointCase !== kind)) continue;
        deepest = Math.max(deepest, about.depth);
        if (bound !== null) gates.set(about.depth, Math.min(bound, gates.get(about.depth) ?? Infinity));
        if (!worst.has(model) || worst.get(model).value < value) worst.set(model, { model, depth: about.depth, kind: pointCase, value, bound });
      }
      if (worst.size === 0) continue;
      const points = [...worst.values()].sort((a, b) => a.depth - b.depth || a.value - b.value);
      const name = joined(overview.engines[trace.engine], trace.method, trace.scalar === "f64" ? "" : trace.scalar);
      const envelope = new Map(points.map((point) => [point.depth, Math.max(point.value, ZERO)]));
      traces.push({
        x: [...envelope.keys()], y: [...envelope.values()], mode: "lines", hoverinfo: "skip", showlegend: false, legendgroup: name,
        line: { color: colour(trace.engine), width: 1.2, dash: DASHES[index % DASHES.length] }, opacity: 0.55,
      });
      traces.push({
        name, legendgroup: name, mode: "markers", type: "scatter",
        x: points.map((point) => point.depth), y: points.map((point) => Math.max(point.value, ZERO)),
        marker: {
          color: colour(trace.engine), size: 8, opacity: 0.85, line: { width: 1, color: colour(trace.engine) },
          symbol: points.map((point) => SYMBOLS[index % SYMBOLS.length] + (point.value === 0 ? "-open" : "")),
        },
        text: points.map((point) => `<b>${plain(overview.models[point.model].name)}</b> depth ${point.depth}<br>${short(point.value)}`
          + (point.bound === null ? "" : `, gate ${short(point.bound)}`) + `<br>${plain(point.kind)}`),
        hovertemplate: `%{text}<extra>${name}</extra>`,
        customdata: points.map((point) => ({
          model: point.model,
          filters: { study: "agreement", engine: overview.engines[trace.engine], quantity: plot.quantity, metric: plot.metric, case: point.kind, method: trace.method },
        })),
      });
    }
    if (gates.size > 0) {
      const depths = [...gates.keys()].sort((a, b) => a - b);
      traces.push({ name: "gate", x: depths, y: depths.map((depth) => gates.get(depth)), mode: depths.length > 1 ? "lines" : "markers",
        line: { color: variable("--ink"), width: 1.5, dash: "dash" }, marker: { color: variable("--ink"), symbol: "line-ew-open", size: 16 }, hovertemplate: "gate %{y:.2g}<extra></extra>" });
    }
    traces.push({ name: "2⁻⁵³", x: [1, Math.max(deepest, 2)], y: [HALF_ULP, HALF_ULP], mode: "lines", hoverinfo: "skip", line: { color: variable("--soft"), width: 1, dash: "dot" } });
    draw("depth-plot", traces, layout("depth: joints from the base to the farthest leaf", plain(plot.title)));
  }

  // --- Time against size.

  function drawTime() {
    const joint = byId("time-unit").value === "joint";
    const kind = byId("time-case").value;
    const family = byId("time-family").value;
    const lines = figures.times.filter((line) => line.case === kind && (family === "" || line.family === family));
    const algorithms = [...new Set(figures.times.map((line) => line.algorithm))];
    const families = [...new Set(lines.map((line) => line.family))];
    const engines = new Set(lines.map((line) => line.engine));
    const traces = [];
    for (const line of lines) {
      const per = (point, ns) => (joint ? ns / point.joints : ns);
      const style = families.indexOf(line.family);
      const ink = colour(algorithms.indexOf(line.algorithm));
      const name = joined(engines.size > 1 ? overview.engines[line.engine] : "", line.algorithm, line.method === line.algorithm ? "" : line.method,
        families.length > 1 ? line.family : "", line.scalar === "f64" ? "" : line.scalar);
      const fit = joint ? line.per_joint : line.per_call;
      const spread = line.points.some((point) => point.p10 !== null && point.p90 !== null);
      const bar = (end) => line.points.map((point) => Math.max(0, end(point)));
      traces.push({
        name: fit ? `${name}  <i>p = ${fit.slope.toFixed(2)}</i>` : name, legendgroup: name, mode: "markers+lines",
        x: line.points.map((point) => point.size), y: line.points.map((point) => per(point, point.ns)),
        line: { color: ink, width: 1, dash: DASHES[style % DASHES.length] }, marker: { color: ink, size: 7, symbol: SYMBOLS[style % SYMBOLS.length] },
        error_y: spread ? {
          type: "data", symmetric: false, thickness: 1, width: 2, color: ink,
          array: bar((point) => (point.p90 === null ? 0 : per(point, point.p90 - point.ns))),
          arrayminus: bar((point) => (point.p10 === null ? 0 : per(point, point.ns - point.p10))),
        } : undefined,
        text: line.points.map((point) => `<b>${plain(overview.models[point.model].name)}</b> nv ${point.size}<br>${short(point.ns)} ns per call<br>${short(point.ns / point.joints)} ns per joint`),
        hovertemplate: `%{text}<extra>${name}</extra>`,
        customdata: line.points.map((point) => ({ model: point.model, filters: { study: "timing", engine: overview.engines[line.engine], quantity: line.algorithm, case: line.case } })),
      });
      if (fit && byId("time-fit").checked) {
        const ends = [line.points[0].size, line.points[line.points.length - 1].size];
        traces.push({ x: ends, y: ends.map((size) => 10 ** (fit.intercept + fit.slope * Math.log10(size))), mode: "lines", hoverinfo: "skip",
          showlegend: false, legendgroup: name, line: { color: ink, width: 5 }, opacity: 0.18 });
      }
    }
    draw("time-plot", traces, layout("degrees of freedom nv", joint ? "ns per joint" : "ns per call"));
  }

  const plots = [];
  if (byId("depth-plot")) {
    const used = figures.errors.flatMap((plot) => plot.traces.flatMap((trace) => trace.points));
    choices(byId("depth-family"), new Set(used.map(([model]) => overview.models[model].family)));
    choices(byId("depth-case"), new Set(used.map(([, kind]) => kind)));
    plots.push(drawDepth);
    for (const id of ["depth-quantity", "depth-family", "depth-case"]) byId(id).addEventListener("change", drawDepth);
  }
  if (byId("time-plot")) {
    plots.push(drawTime);
    for (const id of ["time-unit", "time-case", "time-family", "time-fit"]) byId(id).addEventListener("change", drawTime);
  }
  const drawAll = () => plots.forEach((plot) => plot());
  document.addEventListener("themechange", drawAll);
  drawAll();
});
