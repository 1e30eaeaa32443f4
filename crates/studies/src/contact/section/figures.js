// Loops, contact and events: accuracy against work, rates against their prediction, and the friction that a body feels.
featherbench.ready(() => {
  const { byId, chunks, short } = featherbench;
  const { colour, draw, layout, least, symbol } = featherbench.plots;
  const figures = chunks.get("figures")?.contact;
  if (!figures || !byId("contact-felt")) return;

  const series = (lines, point, line) => lines.map(([name, points], index) => ({
    name, ink: colour(index), line, mark: { size: 8, symbol: symbol(index) }, points: points.map(point),
  }));
  const scattered = ([problem, iterations, value]) => ({ x: iterations, y: least(value), tip: [problem, `${iterations} iterations`, short(value)] });
  draw("contact-accuracy", series(figures.accuracy, scattered), layout("iterations", "residual of the natural map", true));
  draw("contact-rates", series(figures.rates, scattered), layout("iterations", "|fitted / predicted rate − 1|", true));
  const turned = ([heading, felt]) => ({ x: heading, y: felt, tip: [`heading ${short(heading)}°`, `${short(felt)} of the cone's friction`] });
  draw("contact-felt", series(figures.felt, turned, { width: 1.4 }), { x: { title: "heading, °" }, y: { title: "felt friction / μ" } });
});
