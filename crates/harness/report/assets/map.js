// Maps: what their cells say and open, and how their lines are filtered and sorted.
featherbench.dressed((root) => {
  const { byId } = featherbench;

  function prepare(table) {
    const heads = [...table.tHead.rows[0].cells];
    const given = (element) => JSON.parse(element.dataset.with || "{}");
    const name = (line) => line.cells[0].firstChild.textContent;

    // Line and column of a button, and the rows that it opens.
    function place(button) {
      const line = button.closest("tr");
      const head = heads[button.parentElement.cellIndex];
      return {
        title: `${name(line)}: ${head.title}`,
        chunk: line.dataset.rows ?? head.dataset.rows,
        filters: { ...given(table), ...given(line), ...given(head) },
      };
    }

    const about = (button) => [place(button).title, ...button.dataset.t.split("\n")];
    const open = (button) => { const { chunk, filters, title } = place(button); featherbench.open(chunk, filters, title); };
    const grid = featherbench.grid(table, about, open);

    const lines = [...table.querySelectorAll("tr[data-m]")];
    const bodies = [...table.tBodies].map((body) => [body, [...body.rows]]);
    const KEYS = {
      worst: (line) => Number(line.dataset.worst),
      name: (line) => name(line).toLowerCase(),
      size: (line) => Number(line.querySelector("th small")?.textContent ?? 0),
    };

    // In an order of their own, lines of all groups are mixed in the first body.
    function sort() {
      const key = KEYS[byId(`${table.id}-sort`).value];
      for (const [body, rows] of bodies) body.replaceChildren(...rows);
      if (!key) return;
      const order = lines.map((line) => [key(line), line]).sort(([a], [b]) => (a < b ? -1 : a > b ? 1 : 0));
      for (const [body] of bodies) body.replaceChildren();
      bodies[0]?.[0].append(...order.map(([, line]) => line));
    }

    const troubled = (line) => [...line.querySelectorAll("td button")].some((button) => !/^p\d/.test(button.className));
    function filter() {
      const text = byId(`${table.id}-filter`).value.toLowerCase();
      const trouble = byId(`${table.id}-trouble`).checked;
      byId(`${table.id}-count`).textContent = grid.filter(() => true, (line) => name(line).toLowerCase().includes(text) && (!trouble || troubled(line)));
    }

    byId(`${table.id}-filter`).addEventListener("input", filter);
    byId(`${table.id}-trouble`).addEventListener("change", filter);
    byId(`${table.id}-sort`).addEventListener("change", () => { sort(); filter(); });
    filter();
  }

  for (const table of root.querySelectorAll("table.map")) prepare(table);
});
