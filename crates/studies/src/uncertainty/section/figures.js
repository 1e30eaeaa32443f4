// Uncertainty: errors against samples, first order against samples, and the density of a mixture.
featherbench.ready(() => {
  const { byId, chunks, short } = featherbench;
  const { colour, draw, layout, symbol } = featherbench.plots;
  const figures = chunks.get("figures")?.uncertainty;
  if (!figures || !byId("uncertainty-rates")) return;

  const marks = (name, index, points, line) => ({ name, ink: colour(index), line, mark: { size: 8, symbol: symbol(index) }, points });
  const rates = figures.rates.map(([name, slope, points], index) => marks(`${name}, slope ${short(slope)}`, index,
    points.map(([samples, error]) => ({ x: samples, y: error, tip: [name, `${samples} samples`, `${short(error)} rad/s²`] })), { width: 1.4 }));
  draw("uncertainty-rates", rates, layout("samples", "error of the mean, rad/s²", true));

  const ends = figures.arm.map(([first]) => first);
  const same = [Math.min(...ends), Math.max(...ends)].map((x) => ({ x, y: x, tip: ["equal", short(x)] }));
  const joints = figures.arm.map(([first, found], joint) => ({ x: first, y: found, tip: [`joint ${joint}`, `first order ${short(first)}`, `samples ${short(found)}`] }));
  draw("uncertainty-arm", [marks("joints of the arm", 0, joints), { name: "equal", ink: colour(1), line: { width: 1.4 }, mark: { size: 1, symbol: symbol(1) }, points: same }],
    layout("deviation by first order, rad/s²", "deviation of samples, rad/s²", true));

  const of = (name, index, column, line) => marks(name, index,
    figures.density.map((bin) => ({ x: bin[0], y: bin[column], tip: [name, `${short(bin[0])} m/s`, `${short(bin[column])} s/m`] })), line);
  draw("uncertainty-density", [of("exact", 1, 2, { width: 1.4 }), of("samples", 0, 1)],
    { x: { title: "velocity of drops after an impact, m/s (all others have −gT)" }, y: { title: "density, s/m" } });
});
