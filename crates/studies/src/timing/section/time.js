// Time against size.
featherbench.ready(() => {
  const { byId, chunks, short } = featherbench;
  const { colour, dash, draw, exponent, fitted, joined, layout, live, symbol } = featherbench.plots;
  const overview = chunks.get("overview");
  const times = chunks.get("figures")?.time;
  if (!overview || !times || !byId("time-plot")) return;

  function drawTime() {
    const joint = byId("time-unit").value === "joint";
    const kind = byId("time-case").value;
    const family = byId("time-family").value;
    const lines = times.filter((line) => line.cache === kind && (family === "" || line.family === family));
    const algorithms = [...new Set(times.map((line) => line.algorithm))];
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
          tip: [`${overview.robots[point.robot].name}, nv ${point.size}`, `${short(point.ns)} ns per call`, `${short(point.ns / point.joints)} ns per joint`, point.estimated ? "estimate" : "", point.valid ? "" : "does not count"].filter(Boolean),
          target: { robot: point.robot, filters: { study: "timing", engine: overview.engines[line.engine], quantity: line.algorithm, cache: line.cache } },
        })),
      });
    }
    draw("time-plot", series, layout("degrees of freedom nv", joint ? "ns per joint" : "ns per call"));
  }

  live(drawTime, "time-unit", "time-case", "time-family", "time-fit");
});
