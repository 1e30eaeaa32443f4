// Error against depth, and time against size.
featherbench.ready(() => {
  const { byId, chunks, short, variable } = featherbench;
  const { ZERO, bars, choices, colour, dash, draw, fitted, joined, layout, live, plain, symbol } = featherbench.plots;
  const overview = chunks.get("overview");
  const figures = chunks.get("figures");
  if (!overview || !figures) return;

  const HALF_ULP = 2 ** -53;

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
        line: { color: colour(trace.engine), width: 1.2, dash: dash(index) }, opacity: 0.55,
      });
      traces.push({
        name, legendgroup: name, mode: "markers", type: "scatter",
        x: points.map((point) => point.depth), y: points.map((point) => Math.max(point.value, ZERO)),
        marker: {
          color: colour(trace.engine), size: 8, opacity: 0.85, line: { width: 1, color: colour(trace.engine) },
          symbol: points.map((point) => symbol(index) + (point.value === 0 ? "-open" : "")),
        },
        text: points.map((point) => `<b>${plain(overview.models[point.model].name)}</b> depth ${point.depth}<br>${short(point.value)}`
          + (point.bound === null ? "" : `, gate ${short(point.bound)}`) + `<br>${plain(point.kind)}`),
        hovertemplate: `%{text}<extra>${name}</extra>`,
        customdata: points.map((point) => ({
          model: point.model,
          filters: { study: "agreement", engine: overview.engines[trace.engine], quantity: plot.quantity, metric: plot.metric, states: point.kind, method: trace.method },
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
    const lines = figures.times.filter((line) => line.cache === kind && (family === "" || line.family === family));
    const algorithms = [...new Set(figures.times.map((line) => line.algorithm))];
    const families = [...new Set(lines.map((line) => line.family))];
    const engines = new Set(lines.map((line) => line.engine));
    const traces = [];
    for (const line of lines) {
      const per = (point, ns) => (joint ? ns / point.joints : ns);
      // Several engines are told apart by their dashes, as several families are.
      const style = engines.size > 1 ? [...engines].indexOf(line.engine) : families.indexOf(line.family);
      const ink = colour(algorithms.indexOf(line.algorithm));
      const name = joined(engines.size > 1 ? overview.engines[line.engine] : "", line.algorithm, line.method === line.algorithm ? "" : line.method,
        families.length > 1 ? line.family : "", line.scalar === "f64" ? "" : line.scalar);
      const fit = joint ? line.per_joint : line.per_call;
      traces.push({
        name: fit ? `${name}  <i>p = ${fit.slope.toFixed(2)}</i>` : name, legendgroup: name, mode: "markers+lines",
        x: line.points.map((point) => point.size), y: line.points.map((point) => per(point, point.ns)),
        line: { color: ink, width: 1, dash: dash(style) }, marker: { color: ink, size: 7, symbol: line.points.map((point) => (point.estimated ? "x" : symbol(style)) + (point.valid ? "" : "-open")) },
        error_y: bars(line.points, ...[["low", "p10"], ["ns"], ["high", "p90"]].map((keys) => (point) => { const found = keys.map((key) => point[key]).find((ns) => ns !== null); return found === undefined ? null : per(point, found); }), ink),
        text: line.points.map((point) => `<b>${plain(overview.models[point.model].name)}</b> nv ${point.size}<br>${short(point.ns)} ns per call<br>${short(point.ns / point.joints)} ns per joint`),
        hovertemplate: `%{text}<extra>${name}</extra>`,
        customdata: line.points.map((point) => ({ model: point.model, filters: { study: "timing", engine: overview.engines[line.engine], quantity: line.algorithm, cache: line.cache } })),
      });
      if (fit && byId("time-fit").checked) {
        traces.push(fitted(fit, [line.points[0].size, line.points[line.points.length - 1].size], ink, name));
      }
    }
    draw("time-plot", traces, layout("degrees of freedom nv", joint ? "ns per joint" : "ns per call"));
  }

  if (byId("depth-plot")) {
    const used = figures.errors.flatMap((plot) => plot.traces.flatMap((trace) => trace.points));
    choices(byId("depth-family"), new Set(used.map(([model]) => overview.models[model].family)));
    choices(byId("depth-case"), new Set(used.map(([, kind]) => kind)));
    live(drawDepth, "depth-quantity", "depth-family", "depth-case");
  }
  if (byId("time-plot")) live(drawTime, "time-unit", "time-case", "time-family", "time-fit");
});
