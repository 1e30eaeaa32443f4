// The joint matrix: what its cells say and open.
featherbench.ready(() => {
  const { byId, chunks, short, decades } = featherbench;
  const table = byId("joints-table");
  const overview = chunks.get("overview");
  const { agreement, joints: matrix } = chunks.get("figures") ?? {};
  if (!table || !overview || !agreement || !matrix) return;

  const cells = new Map(matrix.cells.map((cell) => [cell.at.join(" "), cell]));
  const STATES = { agrees: "agrees", deviates: "deviates by known cause", fails: "is outside its gate", error: "no answer", unsupported: "not offered" };

  function found(button) {
    const cell = button.parentElement;
    const row = Number(cell.parentElement.dataset.m);
    return cells.get([row, ...matrix.columns[cell.cellIndex - 1]].join(" "));
  }

  const joint = ({ kind, armature }) => kind + (armature ? " with armature" : "");
  const title = ({ at: [row, engine, quantity] }) => `${joint(matrix.rows[row])}: ${agreement.quantities[quantity][1]} by ${overview.engines[engine]}`;

  function about(button) {
    const cell = found(button);
    const [robot, metric, kind, method, reason] = cell.worst;
    const [value, bound, margin] = cell.numbers;
    const robots = (count) => (count === 1 ? "1 robot" : `${count} robots`);
    const lines = [title(cell), STATES[cell.state] + (cell.robots > 0 ? ` (${cell.rows} on ${robots(cell.robots)})` : "")];
    if (value !== null) {
      const gate = bound === null ? "" : `, gate ${short(bound)}${margin === null ? "" : `, ${decades(margin)} decades`}`;
      lines.push(`worst: ${metric} ${short(value)}${gate}`);
    }
    lines.push([method && `method ${method}`, robot, kind].filter(Boolean).join(", "), reason);
    if (cell.robots > 0 && cell.lacking.length > 0) lines.push(`not offered for ${cell.lacking.join(", ")}`);
    return lines.filter(Boolean);
  }

  function open(button) {
    const cell = found(button);
    const [, engine, quantity] = cell.at;
    const robot = overview.robots.findIndex(({ name }) => name === cell.worst[0]);
    const filters = { study: "agreement", engine: overview.engines[engine], quantity: agreement.quantities[quantity][0] };
    featherbench.open(`robot-${robot}`, filters, `${title(cell)}, on ${cell.worst[0]}`);
  }

  // Everything is shown; this only opens the way in for Tab.
  featherbench.grid(table, about, open).filter(() => true, () => true);
});
