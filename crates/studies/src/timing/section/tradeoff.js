// Work–precision.
featherbench.ready(() => {
  const { byId, chunks, short, variable } = featherbench;
  const { ink, draw, joined, layout, least, live, mark } = featherbench.plots;
  const overview = chunks.get("overview");
  const methods = chunks.get("figures")?.tradeoff;
  if (!overview || !methods || !byId("tradeoff-plot")) return;

  // One robot's methods, the unbeaten ones filled and joined.

  function drawTradeoff() {
    const robot = Number(byId("tradeoff-robot").value);
    const points = methods.filter((point) => point.robot === robot);
    const front = points.filter((point) => point.front);
    // Room for the names, and for what would otherwise be one point on an axis without length.
    const range = (values) => { const logs = values.map(Math.log10); return [10 ** (Math.min(...logs) - 0.3), 10 ** (Math.max(...logs) + 0.5)]; };
    const across = range(points.flatMap((point) => [point.ns, point.p90 ?? point.ns]));
    const up = range(points.flatMap((point) => [point.error, point.q1 ?? point.error, point.q3 ?? point.error]).map(least));
    // The front goes on to the edges: as slow as one likes at the least error, as wrong as one likes at the least time.
    const corners = front.map((point) => [point.ns, least(point.error)]);
    const edges = front.length > 0 ? [[corners[0][0], up[1]], ...corners, [across[1], corners[corners.length - 1][1]]] : [];
    const series = [{ name: "front", ink: variable("--ink"), line: { width: 6, step: true, opacity: 0.16, path: edges } }];
    const marks = new Map();
    for (const point of points) {
      const index = marks.get(point.engine) ?? 0;
      marks.set(point.engine, index + 1);
      const name = joined(overview.engines[point.engine], point.method, point.scalar === "f64" ? "" : point.scalar);
      series.push({
        name, ink: ink(point.engine), mark: { size: point.front ? 12 : 9, symbol: mark(point.engine, index) },
        points: [{
          x: point.ns, y: least(point.error), left: point.p10, right: point.p90, low: least(point.q1), high: least(point.q3), hollow: !point.front, label: point.method, soft: !point.front,
          tip: [name, `${short(point.ns)} ns per call`, `median error ${short(point.error)}`, point.front ? "unbeaten" : ""].filter(Boolean),
          target: { robot, filters: { engine: overview.engines[point.engine], method: point.method, quantity: "fd" } },
        }],
      });
    }
    const shape = layout("ns per call", "median relative error of forward dynamics", true);
    [shape.x.range, shape.y.range] = [across, up];
    draw("tradeoff-plot", series, shape);
  }

  live(drawTradeoff, "tradeoff-robot");
});
