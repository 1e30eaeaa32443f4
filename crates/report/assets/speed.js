// Speed, side by side: ratios with their intervals, robots along the paper.
featherbench.ready(() => {
  const { byId, chunks, variable } = featherbench;
  const { colour, draw, joined, layout, live, plain, symbol } = featherbench.plots;
  const overview = chunks.get("overview");
  const figures = chunks.get("figures");
  if (!overview || !figures || !byId("speed-plot")) return;
  // Within this no experiment calls anything a difference.
  const NOISE = 0.02;

  function drawSpeed() {
    const [quantity, title] = figures.speed.quantities[byId("speed-quantity").value];
    const kind = byId("speed-case").value;
    const ratios = figures.speed.ratios.filter((ratio) => ratio.quantity === quantity && ratio.cache === kind);
    const size = (model) => overview.models[model].nv ?? 0;
    const robots = [...new Set(ratios.map((ratio) => ratio.model))].sort((a, b) => size(a) - size(b) || a - b);
    const candidates = [...new Set(ratios.map((ratio) => `${ratio.engine}\t${ratio.method}`))];
    const methods = new Map();
    const traces = candidates.map((candidate, place) => {
      const points = ratios.filter((ratio) => `${ratio.engine}\t${ratio.method}` === candidate);
      const engine = points[0].engine;
      const index = methods.get(engine) ?? 0;
      methods.set(engine, index + 1);
      const ink = colour(engine);
      const name = joined(overview.engines[engine], points[0].method);
      // Marks of one robot stand beside each other, so that their bars can be seen.
      const beside = candidates.length < 2 ? 0 : 0.5 * (place / (candidates.length - 1) - 0.5);
      return {
        name, mode: "markers", x: points.map((point) => robots.indexOf(point.model) + beside), y: points.map((point) => point.value),
        marker: { color: ink, size: 9, symbol: points.map((point) => (point.estimated ? "x" : symbol(index)) + (point.valid ? "" : "-open")), line: { width: 1.2, color: ink } },
        error_y: { type: "data", symmetric: false, thickness: 1.5, width: 3, color: ink, array: points.map((point) => point.high - point.value), arrayminus: points.map((point) => point.value - point.low) },
        text: points.map((point) => `<b>${plain(overview.models[point.model].name)}</b> nv ${size(point.model)}<br>${point.estimated ? "≈ " : ""}${point.value.toFixed(3)} × ${plain(point.reference)}<br>[${point.low.toFixed(3)}, ${point.high.toFixed(3)}]${point.estimated ? "<br>estimate" : ""}${point.valid ? "" : "<br>does not count"}`),
        hovertemplate: `%{text}<extra>${name}</extra>`,
        customdata: points.map((point) => ({ model: point.model, filters: { study: "timing", engine: overview.engines[engine], method: point.method, quantity, cache: kind } })),
      };
    });
    const shape = layout("", plain(`${title}: times ${ratios[0]?.reference ?? "ours"}`));
    const names = robots.map((model) => { const name = overview.models[model].name; return plain(name.length > 22 ? `${name.slice(0, 21)}…` : name); });
    Object.assign(shape.xaxis, { type: "linear", range: [-0.6, robots.length - 0.4], tickvals: robots.map((_, place) => place), ticktext: names, tickangle: -35, automargin: true, minor: {} });
    // Few decades: digits between the powers of ten are worth their place.
    Object.assign(shape.yaxis, { dtick: "D2", exponentformat: "none" });
    shape.shapes = [
      { type: "rect", xref: "paper", x0: 0, x1: 1, y0: 1 / (1 + NOISE), y1: 1 + NOISE, fillcolor: variable("--line"), opacity: 0.7, line: { width: 0 }, layer: "below" },
      { type: "line", xref: "paper", x0: 0, x1: 1, y0: 1, y1: 1, line: { color: variable("--soft"), width: 1 }, layer: "below" },
    ];
    draw("speed-plot", traces, shape);
  }

  live(drawSpeed, "speed-quantity", "speed-case");
});
