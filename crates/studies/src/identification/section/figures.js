// Identification: the gap of singular values by which ranks are told, and estimates with their intervals.
featherbench.ready(() => {
  const { byId, chunks, short } = featherbench;
  const { colour, draw, layout, least, symbol } = featherbench.plots;
  const figures = chunks.get("figures")?.identification;
  if (!figures || !byId("identification-gaps")) return;

  // Of each way two series of one colour: the last singular value that is kept, and the first that is dropped.
  const gaps = figures.gaps.filter(([, robots]) => robots.length).flatMap(([way, robots], index) => [
    ["kept", 2, false], ["dropped", 3, true],
  ].map(([words, place, hollow]) => ({
    name: `${way}, ${words}`, ink: colour(index), mark: { size: 8, symbol: symbol(index) },
    points: robots.map((robot) => ({ x: robot[1], y: least(robot[place]), hollow, tip: [robot[0], `${words}: ${short(robot[place])} of the largest`] })),
  })));
  draw("identification-gaps", gaps, layout("unknowns", "singular value / largest", true));

  // Errors in units of half an interval: within ±1 the interval holds the truth.
  const points = figures.intervals.map(([name, estimate, truth, half], index) => ({
    x: index + 1, y: (estimate - truth) / half, low: (estimate - half - truth) / half, high: (estimate + half - truth) / half,
    tip: [name, `estimate ${short(estimate)} ± ${short(half)}`, `truth ${short(truth)}`],
  }));
  const ends = points.length ? [[0.5, 0], [points.length + 0.5, 0]] : [];
  draw("identification-intervals", [
    { name: "estimate with its 95 % interval", ink: colour(0), mark: { size: 7, symbol: "circle" }, points },
    { name: "truth", ink: colour(1), line: { width: 1.4 }, points: ends.map(([x, y]) => ({ x, y })) },
  ], { x: { title: "base parameter" }, y: { title: "(estimate − truth) / half-width" } });
});
