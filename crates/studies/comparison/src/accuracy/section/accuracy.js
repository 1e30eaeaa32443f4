// Accuracy: the table of all medians. The drawings follow the list of quantities by themselves.
featherbench.ready(() => {
  const { byId, chunks, decades, short } = featherbench;
  const overview = chunks.get("overview");
  const accuracy = chunks.get("figures")?.accuracy;
  const table = byId("accuracy-table");
  if (!overview || !accuracy || !table) return;

  const ULP = 2 ** -52;
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
});
