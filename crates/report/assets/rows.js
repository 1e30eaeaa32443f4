// The rows behind whatever was clicked: a dialog with filters and a table that sorts.
(() => {
  const { byId, load, make, short, decades, glyphs, ready } = featherbench;
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
    byId("rows-filters").replaceChildren();
    byId("rows-table").replaceChildren();
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
