// The heatmap: one engine or all, filters, and what its cells say and open.
featherbench.ready(() => {
  const { byId, chunks, short, decades } = featherbench;
  const table = byId("heat");
  const overview = chunks.get("overview");
  const heat = chunks.get("figures")?.agreement;
  if (!table || !overview || !heat) return;

  const cells = new Map(heat.cells.map((cell) => [cell.at.join(" "), cell]));

  // Which robot, engine and quantity a button stands for; the robot alone for a row's head.
  function place(button) {
    const cell = button.parentElement;
    const robot = Number(cell.parentElement.dataset.m);
    if (cell.tagName === "TH") return { robot };
    const [engine, quantity] = heat.columns[cell.cellIndex - 1];
    return { robot, engine, quantity };
  }

  function open(button) {
    const { robot, engine, quantity } = place(button);
    const name = overview.robots[robot].name;
    if (engine === undefined) {
      featherbench.open(`robot-${robot}`, {}, name);
    } else {
      const filters = { study: "agreement", engine: overview.engines[engine], quantity: heat.quantities[quantity][0] };
      featherbench.open(`robot-${robot}`, filters, `${name}: ${heat.quantities[quantity][1]} by ${overview.engines[engine]}`);
    }
  }

  function about(button) {
    const { robot, engine, quantity } = place(button);
    const lines = [overview.robots[robot].name];
    if (engine === undefined) return [...lines, featherbench.describe(overview.robots[robot])];
    const cell = cells.get([robot, engine, quantity].join(" "));
    const [metric, kind, method, reason] = cell.worst;
    lines.push(`${heat.quantities[quantity][1]} by ${overview.engines[engine]}`, cell.rows);
    if (cell.value !== null) {
      const gate = cell.bound === null ? "" : `, gate ${short(cell.bound)}${cell.margin === null ? "" : `, ${decades(cell.margin)} decades`}`;
      lines.push(`worst: ${metric} ${short(cell.value)}${gate}`);
    }
    const where = [kind, method].filter(Boolean).join(", ");
    return [...lines, where, reason].filter(Boolean);
  }

  const grid = featherbench.grid(table, about, open);

  function filter() {
    const engine = byId("heat-engine").value;
    const text = byId("heat-filter").value.toLowerCase();
    const trouble = byId("heat-trouble").checked;
    const visible = heat.columns.map(([index]) => engine === "" || String(index) === engine);
    table.classList.toggle("single", engine !== "");
    for (const head of table.querySelectorAll("th[data-e]")) head.hidden = engine !== "" && head.dataset.e !== engine;
    const troubled = (row) => [...row.querySelectorAll("td button")].some((button) => !button.parentElement.hidden && !/^p\d/.test(button.className));
    byId("heat-count").textContent = grid.filter(
      (column) => visible[column],
      (row) => overview.robots[row.dataset.m].name.toLowerCase().includes(text) && (!trouble || troubled(row)),
    );
  }

  byId("heat-engine").addEventListener("change", filter);
  byId("heat-filter").addEventListener("input", filter);
  byId("heat-trouble").addEventListener("change", filter);
  filter();
});
