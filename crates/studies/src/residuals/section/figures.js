// Residuals: the change of the true energy over a motion without forces, per learned model, without and with noise.
featherbench.ready(() => {
  const { byId, chunks, short } = featherbench;
  const { colour, draw, layout, least, symbol } = featherbench.plots;
  const figures = chunks.get("figures")?.residuals;
  if (!figures || !byId("residuals-drift-0")) return;

  figures.drift.forEach(([name, lines], place) => {
    const point = (model) => ([time, change]) => ({ x: time, y: least(change), tip: [`${model}, ${name}`, `${time} s`, short(change)] });
    const series = lines.map(([model, points], index) => ({
      name: model, ink: colour(index), line: { width: 1.4 }, mark: { size: 8, symbol: symbol(index) }, points: points.map(point(model)),
    }));
    draw(`residuals-drift-${place}`, series, layout(`time, s (${name})`, "change of the true energy", true));
  });
});
