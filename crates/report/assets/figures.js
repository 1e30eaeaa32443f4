// Error against depth, and time against size.
featherbench.ready(() => {
  const { byId, chunks, short, variable } = featherbench;
  const { choices, colour, dash, draw, exponent, fitted, joined, layout, least, live, symbol } = featherbench.plots;
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
    const series = [];
    for (const trace of plot.traces) {
      const index = methods.get(trace.engine) ?? 0;
      methods.set(trace.engine, index + 1);
      // A model's worst row.
      const worst = new Map();
      for (const [model, pointCase, value, bound] of trace.points) {
        const about = overview.models[model];
        if ((family !== "" && about.family !== family) || (kind !== "" && pointCase !== kind)) continue;
        if (bound !== null) gates.set(about.depth, Math.min(bound, gates.get(about.depth) ?? Infinity));
        if (!worst.has(model) || worst.get(model).value < value) worst.set(model, { model, depth: about.depth, kind: pointCase, value, bound });
      }
      if (worst.size === 0) continue;
      const points = [...worst.values()].sort((a, b) => a.depth - b.depth || a.value - b.value);
      const name = joined(overview.engines[trace.engine], trace.method, trace.scalar === "f64" ? "" : trace.scalar);
      const envelope = new Map(points.map((point) => [point.depth, least(point.value)]));
      series.push({
        name, ink: colour(trace.engine), mark: { symbol: symbol(index), size: 8, opacity: 0.9 }, line: { width: 1.2, dash: dash(index), opacity: 0.6, path: [...envelope] },
        points: points.map((point) => ({
          x: point.depth, y: least(point.value), hollow: point.value === 0,
          tip: [`${overview.models[point.model].name}, depth ${point.depth}`, short(point.value) + (point.bound === null ? "" : `, gate ${short(point.bound)}`), point.kind].filter(Boolean),
          target: {
            model: point.model,
            filters: { study: "agreement", engine: overview.engines[trace.engine], quantity: plot.quantity, metric: plot.metric, states: point.kind, method: trace.method },
          },
        })),
      });
    }
    if (gates.size > 0) {
      const depths = [...gates.keys()].sort((a, b) => a - b);
      series.push({
        name: "gate", ink: variable("--ink"), line: { width: 1.5, dash: "dash" }, mark: { symbol: "tick", size: depths.length > 1 ? 9 : 16 },
        points: depths.map((depth) => ({ x: depth, y: gates.get(depth), tip: [`gate ${short(gates.get(depth))}`, `the tightest at depth ${depth}`] })),
      });
    }
    series.push({ name: "2⁻⁵³", ink: variable("--soft"), guide: HALF_ULP, line: { width: 1.2, dash: "dot" } });
    draw("depth-plot", series, layout("depth: joints from the base to the farthest leaf", plot.title, true));
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
    const series = [];
    const styles = new Map();
    const per = (point, ns) => (joint && ns !== null ? ns / point.joints : ns);
    // The interval of the median where the run has it, its deciles otherwise.
    const end = (point, ...keys) => per(point, keys.map((key) => point[key]).find((ns) => ns !== null) ?? null);
    for (const line of lines) {
      // Lines of one colour are told apart by dashes and symbols, whether they differ in engine, method or family.
      const ink = colour(algorithms.indexOf(line.algorithm));
      const style = styles.get(ink) ?? 0;
      styles.set(ink, style + 1);
      const name = joined(engines.size > 1 ? overview.engines[line.engine] : "", line.algorithm, line.method === line.algorithm ? "" : line.method,
        families.length > 1 ? line.family : "", line.scalar === "f64" ? "" : line.scalar);
      const fit = joint ? line.per_joint : line.per_call;
      const ends = [line.points[0].size, line.points[line.points.length - 1].size];
      series.push({
        name, note: exponent(fit?.slope), ink, line: { width: 1.2, dash: dash(style) }, mark: { symbol: symbol(style), size: 8 },
        broad: fit && byId("time-fit").checked ? fitted(fit, ends) : [],
        points: line.points.map((point) => ({
          x: point.size, y: per(point, point.ns), low: end(point, "low", "p10"), high: end(point, "high", "p90"), symbol: point.estimated ? "cross" : undefined, hollow: !point.valid,
          tip: [`${overview.models[point.model].name}, nv ${point.size}`, `${short(point.ns)} ns per call`, `${short(point.ns / point.joints)} ns per joint`, point.estimated ? "estimate" : "", point.valid ? "" : "does not count"].filter(Boolean),
          target: { model: point.model, filters: { study: "timing", engine: overview.engines[line.engine], quantity: line.algorithm, cache: line.cache } },
        })),
      });
    }
    draw("time-plot", series, layout("degrees of freedom nv", joint ? "ns per joint" : "ns per call"));
  }

  if (byId("depth-plot")) {
    const used = figures.errors.flatMap((plot) => plot.traces.flatMap((trace) => trace.points));
    choices(byId("depth-family"), new Set(used.map(([model]) => overview.models[model].family)));
    choices(byId("depth-case"), new Set(used.map(([, kind]) => kind)));
    live(drawDepth, "depth-quantity", "depth-family", "depth-case");
  }
  if (byId("time-plot")) live(drawTime, "time-unit", "time-case", "time-family", "time-fit");
});
