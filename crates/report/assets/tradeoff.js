// Work–precision and conditioning.
featherbench.ready(() => {
  const { byId, chunks, short, variable } = featherbench;
  const { ZERO, bars, colour, dash, draw, joined, layout, live, plain, symbol } = featherbench.plots;
  const overview = chunks.get("overview");
  const figures = chunks.get("figures");
  if (!overview || !figures) return;

  const HALF_ULP = 2 ** -53;

  // --- Work–precision: one model's methods, the unbeaten ones filled and joined.

  function drawTradeoff() {
    const model = Number(byId("tradeoff-model").value);
    const points = figures.tradeoffs.filter((point) => point.model === model);
    const front = points.filter((point) => point.front);
    // Room for the names, and for what would otherwise be one point on an axis without length.
    const range = (values) => { const logs = values.map(Math.log10); return [Math.min(...logs) - 0.3, Math.max(...logs) + 0.5]; };
    const across = range(points.flatMap((point) => [point.ns, point.p90 ?? point.ns]));
    const up = range(points.flatMap((point) => [point.error, point.q1 ?? point.error, point.q3 ?? point.error]).map((error) => Math.max(error, ZERO)));
    // The front goes on to the edges: as slow as one likes at the least error, as wrong as one likes at the least time.
    const traces = [{
      name: "front", mode: "lines", hoverinfo: "skip", line: { color: variable("--ink"), width: 6, shape: "hv" }, opacity: 0.16,
      x: [front[0].ns, ...front.map((point) => point.ns), 10 ** across[1]],
      y: [10 ** up[1], ...front.map((point) => Math.max(point.error, ZERO)), Math.max(front[front.length - 1].error, ZERO)],
    }];
    const methods = new Map();
    for (const point of points) {
      const index = methods.get(point.engine) ?? 0;
      methods.set(point.engine, index + 1);
      const ink = colour(point.engine);
      const name = joined(overview.engines[point.engine], point.method, point.scalar === "f64" ? "" : point.scalar);
      traces.push({
        name, x: [point.ns], y: [Math.max(point.error, ZERO)], mode: "markers+text", text: [plain(point.method)], textposition: "top right",
        textfont: { color: variable(point.front ? "--ink" : "--soft") },
        marker: { color: ink, size: point.front ? 13 : 9, symbol: symbol(index) + (point.front ? "" : "-open"), line: { width: 1.5, color: ink } },
        error_x: bars([point], (at) => at.p10, (at) => at.ns, (at) => at.p90, ink),
        error_y: bars([point], (at) => at.q1, (at) => at.error, (at) => at.q3, ink),
        hovertemplate: `<b>${name}</b><br>${short(point.ns)} ns per call<br>median error ${short(point.error)}${point.front ? "<br>unbeaten" : ""}<extra></extra>`,
        customdata: [{ model, filters: { engine: overview.engines[point.engine], method: point.method, quantity: "fd" } }],
      });
    }
    const shape = layout("ns per call", "median relative error of forward dynamics");
    [shape.xaxis.range, shape.yaxis.range] = [across, up];
    for (const axis of [shape.xaxis, shape.yaxis]) if (axis.range[1] - axis.range[0] < 2.5) axis.dtick = "D2";
    draw("tradeoff-plot", traces, shape);
  }

  // --- Conditioning: κ on the left, what it would excuse and what is unavoidable on the right.

  function line(family, index, key, label, fit, style, scale) {
    const points = family.points.filter((point) => point[key] !== null);
    const ink = key === "floor" ? variable("--ink") : colour(style);
    const name = joined(label, figures.conditions.length > 1 ? family.name : "");
    return {
      name: fit ? `${name}  <i>p = ${fit.slope.toFixed(2)}</i>` : name, mode: "markers+lines",
      x: points.map((point) => point.size), y: points.map((point) => scale * point[key]),
      line: { color: ink, width: 1.4, dash: dash(index) }, marker: { color: ink, size: 8, symbol: symbol(style) },
      text: points.map((point) => `<b>${plain(overview.models[point.model].name)}</b><br>${short(scale * point[key])}`), hovertemplate: `%{text}<extra>${name}</extra>`,
      customdata: points.map((point) => ({ model: point.model, filters: { study: "conditioning" } })),
    };
  }

  function drawConditions() {
    const [left, right] = [[], []];
    figures.conditions.forEach((family, index) => {
      left.push(line(family, index, "raw", "κ(M)", family.raw, 0, 1), line(family, index, "scaled", "κ scaled", family.scaled, 1, 1));
      right.push(line(family, index, "raw", "κ(M)·2⁻⁵³", null, 0, HALF_ULP), line(family, index, "scaled", "κ scaled·2⁻⁵³", null, 1, HALF_ULP), line(family, index, "floor", "structured floor", null, 2, 1));
    });
    for (const [id, traces, title] of [["conditioning-plot", left, "condition number"], ["floor-plot", right, "relative error"]]) {
      const shape = layout("degrees of freedom n", title);
      const places = [...new Set(figures.conditions.flatMap((family) => family.points.map((point) => point.size)))];
      Object.assign(shape.xaxis, { tickvals: places, ticktext: places.map(String) });
      shape.legend = { orientation: "h", y: 1.02, yanchor: "bottom", x: 0 };
      draw(id, traces, shape);
    }
  }

  if (byId("tradeoff-plot")) live(drawTradeoff, "tradeoff-model");
  if (byId("conditioning-plot")) live(drawConditions);
});
