// Scaling: time, memory and error against size, and the ratio of our two ways to forward dynamics.
featherbench.ready(() => {
  const { byId, chunks, short, variable } = featherbench;
  const { colour, ink, dash, draw, exponent, joined, layout, least, live, symbol } = featherbench.plots;
  const overview = chunks.get("overview");
  const scaling = chunks.get("figures")?.scaling;
  if (!overview || !scaling || !byId("scaling-time")) return;

  const FORWARD = "fd";

  // Engines by colour, their methods by symbol and dash.
  function drawn(series, key, scale, note) {
    const methods = new Map();
    return series.map((one) => {
      const style = methods.get(one.engine) ?? 0;
      methods.set(one.engine, style + 1);
      const points = one.points.filter((point) => point[key] !== null);
      return {
        name: joined(overview.engines[one.engine], one.method), note: note(one), ink: ink(one.engine),
        line: { width: 1.4, dash: dash(style) }, mark: { size: 8, symbol: symbol(style) },
        points: points.map((point) => ({
          x: point.size, y: scale(point[key]), low: key === "seconds" ? point.low : null, high: key === "seconds" ? point.high : null,
          symbol: key === "seconds" && point.estimated ? "cross" : undefined, hollow: key === "seconds" && !point.valid,
          tip: [overview.robots[point.robot].name, `${key} ${short(point[key])}`, key !== "seconds" ? "" : point.estimated ? "estimate" : point.valid ? "" : "does not count"].filter(Boolean),
          target: { robot: point.robot, filters: { study: "growth", engine: overview.engines[one.engine], method: one.method, quantity: one.quantity } },
        })),
      };
    });
  }

  function drawScaling() {
    const line = byId("scaling-line").value;
    const quantity = byId("scaling-quantity").value;
    const of = (name) => scaling.series.filter((one) => one.line === line && one.quantity === name);
    const size = "degrees of freedom n";
    draw("scaling-time", drawn(of(quantity), "seconds", (value) => value, (one) => exponent(one.exponent?.[0])), layout(size, "seconds per call"));
    draw("scaling-memory", drawn(of(quantity), "resident", (value) => value, () => ""), layout(size, "resident memory, B"));
    draw("scaling-error", drawn(of(FORWARD), "error", least, () => ""), layout(size, "relative error of forward dynamics", true));
    drawRatios(line, quantity);
  }

  // Our methods over the serial ones, with the line where both are equal: the mass matrix in operations and in time, others in time, on the
  // most threads.
  function drawRatios(line, quantity) {
    const ratios = quantity === FORWARD ? scaling.ratios.filter((one) => one.line === line) : [];
    const beside = scaling.beside.filter((one) => one.line === line && one.quantity === quantity);
    const most = Math.max(1, ...beside.map((one) => one.threads ?? 1));
    const others = beside.filter((one) => (one.threads ?? most) === most).map((one, place) => ({
      name: `${one.method} / ${one.over}`, ink: colour(0), line: { width: 1.4, dash: dash(place + 1) }, mark: { size: 8, symbol: symbol(place + 2) },
      points: one.time.map(([robot, size, value]) => ({
        x: size, y: value, tip: [overview.robots[robot].name, `time over ${one.over}: ${short(value)}`],
        target: { robot, filters: { study: "growth", metric: "time_ratio", method: one.method, quantity: one.quantity } },
      })),
    }));
    const series = ratios.flatMap((one) => [["ltdl / aba, operations", "work", 0], ["ltdl / aba", "time", 1]].map(([name, key, style]) => ({
      name, ink: style ? colour(0) : variable("--ink"), line: { width: 1.4, dash: dash(style ? 0 : 1) }, mark: { size: 8, symbol: symbol(style) },
      points: one[key].map(([robot, size, value]) => ({
        x: size, y: value, tip: [overview.robots[robot].name, `${name}: ${short(value)}`],
        target: { robot, filters: { study: style ? "growth" : "scaling", metric: style ? "time_ratio" : "work_ratio" } },
      })),
    })));
    const shape = layout("degrees of freedom n", "method / serial method");
    shape.bands = [[1, 1, variable("--soft")]];
    draw("scaling-ratio", [...series, ...others].filter((one) => one.points.length), shape);
  }

  live(drawScaling, "scaling-line", "scaling-quantity");
});
