// What all plots share: colours, marks, axes, and the click on a mark that opens its rows.
featherbench.plots = (() => {
  const { byId, chart, chunks, variable, make } = featherbench;
  const SYMBOLS = ["circle", "square", "diamond", "triangle", "plus", "star", "pentagon", "hexagram"];
  const DASHES = ["solid", "dash", "dot", "dashdot", "longdash", "longdashdot"];
  const COLOURS = 8;
  // Logarithms have no place for zero: what is smaller stands here, hollow.
  const ZERO = 1e-18;
  const colour = (index) => variable(`--series-${index % COLOURS}`);
  // An engine has one colour on every page; its first method has the engine's mark, its others the next ones.
  const ink = (engine) => colour(chunks.get("overview").styles[engine].colour);
  const mark = (engine, method) => symbol(chunks.get("overview").styles[engine].mark + method);
  const symbol = (index) => SYMBOLS[index % SYMBOLS.length];
  const dash = (index) => DASHES[index % DASHES.length];
  const joined = (...parts) => parts.filter(Boolean).join(" · ");
  const least = (value) => (value === null ? null : Math.max(value, ZERO));
  // The exponent of a fit beside a name.
  const exponent = (slope, digits = 2) => (slope === undefined || slope === null ? "" : `p = ${slope.toFixed(digits).replace("-", "−")}`);

  // Two logarithmic axes; `zero` where what is as small as ZERO stands on the lower edge.
  function layout(x, y, zero = false) {
    return { x: { title: x, log: true }, y: { title: y, log: true, least: zero ? ZERO : undefined } };
  }

  function draw(id, series, shape) {
    chart(byId(id), series, shape, (target) => featherbench.open(`robot-${target.robot}`, target.filters, chunks.get("overview").robots[target.robot].name));
  }

  // The broad line of a power law from one end to another.
  const fitted = (fit, ends) => ends.map((x) => [x, 10 ** (fit.intercept + fit.slope * Math.log10(x))]);

  function choices(select, values) {
    for (const value of values) if (value !== "") select.append(make("option", { value }, value));
  }

  // Draws now, when a control changes, and when the theme does: colours are part of the drawing.
  function live(task, ...controls) {
    for (const id of controls) byId(id).addEventListener("change", task);
    document.addEventListener("themechange", task);
    task();
  }

  return { ZERO, least, colour, ink, mark, symbol, dash, joined, exponent, layout, draw, fitted, choices, live };
})();
