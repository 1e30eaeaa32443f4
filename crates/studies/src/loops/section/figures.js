// Robots with loops: error against time per engine, and errors of accelerations beside a singularity.
featherbench.ready(() => {
  const { byId, chunks, short } = featherbench;
  const { colour, draw, layout, least, symbol } = featherbench.plots;
  const figures = chunks.get("figures")?.loops;
  if (!figures || !byId("loops-near")) return;

  const grouped = (points) => [...Map.groupBy(points, (point) => `${point.engine} ${point.method}`)];
  const all = grouped([...figures.points, ...figures.near].filter((point) => point.dt)).map(([name]) => name);
  // A method has one colour in all motions.
  const series = (points, place, line) => grouped(points).map(([name, own], index) => {
    const known = all.indexOf(name), at = line === "near" ? index : known;
    return { name, ink: colour(at), line: { width: 1.4 }, mark: { size: 7, symbol: symbol(at) }, points: own.map(place) };
  });
  figures.motions.forEach((motion, index) => {
    const place = ({ name, dt, error, seconds, drift, open }) => ({
      x: seconds, y: least(error), tip: [name, `dt ${short(dt)} s, ${short(seconds)} s`, `error ${short(error)}`, `energy ${short(drift)} J, open ${short(open)}`],
    });
    draw(`loops-work-${index}`, series(figures.points.filter((point) => point.name === motion), place), layout(`${motion}: time, s`, "error at the end"));
  });
  const near = ({ beside, error }) => ({ x: beside, y: least(error), tip: [`${short(beside)} rad beside`, short(error)] });
  draw("loops-near", series(figures.near, near, "near"), layout("angle beside the flat four-bar, rad", "error of the acceleration"));
});
