// Error against depth.
featherbench.ready(() => {
  const { byId, chunks, short, variable } = featherbench;
  const { choices, dash, draw, ink, joined, layout, least, live, mark } = featherbench.plots;
  const overview = chunks.get("overview");
  const plots = chunks.get("figures")?.depth;
  if (!overview || !plots || !byId("depth-plot")) return;

  const HALF_ULP = 2 ** -53;

  function drawDepth() {
    const plot = plots[byId("depth-quantity").value];
    const family = byId("depth-family").value;
    const kind = byId("depth-case").value;
    const gates = new Map();
    const methods = new Map();
    const series = [];
    for (const trace of plot.traces) {
      const index = methods.get(trace.engine) ?? 0;
      methods.set(trace.engine, index + 1);
      // A robot's worst row.
      const worst = new Map();
      for (const [robot, pointCase, value, bound] of trace.points) {
        const about = overview.robots[robot];
        if ((family !== "" && about.family !== family) || (kind !== "" && pointCase !== kind)) continue;
        if (bound !== null) gates.set(about.depth, Math.min(bound, gates.get(about.depth) ?? Infinity));
        if (!worst.has(robot) || worst.get(robot).value < value) worst.set(robot, { robot, depth: about.depth, kind: pointCase, value, bound });
      }
      if (worst.size === 0) continue;
      const points = [...worst.values()].sort((a, b) => a.depth - b.depth || a.value - b.value);
      const name = joined(overview.engines[trace.engine], trace.method, trace.scalar === "f64" ? "" : trace.scalar);
      const envelope = new Map(points.map((point) => [point.depth, least(point.value)]));
      series.push({
        name, ink: ink(trace.engine), mark: { symbol: mark(trace.engine, index), size: 8, opacity: 0.9 }, line: { width: 1.2, dash: dash(index), opacity: 0.6, path: [...envelope] },
        points: points.map((point) => ({
          x: point.depth, y: least(point.value), hollow: point.value === 0,
          tip: [`${overview.robots[point.robot].name}, depth ${point.depth}`, short(point.value) + (point.bound === null ? "" : `, gate ${short(point.bound)}`), point.kind].filter(Boolean),
          target: {
            robot: point.robot,
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

  const used = plots.flatMap((plot) => plot.traces.flatMap((trace) => trace.points));
  choices(byId("depth-family"), new Set(used.map(([robot]) => overview.robots[robot].family)));
  choices(byId("depth-case"), new Set(used.map(([, kind]) => kind)));
  live(drawDepth, "depth-quantity", "depth-family", "depth-case");
});
