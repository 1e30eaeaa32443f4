// The limit of small steps: errors of accelerations on the left, drift of the energy on the right.
featherbench.ready(() => {
  const { byId, chunks, short, variable } = featherbench;
  const { ZERO, colour, dash, draw, joined, layout, live, symbol } = featherbench.plots;
  const overview = chunks.get("overview");
  const figures = chunks.get("figures");
  if (!overview || !figures || !byId("steps-plot")) return;

  const methods = [...new Set(figures.steps.map((line) => line.method))];
  const cases = [...new Set(figures.steps.map((line) => line.case))];

  function trace(line) {
    const [method, kind] = [methods.indexOf(line.method), cases.indexOf(line.case)];
    const ink = colour(method);
    const name = joined(overview.engines[line.engine], line.method, line.case) + (line.order === null ? "" : `  <i>p = ${line.order.toFixed(3)}</i>`);
    return {
      name, mode: "markers+lines", x: line.points.map((point) => point[0]), y: line.points.map((point) => Math.max(point[1], ZERO)),
      line: { color: ink, width: 1.4, dash: dash(kind) }, marker: { color: ink, size: 8, symbol: symbol(kind) },
      text: line.points.map((point) => `dt = ${short(point[0])} s<br>error ${short(point[1])}`), hovertemplate: `%{text}<extra>${name}</extra>`,
      customdata: line.points.map(() => ({ model: line.model, filters: { study: "step_limit", method: line.method } })),
    };
  }

  function drawSteps() {
    const model = Number(byId("steps-model").value);
    for (const [id, energy, title] of [["steps-plot", false, "relative error of the acceleration"], ["drift-plot", true, "relative drift of the energy"]]) {
      const lines = figures.steps.filter((line) => line.model === model && line.energy === energy);
      const shape = layout("step dt, s", title);
      shape.legend = { orientation: "h", y: 1.02, yanchor: "bottom", x: 0 };
      if (energy) shape.xaxis.dtick = shape.yaxis.dtick = "D2";
      if (!lines.length) shape.annotations = [{ text: "this engine's energy is not comparable here", showarrow: false, xref: "paper", yref: "paper", x: 0.5, y: 0.5, font: { color: variable("--soft") } }];
      draw(id, lines.map(trace), shape);
    }
  }

  live(drawSteps, "steps-model");
});
