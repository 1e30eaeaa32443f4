// Scenes: the rose of felt friction, errors against the step, and the error of the derivative of a bounce.
featherbench.ready(() => {
  const { byId, chunks, short } = featherbench;
  const { choices, colour, draw, joined, layout, least, live, symbol } = featherbench.plots;
  const figures = chunks.get("figures")?.scenes;
  if (!figures || !byId("scenes-rose")) return;

  const shown = (lines, point) => lines.map(({ engine, method, points }, index) => ({
    name: joined(engine, method), ink: colour(index), line: { width: 1.4 }, mark: { size: 7, symbol: symbol(index) }, points: points.map(point(engine, method)),
  }));
  const rose = (engine, method) => ([heading, felt]) => {
    const angle = (heading * Math.PI) / 180;
    return { x: felt * Math.cos(angle), y: felt * Math.sin(angle), tip: [joined(engine, method), `heading ${short(heading)}°`, `${short(felt)} μ`] };
  };
  const stepped = (engine, method) => ([dt, error]) => ({ x: dt, y: least(error), tip: [joined(engine, method), `dt = ${short(dt)} s`, `error ${short(error)}`] });

  choices(byId("scenes-question"), figures.errors.map((errors) => errors.question));
  live(() => {
    draw("scenes-rose", shown(figures.rose, rose), { x: { title: "felt friction along x / μ" }, y: { title: "felt friction along y / μ" } });
    const chosen = figures.errors.find((errors) => errors.question === byId("scenes-question").value);
    if (chosen) draw("scenes-errors", shown(chosen.lines, stepped), layout("step dt, s", "error", true));
    draw("scenes-bounce", shown(figures.bounce, stepped), layout("step dt, s", "error of ∂(z, ż)/∂(z₀, ż₀)"));
  }, "scenes-question");
});
