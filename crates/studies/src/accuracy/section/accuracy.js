// Accuracy: the median error against the truth along one axis, and the table of all medians.
featherbench.ready(() => {
  const { byId, chunks, decades, make, short, variable } = featherbench;
  const { ink, dash, draw, exponent, fitted, joined, layout, least, live, mark, ZERO } = featherbench.plots;
  const { power } = featherbench.axes;
  const overview = chunks.get("overview");
  const accuracy = chunks.get("figures")?.accuracy;
  const table = byId("accuracy-table");
  if (!overview || !accuracy || !table) return;

  const ULP = 2 ** -52;
  const AXES = {
    depth: "depth: joints from the base to the farthest leaf",
    tip: "mass at the tip, over the usual",
    offset: "distance of the base from the world's origin, m",
  };
  const quantities = [...new Set(accuracy.answers.map((answer) => answer.quantity))];
  const cells = new Map(accuracy.cells.map((cell) => [`${cell.robot} ${cell.answer}`, cell]));
  const chosen = () => byId("accuracy-quantity").value;
  const engine = (answer) => overview.engines[answer.engine];
  const name = (answer) => [engine(answer), answer.method, answer.scalar === "f64" ? "" : answer.scalar].filter(Boolean).join(" ");
  // As the list of quantities has it.
  const title = (quantity) => [...byId("accuracy-quantity").options].find((option) => option.value === quantity).textContent;

  function filters(cell) {
    const answer = accuracy.answers[cell.answer];
    return { study: "accuracy", engine: engine(answer), method: answer.method, quantity: cell.quantity };
  }

  // A cell in lines.
  function lines(cell) {
    const answer = accuracy.answers[cell.answer];
    const found = [overview.robots[cell.robot].name, `${title(answer.quantity)}${cell.quantity === answer.quantity ? "" : ", seen through products"} by ${name(answer)}`];
    if (cell.median !== null) {
      found.push(`median ${short(cell.median)}, quartiles ${short(cell.q1)} to ${short(cell.q3)}, largest ${short(cell.worst)}`);
      const lost = Math.log10(cell.median / ULP);
      found.push(lost < 0.05 ? "no digit lost" : `${lost.toFixed(1)} digits lost`);
    }
    if (cell.floor !== null && cell.median > 0) found.push(`conditioning bound ${short(cell.floor)}: the median is ${short(Number((cell.median / cell.floor).toPrecision(2)))} of it`);
    if (cell.verdict !== null) found.push(`${featherbench.glyphs[cell.verdict]} ${cell.verdict}${cell.margin === null ? "" : `, ${decades(cell.margin)} decades`}`);
    return found;
  }

  // --- The plot.

  const curvesOf = (quantity, axis) => accuracy.curves.filter((curve) => curve.axis === axis && accuracy.answers[curve.answer].quantity === quantity);

  // The families of an axis; the choice stays where the new list has it, and falls to the one with the most to show.
  function fillFamilies() {
    const select = byId("accuracy-family");
    const before = select.value;
    const points = new Map();
    for (const curve of curvesOf(chosen(), byId("accuracy-axis").value)) points.set(curve.family, (points.get(curve.family) ?? 0) + curve.points.length);
    select.replaceChildren(...[...points.keys()].map((family) => make("option", { value: family }, family)));
    const most = [...points].reduce((best, entry) => (entry[1] > best[1] ? entry : best), ["", 0])[0];
    select.value = points.has(before) ? before : most;
  }

  function drawErrors() {
    const axis = byId("accuracy-axis").value;
    const family = byId("accuracy-family").value;
    const curves = curvesOf(chosen(), axis).filter((curve) => curve.family === family);
    const methods = new Map();
    const floors = new Map();
    const series = [];
    for (const curve of curves) {
      const answer = accuracy.answers[curve.answer];
      const index = methods.get(answer.engine) ?? 0;
      methods.set(answer.engine, index + 1);
      const points = curve.points.map(([x, cell]) => ({ x, ...accuracy.cells[cell] }));
      for (const { x, floor } of points) if (floor !== null) floors.set(x, floor);
      series.push({
        name: joined(engine(answer), answer.method, answer.scalar === "f64" ? "" : answer.scalar), note: exponent(curve.fit?.slope), ink: ink(answer.engine),
        line: { width: 1.3, dash: dash(index) }, mark: { symbol: mark(answer.engine, index), size: 8 }, broad: curve.fit ? fitted(curve.fit, curve.span) : [],
        points: points.map((point) => ({
          x: point.x, y: least(point.median), low: least(point.q1), high: least(point.q3), hollow: point.median < ZERO || point.quantity !== answer.quantity,
          tip: lines(point), target: { robot: point.robot, filters: filters(point) },
        })),
      });
    }
    if (floors.size > 0) {
      series.push({
        name: "conditioning bound", ink: variable("--ink"), line: { width: 1.5, dash: "dash" }, mark: { symbol: "tick", size: 10 },
        points: [...floors].sort(([a], [b]) => a - b).map(([x, floor]) => ({ x, y: floor, tip: [`conditioning bound ${short(floor)}`] })),
      });
    }
    series.push({ name: "2⁻⁵²", ink: variable("--soft"), guide: ULP, line: { width: 1.2, dash: "dot" } });
    const shape = layout(AXES[axis], `median relative error: ${title(chosen())}`, true);
    // Ticks at the robots themselves: between them there is nothing.
    const places = [...new Set(curves.flatMap((curve) => curve.points.map(([x]) => x)))].sort((a, b) => a - b);
    shape.x.ticks = places.map((x) => (x >= 1e-2 && x < 1e4 ? [x, String(x)] : [x, ...power(x)]));
    draw("accuracy-plot", series, shape);
    for (const row of byId("accuracy-growth").tBodies[0].rows) row.hidden = !curves.includes(accuracy.curves[row.dataset.k]);
  }

  // --- The table.

  // As the page made them: a quantity's answers, then its conditioning bound where it has one.
  const columns = quantities.flatMap((quantity) => {
    const answers = accuracy.answers.map((answer, index) => ({ answer: index, quantity })).filter(({ answer }) => accuracy.answers[answer].quantity === quantity);
    const floored = accuracy.cells.some((cell) => cell.floor !== null && accuracy.answers[cell.answer].quantity === quantity);
    return floored ? [...answers, { quantity }] : answers;
  });

  function cellOf(button) {
    const place = button.parentElement;
    return cells.get(`${place.parentElement.dataset.m} ${columns[place.cellIndex - 1]?.answer}`);
  }

  function about(button) {
    const cell = cellOf(button);
    return [...lines(cell), cell.reason].filter(Boolean);
  }

  function open(button) {
    const cell = cellOf(button);
    const heading = `${overview.robots[cell.robot].name}: errors of ${name(accuracy.answers[cell.answer])}`;
    featherbench.open(`robot-${cell.robot}`, filters(cell), heading);
  }

  const grid = featherbench.grid(table, about, open);

  function filter() {
    const text = byId("accuracy-filter").value.toLowerCase();
    for (const head of table.querySelectorAll("th[data-q]")) head.hidden = quantities[head.dataset.q] !== chosen();
    byId("accuracy-count").textContent = grid.filter(
      (column) => columns[column].quantity === chosen(),
      (row) => overview.robots[row.dataset.m].name.toLowerCase().includes(text) && [...row.querySelectorAll("td button")].some((button) => !button.parentElement.hidden),
    );
  }

  byId("accuracy-filter").addEventListener("input", filter);
  byId("accuracy-quantity").addEventListener("change", filter);
  filter();
  if (byId("accuracy-plot")) {
    fillFamilies();
    for (const id of ["accuracy-quantity", "accuracy-axis"]) byId(id).addEventListener("change", fillFamilies);
    live(drawErrors, "accuracy-quantity", "accuracy-axis", "accuracy-family");
  }
});
