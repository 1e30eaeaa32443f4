// The heatmap: one engine or all, filters, a tip for what is pointed at, and walking with the arrow keys.
featherbench.ready(() => {
  const { byId, chunks, short, decades, make } = featherbench;
  const table = byId("heat");
  const overview = chunks.get("overview");
  if (!table || !overview) return;

  const tip = byId("tip");
  const cells = new Map(overview.cells.map((cell) => [cell.at.join(" "), cell]));
  let tipped = null;
  const rows = [...table.querySelectorAll("tr[data-m]")];

  // Which model, engine and quantity a button stands for; the model alone for a row's head.
  function place(button) {
    const cell = button.parentElement;
    const model = Number(cell.parentElement.dataset.m);
    if (cell.tagName === "TH") return { model };
    const [engine, quantity] = overview.columns[cell.cellIndex - 1];
    return { model, engine, quantity };
  }

  function open(button) {
    const { model, engine, quantity } = place(button);
    const name = overview.models[model].name;
    hideTip();
    if (engine === undefined) {
      featherbench.open(`model-${model}`, {}, name);
    } else {
      const filters = { study: "agreement", engine: overview.engines[engine], quantity: overview.quantities[quantity][0] };
      featherbench.open(`model-${model}`, filters, `${name}: ${overview.quantities[quantity][1]} by ${overview.engines[engine]}`);
    }
  }

  function showTip(button) {
    const { model, engine, quantity } = place(button);
    const about = overview.models[model];
    const lines = [make("b", {}, about.name)];
    if (engine === undefined) {
      lines.push(`${about.family}, ${about.nv ?? "?"} degrees of freedom, ${about.bodies ?? "?"} bodies, depth ${about.depth ?? "?"}`);
    } else {
      const cell = cells.get([model, engine, quantity].join(" "));
      const [metric, kind, method, reason] = cell.worst;
      lines.push(`${overview.quantities[quantity][1]} by ${overview.engines[engine]}`, cell.rows);
      if (cell.value !== null) {
        const gate = cell.bound === null ? "" : `, gate ${short(cell.bound)}${cell.margin === null ? "" : `, ${decades(cell.margin)} decades`}`;
        lines.push(`worst: ${metric} ${short(cell.value)}${gate}`);
      }
      const where = [kind, method].filter(Boolean).join(", ");
      if (where) lines.push(where);
      if (reason) lines.push(reason);
    }
    tip.replaceChildren(...lines.map((line) => make("div", {}, line)));
    tip.hidden = false;
    tipped = button;
    placeTip();
    button.setAttribute("aria-describedby", "tip");
  }

  // Over the button, or under it where there is no room.
  function placeTip() {
    if (tip.hidden) return;
    const box = tipped.getBoundingClientRect();
    const left = Math.min(Math.max(8, box.left + box.width / 2 - tip.offsetWidth / 2), innerWidth - tip.offsetWidth - 8);
    const above = box.top - tip.offsetHeight - 8;
    tip.style.left = `${left}px`;
    tip.style.top = `${above > 8 ? above : box.bottom + 8}px`;
  }

  function hideTip() {
    tip.hidden = true;
  }

  // One button at a time is reached with Tab; the arrows go to the next one in their direction that is there and shown.
  function focusable(button) {
    table.querySelector("button[tabindex='0']")?.setAttribute("tabindex", "-1");
    button.setAttribute("tabindex", "0");
  }

  function step(button, down, right) {
    const shown = rows.filter((row) => !row.hidden);
    let row = shown.indexOf(button.closest("tr"));
    let column = button.parentElement.cellIndex;
    for (;;) {
      row += down;
      column += right;
      const cell = shown[row]?.cells[column];
      if (!cell) return;
      const next = cell.hidden ? null : cell.querySelector("button");
      if (next) {
        focusable(next);
        next.focus();
        return;
      }
    }
  }

  const ARROWS = { ArrowDown: [1, 0], ArrowUp: [-1, 0], ArrowRight: [0, 1], ArrowLeft: [0, -1] };
  table.addEventListener("keydown", (event) => {
    const button = event.target.closest("button");
    if (event.key === "Escape") hideTip();
    if (!button || !ARROWS[event.key]) return;
    event.preventDefault();
    step(button, ...ARROWS[event.key]);
  });
  table.addEventListener("click", (event) => {
    const button = event.target.closest("button");
    if (!button) return;
    focusable(button);
    open(button);
  });
  for (const [start, end] of [["pointerover", "pointerout"], ["focusin", "focusout"]]) {
    table.addEventListener(start, (event) => { const button = event.target.closest("button"); if (button) showTip(button); });
    table.addEventListener(end, hideTip);
  }
  addEventListener("scroll", placeTip, { passive: true, capture: true });

  function filter() {
    const engine = byId("heat-engine").value;
    const text = byId("heat-filter").value.toLowerCase();
    const trouble = byId("heat-trouble").checked;
    const visible = overview.columns.map(([index]) => engine === "" || String(index) === engine);
    table.classList.toggle("single", engine !== "");
    for (const head of table.querySelectorAll("th[data-e]")) head.hidden = engine !== "" && head.dataset.e !== engine;
    let count = 0;
    for (const row of rows) {
      let troubled = false;
      for (const cell of row.cells) {
        if (cell.tagName === "TH") continue;
        cell.hidden = !visible[cell.cellIndex - 1];
        const button = cell.firstElementChild;
        troubled ||= !cell.hidden && button !== null && !/^p\d/.test(button.className);
      }
      row.hidden = !overview.models[row.dataset.m].name.toLowerCase().includes(text) || (trouble && !troubled);
      count += row.hidden ? 0 : 1;
    }
    for (const body of table.tBodies) body.hidden = ![...body.querySelectorAll("tr[data-m]")].some((row) => !row.hidden);
    byId("heat-count").textContent = count === rows.length ? `${count} models` : `${count} of ${rows.length} models`;
  }

  byId("heat-engine").addEventListener("change", filter);
  byId("heat-filter").addEventListener("input", filter);
  byId("heat-trouble").addEventListener("change", filter);
  const first = table.querySelector("td button");
  if (first) focusable(first);
  filter();
});
