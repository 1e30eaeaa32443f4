// The lesson's pipeline: the error of each stage on a motion that none has seen, and on the log.
featherbench.ready(() => {
  const { byId, chunks, short } = featherbench;
  const { colour, dash, draw, least, symbol } = featherbench.plots;
  const figures = chunks.get("figures")?.lesson;
  if (!figures || !byId("lesson-stages")) return;

  const series = figures.stages.flatMap(([name, stages], index) => [["unseen motion", 1, 0], ["log", 2, 1]].map(([motion, place, style]) => ({
    name: `${name}: ${motion}`, ink: colour(index), line: { width: 1.4, dash: dash(style) }, mark: { size: 8, symbol: symbol(index) },
    points: stages.map((stage, at) => ({ x: at + 1, y: least(stage[place]), tip: [stage[0], `${motion}: ${short(stage[place])}`] })),
  })));
  const names = figures.stages[0][1].map(([stage], at) => `${at + 1} ${stage}`).join(", ");
  draw("lesson-stages", series, { x: { title: `stage: ${names}` }, y: { title: "‖τ − τ̂‖/‖τ‖", log: true } });
});
