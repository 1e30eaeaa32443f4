// Work–precision and conditioning.
featherbench.ready(() => {
  const { byId, chunks, short, variable } = featherbench;
  const { colour, dash, draw, exponent, joined, layout, least, live, symbol } = featherbench.plots;
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
    const range = (values) => { const logs = values.map(Math.log10); return [10 ** (Math.min(...logs) - 0.3), 10 ** (Math.max(...logs) + 0.5)]; };
    const across = range(points.flatMap((point) => [point.ns, point.p90 ?? point.ns]));
    const up = range(points.flatMap((point) => [point.error, point.q1 ?? point.error, point.q3 ?? point.error]).map(least));
    // The front goes on to the edges: as slow as one likes at the least error, as wrong as one likes at the least time.
    const corners = front.map((point) => [point.ns, least(point.error)]);
    const edges = front.length > 0 ? [[corners[0][0], up[1]], ...corners, [across[1], corners[corners.length - 1][1]]] : [];
    const series = [{ name: "front", ink: variable("--ink"), line: { width: 6, step: true, opacity: 0.16, path: edges } }];
    const methods = new Map();
    for (const point of points) {
      const index = methods.get(point.engine) ?? 0;
      methods.set(point.engine, index + 1);
      const name = joined(overview.engines[point.engine], point.method, point.scalar === "f64" ? "" : point.scalar);
      series.push({
        name, ink: colour(point.engine), mark: { size: point.front ? 12 : 9, symbol: symbol(index) },
        points: [{
          x: point.ns, y: least(point.error), left: point.p10, right: point.p90, low: least(point.q1), high: least(point.q3), hollow: !point.front, label: point.method, soft: !point.front,
          tip: [name, `${short(point.ns)} ns per call`, `median error ${short(point.error)}`, point.front ? "unbeaten" : ""].filter(Boolean),
          target: { model, filters: { engine: overview.engines[point.engine], method: point.method, quantity: "fd" } },
        }],
      });
    }
    const shape = layout("ns per call", "median relative error of forward dynamics", true);
    [shape.x.range, shape.y.range] = [across, up];
    draw("tradeoff-plot", series, shape);
  }

  // --- Conditioning: κ on the left, what it would excuse and what is unavoidable on the right.

  function line(family, index, key, label, fit, style, scale) {
    const points = family.points.filter((point) => point[key] !== null);
    return {
      name: joined(label, figures.conditions.length > 1 ? family.name : ""), note: exponent(fit?.slope), ink: key === "floor" ? variable("--ink") : colour(style),
      line: { width: 1.4, dash: dash(index) }, mark: { size: 8, symbol: symbol(style) },
      points: points.map((point) => ({
        x: point.size, y: scale * point[key], tip: [overview.models[point.model].name, short(scale * point[key])], target: { model: point.model, filters: { study: "conditioning" } },
      })),
    };
  }

  function drawConditions() {
    const [left, right] = [[], []];
    figures.conditions.forEach((family, index) => {
      left.push(line(family, index, "raw", "κ(M)", family.raw, 0, 1), line(family, index, "scaled", "κ scaled", family.scaled, 1, 1));
      right.push(line(family, index, "raw", "κ(M)·2⁻⁵³", null, 0, HALF_ULP), line(family, index, "scaled", "κ scaled·2⁻⁵³", null, 1, HALF_ULP), line(family, index, "floor", "conditioning bound", null, 2, 1));
    });
    for (const [id, series, title] of [["conditioning-plot", left, "condition number"], ["floor-plot", right, "relative error"]]) {
      const shape = layout("degrees of freedom n", title);
      const places = new Set(figures.conditions.flatMap((family) => family.points.map((point) => point.size)));
      shape.x.ticks = [...places].sort((a, b) => a - b).map((size) => [size, String(size)]);
      draw(id, series, shape);
    }
  }

  if (byId("tradeoff-plot")) live(drawTradeoff, "tradeoff-model");
  if (byId("conditioning-plot")) live(drawConditions);
});
