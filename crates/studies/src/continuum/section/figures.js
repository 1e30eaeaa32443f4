// Continua: errors over refinements and over cost, and shapes.
featherbench.ready(() => {
  const { byId, chunks, short } = featherbench;
  const { colour, draw, layout, least, symbol } = featherbench.plots;
  const figures = chunks.get("figures")?.continuum;
  if (!figures || !byId("continuum-tip")) return;

  const series = (lines, point) => lines.map(([name, points], index) => ({
    name, ink: colour(index), line: { width: 1.2 }, mark: { size: 7, symbol: symbol(index) }, points: points.map(point(name)),
  }));
  const missed = (what) => (name) => ([x, value]) => ({ x, y: least(value), tip: [name, `${short(x)} ${what}`, short(value)] });
  draw("continuum-tip", series(figures.tip, missed("elements")), layout("elements", "error of the tip at F L²/EI = 1", true));
  draw("continuum-frequency", series(figures.frequency, missed("elements")), layout("elements", "error of the first frequency", true));
  draw("continuum-cost", series(figures.cost, missed("ns")), layout("forward dynamics, ns", "error of the first frequency", true));

  // Shapes: a line for each case. Axes have the same scale only as far as the frame's sides have.
  const placed = (name) => ([x, y]) => ({ x, y, tip: [name, `${short(x)}, ${short(y)} m`] });
  const shapes = (lines) => lines.map(([name, points], index) => ({
    name, ink: colour(index), line: { width: 2 }, mark: { size: 3, symbol: "circle" }, points: points.map(placed(name)),
  }));
  const plane = (x, y) => ({ x: { title: x }, y: { title: y } });
  draw("continuum-modes", shapes(figures.modes), plane("x / L", "deflection"));
  draw("continuum-elastica", shapes(figures.elastica), plane("x / L", "y / L"));
  draw("continuum-gripper", shapes(figures.gripper), plane("x, m", "z, m"));
  draw("continuum-arm", shapes(figures.arm), plane("x, m", "z, m"));
});
