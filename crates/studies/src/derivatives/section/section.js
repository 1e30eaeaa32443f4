// Finite differences: the error of derivatives against their step, ID on the left, FD on the right.
featherbench.ready(() => {
  const { byId, chunks, short } = featherbench;
  const { colour, dash, draw, joined, layout, least, live, symbol } = featherbench.plots;
  const overview = chunks.get("overview");
  const lines = chunks.get("figures")?.derivatives;
  if (!overview || !lines || !byId("derivatives-id")) return;

  const methods = [...new Set(lines.map((line) => joined(overview.engines[line.engine], line.method)))];
  const quantities = [...new Set(lines.map((line) => line.quantity))];
  const steps = lines.flatMap((line) => line.points.map(([eps]) => eps)).filter((eps) => eps !== null);
  const ends = [Math.max(...steps), Math.min(...steps)];

  function seriesOf(line) {
    const name = joined(overview.engines[line.engine], line.method);
    const target = { robot: line.robot, filters: { study: "derivatives", engine: overview.engines[line.engine], quantity: line.quantity } };
    const level = line.points.every(([eps]) => eps === null);
    const points = level ? ends.map((eps) => [eps, line.points[0][1]]) : line.points;
    return {
      name: joined(name, line.title), ink: colour(methods.indexOf(name)),
      line: { width: 1.4, dash: dash(quantities.indexOf(line.quantity) % 2) }, mark: { size: level ? 4 : 8, symbol: symbol(quantities.indexOf(line.quantity) % 2) },
      points: points.map(([eps, error]) => ({
        x: eps, y: least(error), tip: level ? ["no differences", `error ${short(error)}`] : [`step ${short(eps)}`, `error ${short(error)}`], target,
      })),
    };
  }

  function drawDifferences() {
    const robot = Number(byId("derivatives-robot").value);
    for (const [id, prefix, title] of [["derivatives-id", "id_", "median error of ∂ID"], ["derivatives-fd", "fd_", "median error of ∂FD"]]) {
      const shown = lines.filter((line) => line.robot === robot && line.quantity.startsWith(prefix));
      const shape = layout("step of the differences", title, true);
      if (!shown.length) shape.empty = "no finite differences of this robot";
      draw(id, shown.map(seriesOf), shape);
    }
  }

  live(drawDifferences, "derivatives-robot");
});
