// The limit of small steps: errors of accelerations on the left, drift of the energy on the right.
featherbench.ready(() => {
  const { byId, chunks, short, variable } = featherbench;
  const { colour, dash, draw, exponent, joined, layout, least, live, symbol } = featherbench.plots;
  const overview = chunks.get("overview");
  const figures = chunks.get("figures");
  if (!overview || !figures || !byId("steps-plot")) return;

  const methods = [...new Set(figures.steps.map((line) => line.method))];
  const cases = [...new Set(figures.steps.map((line) => line.case))];

  function seriesOf(line) {
    const [method, kind] = [methods.indexOf(line.method), cases.indexOf(line.case)];
    return {
      name: joined(overview.engines[line.engine], line.method, line.case), note: exponent(line.order, 3), ink: colour(method),
      line: { width: 1.4, dash: dash(kind) }, mark: { size: 8, symbol: symbol(kind) },
      points: line.points.map(([dt, error]) => ({
        x: dt, y: least(error), tip: [`dt = ${short(dt)} s`, `error ${short(error)}`], target: { model: line.model, filters: { study: "steps", method: line.method } },
      })),
    };
  }

  function drawSteps() {
    const model = Number(byId("steps-model").value);
    for (const [id, energy, title] of [["steps-plot", false, "relative error of the acceleration"], ["drift-plot", true, "relative drift of the energy"]]) {
      const lines = figures.steps.filter((line) => line.model === model && line.energy === energy);
      const shape = layout("step dt, s", title, true);
      if (!lines.length) shape.empty = "this engine's energy is not comparable here";
      draw(id, lines.map(seriesOf), shape);
    }
  }

  live(drawSteps, "steps-model");
});
