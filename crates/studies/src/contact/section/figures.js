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

  // The map of the sliding rod: of each angle a column of marks, by what the laws allow at that rate.
  const FASTEST = 5, MARKS = 32;
  const regions = [["one force, it presses", 1, false], ["no force: lift-off", 1, true], ["no solution", 0, false], ["two solutions", 2, true]];
  const region = ([name, forces, above], index) => {
    const points = figures.existence.flatMap(([angle, critical, ...counts]) => {
      const rates = Array.from({ length: MARKS }, (_, k) => (FASTEST * (k + 0.5)) / MARKS);
      const inside = rates.filter((rate) => rate > critical === above && counts[Number(above)] === forces);
      return inside.map((rate) => ({ x: angle, y: rate, tip: [name, `${short(angle)}°, ${short(rate)} rad/s`, `changes at ${short(critical)} rad/s`] }));
    });
    return { name, ink: colour(index), mark: { size: 5, symbol: "square" }, points };
  };
  draw("contact-existence", regions.map(region), { x: { title: "angle to the ground, °" }, y: { title: "rate, rad/s" } });
  const turned = ([heading, felt]) => ({ x: heading, y: felt, tip: [`heading ${short(heading)}°`, `${short(felt)} of the cone's friction`] });
  draw("contact-felt", series(figures.felt, turned, { width: 1.4 }), { x: { title: "heading, °" }, y: { title: "felt friction / μ" } });
});
