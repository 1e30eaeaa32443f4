// The limit of small steps: errors of accelerations on the left, drift of the energy on the right.
featherbench.ready(() => {
  const { byId, chunks, short, variable } = featherbench;
  const { colour, dash, draw, exponent, joined, layout, least, live, symbol } = featherbench.plots;
  const overview = chunks.get("overview");
  const steps = chunks.get("figures")?.steps;
  if (!overview || !steps || !byId("steps-plot")) return;

  const methods = [...new Set(steps.map((line) => line.method))];
  const cases = [...new Set(steps.map((line) => line.case))];

  function seriesOf(line) {
    const [method, kind] = [methods.indexOf(line.method), cases.indexOf(line.case)];
    return {
      name: joined(overview.engines[line.engine], line.method, line.case), note: exponent(line.order, 3), ink: colour(method),
      line: { width: 1.4, dash: dash(kind) }, mark: { size: 8, symbol: symbol(kind) },
      points: line.points.map(([dt, error]) => ({
        x: dt, y: least(error), tip: [`dt = ${short(dt)} s`, `error ${short(error)}`], target: { robot: line.robot, filters: { study: "steps", method: line.method } },
      })),
    };
  }

  function drawSteps() {
    const robot = Number(byId("steps-robot").value);
    for (const [id, energy, title] of [["steps-plot", false, "relative error of the acceleration"], ["drift-plot", true, "relative drift of the energy"]]) {
      const lines = steps.filter((line) => line.robot === robot && line.energy === energy);
      const shape = layout("step dt, s", title, true);
      if (!lines.length) shape.empty = "this engine's energy is not comparable here";
      draw(id, lines.map(seriesOf), shape);
    }
  }

  live(drawSteps, "steps-robot");
});
