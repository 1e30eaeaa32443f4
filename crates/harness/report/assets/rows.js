// The rows behind whatever was clicked: a dialog with filters and a table that sorts.
(() => {
  const { byId, chunks, load, make, short, decades, glyphs, ready } = featherbench;
  const FILTERS = ["study", "engine", "quantity", "states", "body", "cache", "method", "metric", "reference", "verdict"];
  const BRIEF = ["verdict", "robot", "engine", "method", "precision", "quantity", "states", "body", "cache", "metric", "value", "relation", "bound", "margin", "reference", "reason"];
  const RELATIONS = { le: "≤", ge: "≥", eq: "=", within: "|·| ≤" };
  const NUMBERS = ["nq", "nv", "bodies", "depth", "value", "ci_low", "ci_high", "bound", "floor", "margin"];
  const PAGE = 400;

  const state = { name: "", table: null, filters: {}, text: "", sort: null, all: false, limit: PAGE };
  const at = (column) => state.table.columns.indexOf(column);

  // The address names the open rows, so that it can be passed on; where the browser forbids that, it stays as it is.
  function address(hash) {
    try { history.replaceState(null, "", location.pathname + location.search + hash); } catch { /* only the address is lost */ }
  }

  // Opens a chunk's rows, those whose columns hold the given values.
  async function open(name, filters = {}, title = "") {
    const dialog = byId("rows");
    byId("rows-title").textContent = title || "Rows";
    byId("rows-count").textContent = "Loading…";
    byId("rows-about").replaceChildren();
    byId("rows-filters").replaceChildren();
    byId("rows-table").replaceChildren();
    // In a narrow window the filters would push the rows off the screen.
    byId("rows-narrow").open = innerWidth > 768;
    if (!dialog.open) dialog.showModal();
    try {
      Object.assign(state, { name, table: await load(name), filters: { ...filters }, text: "", sort: null, limit: PAGE });
    } catch (error) {
      byId("rows-count").textContent = `${error.message}: the rows are in rows.csv as well.`;
      return;
    }
    drawFilters();
    drawRows();
    address(`#rows=${encodeURIComponent(JSON.stringify([name, filters, title]))}`);
  }

  function passes(row) {
    for (const [column, value] of Object.entries(state.filters)) {
      if (value !== "" && row[at(column)] !== value) return false;
    }
    return state.text === "" || row.some((field) => field !== null && String(field).toLowerCase().includes(state.text));
  }

  // What the shown rows are about, before the rows themselves: robot, engine, quantity and reference, the worst error and its level, and the
  // command that repeats it.
  const GRAVITY = ["fail", "error", "deviation", "pass", "skip", "info"];
  function drawAbout(rows) {
    const { pages, engines, robots, studies, titles } = chunks.get("overview");
    const list = byId("rows-about");
    list.replaceChildren();
    if (rows.length === 0) return;
    const add = (name, ...content) => list.append(make("dt", {}, name), make("dd", {}, ...content));
    const link = (kind, names) => (value) => { const page = pages[kind][names.indexOf(value)]; return page ? make("a", { href: page }, value) : value; };
    const kinds = [
      ["robot", "robot", link("robots", robots.map(({ name }) => name))], ["engine", "engine", link("engines", engines)],
      ["quantity", "quantity", (value) => titles[value] ?? value], ["reference", "reference", (value) => value], ["study", "study", link("studies", studies)],
    ];
    for (const [name, column, text] of kinds) {
      const values = [...new Set(rows.map((row) => row[at(column)]))].filter((value) => value !== "" && value !== null);
      if (values.length === 1) add(name, text(values[0]));
      else if (values.length > 1) add(name, `${values.length}: ${values.slice(0, 8).map((value) => (column === "quantity" ? titles[value] ?? value : value)).join(", ")}${values.length > 8 ? ", …" : ""}`);
    }
    const far = (row) => row[at("margin")] ?? (["fail", "error"].includes(row[at("verdict")]) ? -Infinity : Infinity);
    const worst = rows.reduce((a, b) => {
      const [one, other] = [a, b].map((row) => GRAVITY.indexOf(row[at("verdict")]));
      return other < one || (other === one && far(b) < far(a)) ? b : a;
    });
    const field = (column) => worst[at(column)];
    const where = ["robot", "states", "body", "cache", "method"].map(field).filter(Boolean).join(", ");
    if (field("value") !== null) {
      const gate = field("bound") === null ? "" : `, gate ${short(field("bound"))}${field("margin") === null ? "" : `, ${decades(field("margin"))} decades`}`;
      const measure = [titles[field("quantity")] ?? field("quantity"), field("metric")].filter(Boolean).join(", ");
      add("worst", `${measure} ${short(field("value"))}${gate} (${where})`);
    }
    const level = state.table.levels[state.table.rows.indexOf(worst)];
    add("level", level ? `${level} (${field("verdict")})` : field("verdict"));
    const again = state.table.again[`${field("study")}/${field("robot")}`];
    if (again) add("repeat it", make("code", {}, again));
  }

  function drawFilters() {
    const form = byId("rows-filters");
    form.replaceChildren();
    // A filter that was asked for has its list, so that it can be taken off.
    for (const column of new Set([...FILTERS, ...Object.keys(state.filters)])) {
      const values = [...new Set(state.table.rows.map((row) => row[at(column)]))].sort();
      const chosen = state.filters[column] ?? "";
      if (values.length < 2 && chosen === "") continue;
      if (chosen !== "" && !values.includes(chosen)) values.push(chosen);
      const select = make("select", { name: column }, make("option", { value: "" }, "all"));
      for (const value of values) if (value !== "") select.append(make("option", { value, selected: value === chosen }, value));
      select.addEventListener("change", () => { state.filters[column] = select.value; drawRows(); });
      form.append(make("label", {}, `${column} `, select));
    }
    const search = make("input", { type: "search", placeholder: "any column", autocomplete: "off" });
    search.addEventListener("input", () => { state.text = search.value.toLowerCase(); drawRows(); });
    form.append(make("label", {}, "contains ", search));
    const all = make("input", { type: "checkbox", checked: state.all });
    all.addEventListener("change", () => { state.all = all.checked; drawRows(); });
    form.append(make("label", { className: "check" }, all, " all columns"));
  }

  function compare(a, b) {
    if (a === b) return 0;
    if (a === null) return 1;
    if (b === null) return -1;
    return a < b ? -1 : 1;
  }

  function drawRows() {
    let rows = state.table.rows.filter((row) => passes(row));
    drawAbout(rows);
    byId("rows-count").textContent = `${rows.length} of ${state.table.rows.length} rows`;
    if (state.sort) {
      const { column, direction } = state.sort;
      const index = at(column);
      rows = [...rows].sort((a, b) => direction * compare(a[index], b[index]));
    }
    const shown = rows.slice(0, state.limit);
    // Columns that say nothing in these rows are left out unless all are asked for.
    const telling = (column) => shown.some((row) => row[at(column)] !== null && row[at(column)] !== "");
    const columns = state.all ? state.table.columns : BRIEF.filter(telling);
    const head = make("tr");
    for (const column of columns) {
      const button = make("button", { type: "button" }, column);
      button.addEventListener("click", () => {
        const again = state.sort && state.sort.column === column;
        state.sort = { column, direction: again ? -state.sort.direction : 1 };
        drawRows();
      });
      const cell = make("th", { scope: "col", className: NUMBERS.includes(column) ? "number" : "" }, button);
      if (state.sort && state.sort.column === column) cell.ariaSort = state.sort.direction === 1 ? "ascending" : "descending";
      head.append(cell);
    }
    const body = make("tbody");
    for (const row of shown) body.append(make("tr", {}, ...columns.map((column) => drawField(column, row[at(column)]))));
    const table = make("table", { className: "compact" }, make("thead", {}, head), body);
    byId("rows-table").replaceChildren(table);
    if (rows.length > shown.length) {
      const more = make("button", { type: "button", className: "more" }, `Show the other ${rows.length - shown.length}`);
      more.addEventListener("click", () => { state.limit = Infinity; drawRows(); });
      byId("rows-table").append(more);
    }
  }

  function drawField(column, value) {
    if (column === "verdict") return make("td", {}, make("span", { className: `badge ${value}` }, `${glyphs[value] ?? "?"} ${value}`));
    if (column === "relation") return make("td", {}, RELATIONS[value] ?? "");
    if (column === "margin") return make("td", { className: "number" }, decades(value));
    if (NUMBERS.includes(column)) return make("td", { className: "number", title: value === null ? "" : String(value) }, short(value));
    return make("td", { className: column === "reason" ? "reason" : "" }, value === null ? "" : String(value));
  }

  function openFromAddress() {
    if (!location.hash.startsWith("#rows=")) return;
    try {
      const [name, filters, title] = JSON.parse(decodeURIComponent(location.hash.slice(6)));
      if (/^(unpassed|(robot|study)-[0-9]+)$/.test(name)) open(name, filters, title);
    } catch { /* an address that someone cut: the page is still good */ }
  }

  ready(() => {
    const dialog = byId("rows");
    byId("rows-close").addEventListener("click", () => dialog.close());
    dialog.addEventListener("click", (event) => { if (event.target === dialog) dialog.close(); });
    dialog.addEventListener("close", () => address(""));
    byId("rows-filters").addEventListener("submit", (event) => event.preventDefault());
    document.addEventListener("click", (event) => {
      const opener = event.target.closest("[data-chunk]");
      if (opener) open(opener.dataset.chunk, JSON.parse(opener.dataset.filter || "{}"), opener.dataset.title || "");
    });
    openFromAddress();
  });

  featherbench.open = open;
})();
