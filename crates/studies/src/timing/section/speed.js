// Speed, side by side: ratios with their intervals, robots along the paper.
featherbench.ready(() => {
  const { byId, chunks, variable } = featherbench;
  const { ink, draw, joined, layout, live, mark } = featherbench.plots;
  const overview = chunks.get("overview");
  const speed = chunks.get("figures")?.speed;
  if (!overview || !speed || !byId("speed-plot")) return;
  // Within this no experiment calls anything a difference.
  const NOISE = 0.02;

  function drawSpeed() {
    const [quantity, title] = speed.quantities[byId("speed-quantity").value];
    const kind = byId("speed-case").value;
    const ratios = speed.ratios.filter((ratio) => ratio.quantity === quantity && ratio.cache === kind);
    const size = (robot) => overview.robots[robot].nv ?? 0;
    const robots = [...new Set(ratios.map((ratio) => ratio.robot))].sort((a, b) => size(a) - size(b) || a - b);
    const way = (ratio) => (ratio.precision === "f64" ? ratio.method : `${ratio.method} ${ratio.precision}`);
    const candidates = [...new Set(ratios.map((ratio) => `${ratio.engine}\t${way(ratio)}`))];
    const methods = new Map();
    const series = candidates.map((candidate, place) => {
      const own = ratios.filter((ratio) => `${ratio.engine}\t${way(ratio)}` === candidate);
      const engine = own[0].engine;
      const index = methods.get(engine) ?? 0;
      methods.set(engine, index + 1);
      // Marks of one robot stand beside each other, so that their bars can be seen.
      const beside = candidates.length < 2 ? 0 : 0.5 * (place / (candidates.length - 1) - 0.5);
      return {
        name: joined(overview.engines[engine], way(own[0])), ink: ink(engine), mark: { symbol: mark(engine, index), size: 9 },
        points: own.map((point) => ({
          x: robots.indexOf(point.robot) + beside, y: point.value, low: point.low, high: point.high, symbol: point.estimated ? "cross" : undefined, hollow: !point.valid,
          tip: [
            `${overview.robots[point.robot].name}, nv ${size(point.robot)}`, `${point.estimated ? "≈ " : ""}${point.value.toFixed(3)} × ${point.reference}`, `[${point.low.toFixed(3)}, ${point.high.toFixed(3)}]`,
            point.estimated ? "estimate" : "", point.valid ? "" : "does not count",
          ].filter(Boolean),
          target: { robot: point.robot, filters: { study: "timing", engine: overview.engines[engine], method: point.method, precision: point.precision, quantity, cache: kind } },
        })),
      };
    });
    const names = robots.map((robot) => { const name = overview.robots[robot].name; return name.length > 22 ? `${name.slice(0, 21)}…` : name; });
    const shape = layout("", `${title}: times ${ratios[0]?.reference ?? "ours"}`);
    shape.x = { title: "", log: false, range: [-0.6, robots.length - 0.4], ticks: names.map((name, place) => [place, name]), turn: true };
    shape.bands = [[1 / (1 + NOISE), 1 + NOISE, variable("--line")], [1, 1, variable("--soft")]];
    draw("speed-plot", series, shape);
  }

  live(drawSpeed, "speed-quantity", "speed-case");
});
