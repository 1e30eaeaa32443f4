"use strict";
// The page's one global: data scripts call featherbench.chunk(name, data); everything else below hangs on it.
const featherbench = (() => {
  const chunks = new Map();
  const waiting = new Map();

  // A data script delivers.
  function chunk(name, data) {
    chunks.set(name, data);
    const promise = waiting.get(name);
    if (promise) promise.resolve(data);
  }

  // A chunk's data: at hand, on its way, or brought by adding its script to the page.
  function load(name, file = `data/${name}.js`) {
    if (chunks.has(name)) return Promise.resolve(chunks.get(name));
    if (!waiting.has(name)) {
      const entry = {};
      entry.promise = new Promise((resolve, reject) => {
        entry.resolve = resolve;
        const script = document.createElement("script");
        script.src = file;
        script.onerror = () => {
          waiting.delete(name);
          script.remove();
          reject(new Error(`${file} is missing or damaged`));
        };
        // A script that ran without delivering was cut or altered.
        script.onload = () => { if (!chunks.has(name)) script.onerror(); };
        document.head.append(script);
      });
      waiting.set(name, entry);
    }
    return waiting.get(name).promise;
  }

  // An element with properties and children; strings become text, never markup.
  function make(tag, properties = {}, ...children) {
    const element = Object.assign(document.createElement(tag), properties);
    element.append(...children);
    return element;
  }

  // A number as the tables have it.
  function short(value) {
    if (value === null || value === undefined) return "";
    if (value === 0) return "0";
    const size = Math.abs(value);
    if (size < 1e-3 || size >= 1e6) return value.toExponential(2).replace(/\.?0+e/, "e").replace("e+", "e");
    return Number.isInteger(value) ? String(value) : String(Number(value.toPrecision(4)));
  }

  const decades = (margin) => (margin === null ? "" : (margin < 0 ? "−" : "+") + Math.abs(Math.floor(margin * 10) / 10).toFixed(1));
  const glyphs = { pass: "✓", fail: "✕", error: "!", deviation: "≈", skip: "–", info: "·" };
  const variable = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const byId = (id) => document.getElementById(id);

  // A robot in a line.
  const describe = (robot) => `${robot.family}, ${robot.nv ?? "?"} degrees of freedom, ${robot.bodies ?? "?"} bodies, depth ${robot.depth ?? "?"}`;

  // Runs a task when the page and its data are complete; each on its own, so that one that fails leaves the others.
  const ready = (task) => { if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", task); else task(); };

  // Runs a task on the page, and on each piece that is brought later.
  const dressers = [];
  const dress = (root) => { for (const task of dressers) task(root); };
  const dressed = (task) => { dressers.push(task); ready(() => task(document)); };

  return { chunk, load, make, short, decades, glyphs, variable, byId, describe, ready, dress, dressed, chunks };
})();

// Light and dark: the system's choice until the reader makes one, which is kept where the browser allows it. Paper is light.
(() => {
  const { byId, ready } = featherbench;
  const root = document.documentElement;
  const system = matchMedia("(prefers-color-scheme: dark)");
  const remembered = () => { try { return localStorage.getItem("featherbench-theme"); } catch { return null; } };
  const remember = (theme) => { try { localStorage.setItem("featherbench-theme", theme); } catch { /* then only this page knows */ } };
  let chosen = remembered();

  function apply(theme) {
    root.dataset.theme = theme;
    document.dispatchEvent(new CustomEvent("themechange"));
  }
  const restore = () => apply(chosen === "light" || chosen === "dark" ? chosen : system.matches ? "dark" : "light");

  restore();
  system.addEventListener("change", restore);
  addEventListener("beforeprint", () => apply("light"));
  addEventListener("afterprint", restore);
  ready(() => byId("theme").addEventListener("click", () => {
    chosen = root.dataset.theme === "dark" ? "light" : "dark";
    remember(chosen);
    restore();
  }));
})();

// The command's copy button. Under file:// a browser may refuse its clipboard; then the command is selected, ready to be copied.
document.addEventListener("click", async (event) => {
  const button = event.target.closest("#copy");
  if (!button) return;
  const text = featherbench.byId("command");
  try {
    await navigator.clipboard.writeText(text.textContent);
    button.textContent = "Copied";
  } catch {
    getSelection().selectAllChildren(text);
    button.textContent = "Selected";
  }
  setTimeout(() => { button.textContent = "Copy"; }, 1500);
});

// Tables whose columns sort on a click on their head.
featherbench.dressed((root) => {
  const key = (row, column) => {
    const cell = row.cells[column];
    const text = cell.textContent.trim();
    if (!cell.classList.contains("number")) return text;
    const number = parseFloat(text.replace("−", "-").replace(/[\u202f≈]/g, ""));
    return Number.isNaN(number) ? -Infinity : number;
  };
  const order = (a, b) => (a === b ? 0 : a < b ? -1 : 1);
  for (const table of root.querySelectorAll("table.sortable")) {
    for (const head of table.tHead.rows[0].cells) {
      const button = featherbench.make("button", { type: "button" });
      button.append(...head.childNodes);
      head.append(button);
      button.addEventListener("click", () => {
        const direction = head.ariaSort === "ascending" ? -1 : 1;
        for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
        head.ariaSort = direction === 1 ? "ascending" : "descending";
        const rows = [...table.tBodies[0].rows].map((row) => [key(row, head.cellIndex), row]);
        rows.sort(([a], [b]) => direction * order(a, b));
        table.tBodies[0].append(...rows.map(([, row]) => row));
      });
    }
  }
});

// Boxes that scroll and hold nothing that Tab reaches are reached themselves, so that the arrow keys scroll them.
(() => {
  const focusable = (box) => {
    const scrolls = box.scrollWidth > box.clientWidth || box.scrollHeight > box.clientHeight;
    if (scrolls && !box.querySelector("a, button, input, select")) box.tabIndex = 0;
    else box.removeAttribute("tabindex");
  };
  const all = (root) => { for (const box of [...root.querySelectorAll(".scroll"), ...(root.matches?.(".scroll") ? [root] : [])]) focusable(box); };
  featherbench.dressed(all);
  addEventListener("resize", () => all(document));
  document.addEventListener("toggle", ({ target }) => all(target), true);
})();
// Pieces that the page leaves out at first: each is brought when it is opened or when the window is near it. A section's script runs when the
// section is there and the data of all sections are.
(() => {
  const { byId, dress, load, ready } = featherbench;
  const scripts = new Map();
  const NEAR = "300px";
  // The section that the reader went to, until the reader scrolls: what is brought above it must not push it away.
  let goal = "";

  // Puts the piece in its place, and returns what stands there now.
  async function bring(place) {
    const name = place.dataset.part;
    if (!name || place.ariaBusy === "true") return place;
    place.ariaBusy = "true";
    try {
      const box = document.createElement("template");
      box.innerHTML = await load(`part-${name}`, `sections/${name}.js`);
      const pieces = [...box.content.children];
      const seen = goal ? null : [...document.querySelectorAll("main > section")].find((section) => section.getBoundingClientRect().bottom > 0);
      const before = seen?.getBoundingClientRect().top;
      place.replaceWith(box.content);
      if (goal) byId(goal)?.scrollIntoView({ behavior: "instant" });
      else if (seen?.isConnected) scrollBy({ top: seen.getBoundingClientRect().top - before, behavior: "instant" });
      for (const piece of pieces) dress(piece);
      return pieces[0];
    } catch (error) {
      // The link to the piece's page stays.
      place.ariaBusy = "false";
      place.append(featherbench.make("p", { className: "note" }, error.message));
      return place;
    }
  }

  async function show(section) {
    const there = await bring(section);
    const script = scripts.get(there.id);
    if (!script) return;
    scripts.delete(there.id);
    // One section that fails leaves the others.
    try {
      await load("figures");
      script();
    } catch (error) {
      reportError(error);
    }
  }

  // Every section and piece, for the browser's search and for print.
  async function everything() {
    await Promise.all([...document.querySelectorAll("main > section")].map(show));
    await Promise.all([...document.querySelectorAll("[data-part]")].map(bring));
  }

  // An address may name an element of a section that is not here yet.
  async function follow() {
    const id = decodeURIComponent(location.hash.slice(1));
    if (id === "" || id.startsWith("rows=")) return;
    goal = id;
    if (byId(id)) return;
    await everything();
    byId(id)?.scrollIntoView();
  }

  ready(() => {
    const near = new IntersectionObserver((entries) => {
      for (const { target, isIntersecting } of entries) {
        if (!isIntersecting) continue;
        near.unobserve(target);
        show(target);
      }
    }, { rootMargin: NEAR });
    for (const section of document.querySelectorAll("main > section")) near.observe(section);
    document.addEventListener("toggle", (event) => {
      if (event.target.open) for (const place of event.target.querySelectorAll(":scope > [data-part]")) bring(place);
    }, true);
    byId("everything")?.addEventListener("click", everything);
    addEventListener("hashchange", follow);
    for (const kind of ["wheel", "touchmove", "keydown", "pointerdown"]) addEventListener(kind, () => { goal = ""; }, { passive: true });
    follow();
  });

  featherbench.section = (anchor, script) => scripts.set(anchor, script);
  featherbench.bring = bring;
  featherbench.everything = everything;
})();
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
// Tables of buttons: a tip for what is pointed at, and walking with the arrow keys.
(() => {
  const { byId, make } = featherbench;
  let tipped = null;

  // Over the button, or under it where there is no room.
  function placeTip() {
    const tip = byId("tip");
    if (!tip || tip.hidden) return;
    const box = tipped.getBoundingClientRect();
    const left = Math.min(Math.max(8, box.left + box.width / 2 - tip.offsetWidth / 2), innerWidth - tip.offsetWidth - 8);
    const above = box.top - tip.offsetHeight - 8;
    tip.style.left = `${left}px`;
    tip.style.top = `${above > 8 ? above : box.bottom + 8}px`;
  }

  function hideTip() {
    byId("tip").hidden = true;
  }

  function showTip(button, lines) {
    const tip = byId("tip");
    tip.replaceChildren(...lines.map((line, index) => make("div", {}, index === 0 ? make("b", {}, line) : line)));
    tip.hidden = false;
    tipped = button;
    placeTip();
    button.setAttribute("aria-describedby", "tip");
  }

  addEventListener("scroll", placeTip, { passive: true, capture: true });

  // Makes a table a grid. `about(button)` is the tip's lines, `open(button)` what a click does. Rows with data-m can be walked.
  featherbench.grid = (table, about, open) => {
    const found = () => [...table.querySelectorAll("tr[data-m]")];

    // One button at a time is reached with Tab; the arrows go to the next one in their direction that is there and shown.
    function focusable(button) {
      table.querySelector("button[tabindex='0']")?.setAttribute("tabindex", "-1");
      button.setAttribute("tabindex", "0");
    }

    function step(button, down, right) {
      const shown = found().filter((row) => !row.hidden);
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
      hideTip();
      open(button);
    });
    for (const [start, end] of [["pointerover", "pointerout"], ["focusin", "focusout"]]) {
      table.addEventListener(start, (event) => { const button = event.target.closest("button"); if (button) showTip(button, about(button)); });
      table.addEventListener(end, hideTip);
    }

    // Shows the columns and rows that pass; families without a row vanish with them. Returns how many rows are left. A column that
    // vanishes takes the way in with it: the first button that is shown becomes the one that Tab reaches.
    function filter(column, row) {
      let count = 0;
      const rows = found();
      const what = table.dataset.of ?? "robot";
      for (const line of rows) {
        for (const cell of line.cells) if (cell.tagName !== "TH") cell.hidden = !column(cell.cellIndex - 1);
        line.hidden = !row(line);
        count += line.hidden ? 0 : 1;
      }
      for (const body of table.tBodies) body.hidden = ![...body.querySelectorAll("tr[data-m]")].some((line) => !line.hidden);
      const way = table.querySelector("button[tabindex='0']");
      if (!way || way.closest("[hidden]")) {
        const first = [...table.querySelectorAll("td button")].find((button) => !button.closest("[hidden]"));
        if (first) focusable(first);
      }
      const noun = rows.length === 1 ? what : what.replace(/y$/, "ie") + "s";
      return count === rows.length ? `${count} ${noun}` : `${count} of ${rows.length} ${noun}`;
    }
    return { filter };
  };
})();
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
// Axes of charts: ranges, scales, ticks and their labels. Nothing here touches the page.
featherbench.axes = (() => {
  // Enough for every decade of a double; a loop over ticks ends here whatever its range is.
  const MOST = 700;

  // Exact, which 10 ** n is not everywhere.
  const ten = (n) => Number(`1e${n}`);

  // A logarithm needs a positive number.
  const fits = (log, value) => typeof value === "number" && Number.isFinite(value) && (!log || value > 0);

  // Ranges are in values on a linear axis, in decades on a logarithmic one.
  const inner = (log, value) => (log ? Math.log10(value) : value);

  // The range of all values that fit, with air at both ends; null where none fits.
  function range(log, values) {
    let [least, most] = [Infinity, -Infinity];
    for (const value of values) {
      if (!fits(log, value)) continue;
      const place = inner(log, value);
      [least, most] = [Math.min(least, place), Math.max(most, place)];
    }
    if (least > most) return null;
    // Values that are one up to rounding have a range without length: it is opened.
    const length = most - least > 1e-9 * Math.abs(most) ? most - least : 0;
    const air = length > 0 ? 0.05 * length : log ? 0.5 : 0.1 * Math.abs(most) || 1;
    return [least - air, most + air];
  }

  // From values to positions between two places on the screen, and back into the range.
  function scale(log, [least, most], from, to) {
    return {
      log, range: [least, most], from, to,
      at: (value) => from + ((to - from) * (inner(log, value) - least)) / (most - least),
      back: (position) => least + ((most - least) * (position - from)) / (to - from),
    };
  }

  // 1, 2 or 5 times a power of ten, at least as large as asked.
  function nice(least) {
    const unit = ten(Math.floor(Math.log10(least)));
    return unit * ([1, 2, 5].find((digit) => digit * unit >= least * (1 - 1e-9)) ?? 10);
  }

  function multiples(step, least, most) {
    const found = [];
    for (let n = Math.ceil(least / step - 1e-9), i = 0; n <= most / step + 1e-9 && i < MOST; n += 1, i += 1) {
      // 3 / 10 is 0.3, 3 · 0.1 is not.
      found.push(step < 1 ? n / Math.round(1 / step) : n * step);
    }
    return found;
  }

  function linear(least, most, count) {
    const step = nice((most - least) / count);
    return { major: multiples(step, least, most), minor: [] };
  }

  // Decades where there are many; 1, 2 and 5 where there is room; even steps of the value within less than a decade.
  function logarithmic(least, most, count) {
    const length = most - least;
    if (length < 0.5 || (length < 1 && count >= 8)) {
      const [low, high] = [10 ** least, 10 ** most];
      const step = nice((high - low) / count);
      const major = multiples(step, low, high);
      return { major, minor: multiples(step / 5, low, high).filter((value) => !major.some((other) => Math.abs(other - value) < step / 10)) };
    }
    const decades = multiples(1, Math.floor(least), most);
    const within = (value) => Math.log10(value) >= least - 1e-9 && Math.log10(value) <= most + 1e-9;
    const times = (digits) => decades.flatMap((decade) => digits.map((digit) => digit * ten(decade))).filter(within);
    if (length < 2 || 3 * length <= count) return { major: times([1, 2, 5]), minor: times([3, 4, 6, 7, 8, 9]) };
    const step = [1, 2, 3, 4, 5, 10, 20, 50, 100].find((decade) => length / decade <= count) ?? 200;
    const major = decades.filter((decade) => decade % step === 0).map(ten).filter(within);
    // Nine lines to a decade need more room than its label.
    if (step === 1) return { major, minor: times(2 * length <= count ? [2, 3, 4, 5, 6, 7, 8, 9] : [2, 5]) };
    return { major, minor: times([1]).filter((value) => !major.includes(value)) };
  }

  const ticks = (log, [least, most], count) => (log ? logarithmic : linear)(least, most, Math.max(2, count));

  // A number in full, with narrow spaces between thousands from ten thousand on.
  function full(value) {
    const text = String(Number(value.toPrecision(10))).replace("-", "−");
    return Math.abs(value) < 1e4 ? text : text.replace(/\B(?=(\d{3})+(?!\d))/g, "\u202f");
  }

  // A number as a power of ten: the text, and the exponent that stands above it.
  function power(value) {
    const exponent = Math.floor(Math.log10(Math.abs(value)) + 1e-9);
    const digits = Number((value / ten(exponent)).toPrecision(6));
    return [digits === 1 ? "10" : `${digits}×10`.replace("-", "−"), String(exponent).replace("-", "−")];
  }

  // All labels of an axis are of one kind: powers as soon as one number is too long in full.
  function labels(values) {
    const long = (value) => value !== 0 && (Math.abs(value) < 0.99e-4 || Math.abs(value) > 1.01e6);
    const powers = values.some(long);
    return values.map((value) => (powers && value !== 0 ? power(value) : [full(value)]));
  }

  return { fits, inner, range, scale, ticks, labels, power };
})();
// What charts are drawn with: elements of SVG, symbols, dashes, texts and their widths.
featherbench.marks = (() => {
  const { make, variable } = featherbench;
  // Read from an element, so that no script of a report holds an address.
  const SPACE = make("template", { innerHTML: "<svg></svg>" }).content.firstChild.namespaceURI;

  // An element of SVG with attributes and children; null leaves an attribute out.
  function svg(tag, attributes = {}, ...children) {
    const element = document.createElementNS(SPACE, tag);
    for (const [name, value] of Object.entries(attributes)) if (value !== null && value !== undefined) element.setAttribute(name, value);
    element.append(...children);
    return element;
  }

  // A tenth of a pixel is enough, and keeps saved figures small.
  const round = (value) => Math.round(value * 10) / 10;

  // Corners about the origin: two radii in turn make a star, one a polygon.
  function corners(count, ...radii) {
    return Array.from({ length: count * radii.length }, (_, index) => {
      const angle = (2 * Math.PI * index) / (count * radii.length) - Math.PI / 2;
      const radius = radii[index % radii.length];
      return [radius * Math.cos(angle), radius * Math.sin(angle)];
    });
  }
  const turned = (points) => points.map(([x, y]) => [(x - y) * Math.SQRT1_2, (x + y) * Math.SQRT1_2]);
  const PLUS = [[-0.4, -1.15], [0.4, -1.15], [0.4, -0.4], [1.15, -0.4], [1.15, 0.4], [0.4, 0.4], [0.4, 1.15], [-0.4, 1.15], [-0.4, 0.4], [-1.15, 0.4], [-1.15, -0.4], [-0.4, -0.4]];
  // Radii differ so that all symbols look equally large.
  const SHAPES = {
    square: turned(corners(4, 1.25)), diamond: corners(4, 1.3), triangle: corners(3, 1.35), plus: PLUS, star: corners(5, 1.45, 0.62),
    pentagon: corners(5, 1.15), hexagram: corners(6, 1.35, 0.78), cross: turned(PLUS),
  };

  function outline(symbol, size) {
    const radius = size / 2;
    if (symbol === "circle") return `M${-radius} 0a${radius} ${radius} 0 1 0 ${size} 0a${radius} ${radius} 0 1 0 ${-size} 0z`;
    if (symbol === "tick") return `M${-radius} 0h${size}`;
    const points = SHAPES[symbol] ?? SHAPES.square;
    return `M${points.map(([x, y]) => `${Math.round(100 * x * radius) / 100} ${Math.round(100 * y * radius) / 100}`).join("L")}z`;
  }

  // A mark at a place. Filled ones have a thin edge of the paper's colour, so that marks on one another can be told apart.
  function mark({ symbol, hollow, size, ink, paper }, x, y) {
    const line = hollow || symbol === "tick";
    return svg("path", {
      d: outline(symbol, size), transform: `translate(${round(x)} ${round(y)})`, fill: hollow ? paper : ink,
      stroke: line ? ink : paper, "stroke-width": line ? 1.4 : 0.7, "stroke-linejoin": "round",
    });
  }

  // Dashes in units of the line's width.
  const DASHES = { solid: null, dash: [6, 4], dot: [1.5, 3], dashdot: [6, 3, 1.5, 3], longdash: [11, 4], longdashdot: [11, 3, 1.5, 3] };
  const dashes = (name, width) => DASHES[name]?.map((part) => part * Math.max(1, width)).join(" ");

  // A line through points on the screen; a step goes across first, then up or down.
  function line(points, style, ink) {
    const [first, ...rest] = points.map(([x, y]) => [round(x), round(y)]);
    const way = rest.map(([x, y]) => (style.step ? `H${x}V${y}` : `L${x} ${y}`)).join("");
    const width = style.width ?? 1.4;
    return svg("path", {
      d: `M${first.join(" ")}${way}`, fill: "none", stroke: ink, "stroke-width": width, "stroke-dasharray": dashes(style.dash, width),
      "stroke-linejoin": "round", opacity: style.opacity,
    });
  }

  // The bar from one place to another with an end across each: along x where `flat`.
  function bar(flat, across, from, to, ink) {
    const [a, b, at] = [from, to, across].map(round);
    const end = 2.5;
    const path = flat ? `M${a} ${at}H${b}M${a} ${at - end}v${2 * end}M${b} ${at - end}v${2 * end}` : `M${at} ${a}V${b}M${at - end} ${a}h${2 * end}M${at - end} ${b}h${2 * end}`;
    return svg("path", { class: "bar", d: path, fill: "none", stroke: ink, "stroke-width": 1.2 });
  }

  // A text, with an exponent above the line where there is one.
  function text([words, exponent], x, y, attributes) {
    const element = svg("text", { x: round(x), y: round(y), ...attributes }, words);
    if (exponent !== undefined) element.append(svg("tspan", { dy: "-0.42em", "font-size": "0.76em" }, exponent));
    return element;
  }

  const context = document.createElement("canvas").getContext("2d");

  // The width of a text as the function above draws it.
  function measure([words, exponent], size) {
    context.font = `${size}px ${variable("--sans")}`;
    const width = context.measureText(words).width;
    return exponent === undefined ? width : width + 0.76 * context.measureText(exponent).width;
  }

  // The longest beginning of a text that has room.
  function shorten(words, size, room) {
    if (measure([words], size) <= room) return words;
    let count = words.length - 1;
    while (count > 0 && measure([`${words.slice(0, count)}…`], size) > room) count -= 1;
    return `${words.slice(0, count)}…`;
  }

  // The sample of a series that stands beside its name.
  function sample(series, paper, x = 14, y = 8) {
    const group = svg("g");
    const style = series.line;
    if (style) group.append(line([[x - 13, y], [x + 13, y]], { ...style, step: false, width: Math.min(style.width ?? 1.4, 5) }, series.ink));
    // On a dashed line a level stroke would close the gaps.
    if (series.mark && !(style && series.mark.symbol === "tick")) {
      // As the points are where all are alike.
      const [first] = series.points;
      const alike = (key) => first !== undefined && series.points.every((point) => point[key] === first[key]);
      const symbol = (alike("symbol") && first.symbol) || series.mark.symbol;
      group.append(mark({ symbol, hollow: alike("hollow") && first.hollow, size: Math.min(series.mark.size, 9), ink: series.ink, paper }, x, y));
    }
    return group;
  }

  return { svg, round, mark, line, bar, text, measure, shorten, sample };
})();
// A chart as elements of SVG: `drawing.draw(view)` has no memory and handles no events.
//
// The view is { series, shape, zoom, width, height, clip }. A series is { name, note, ink, points, mark, line, broad, guide }:
//   points  { x, y, left, right, low, high, symbol, hollow, label, soft, tip, target }: intervals, a label beside the mark, the lines of its tip, and
//           what a click opens; all but x and y may be absent
//   mark    { symbol, size, opacity }; where it is absent, points have no marks
//   line    { width, dash, opacity, step, path }; the path is [x, y] each, that of the points unless it is given
//   broad   [x, y] each: a broad pale line under everything, for fits
//   guide   a value of y: a line from edge to edge, which is no value of its own
// The shape is { x, y, bands, empty }. An axis is { title, log, range, ticks, least, turn }: ticks are [value, text, exponent], `least` is the value that
// stands for all below it, `turn` lets labels stand aslant. Bands are [from, to, ink] along y. `empty` is written where there is nothing to draw.
featherbench.drawing = (() => {
  const { axes, variable } = featherbench;
  const { svg, mark, line, bar, text, measure, shorten } = featherbench.marks;
  const SMALL = 12;
  const SIZE = 13;
  // The slope of labels that would touch when level, in degrees.
  const SLOPE = 38;

  // --- Ranges and ticks.

  const along = (points) => points.map(({ x, y }) => [x, y]);
  const path = (series) => series.line?.path ?? (series.line ? along(series.points) : []);

  // All numbers of a series along an axis: marks, intervals and lines are to be seen whole.
  function numbers(series, key) {
    const index = key === "x" ? 0 : 1;
    const ends = key === "x" ? ["x", "left", "right"] : ["y", "low", "high"];
    const lines = [...path(series), ...(series.broad ?? [])].map((point) => point[index]);
    return [...series.points.flatMap((point) => ends.map((end) => point[end])), ...lines, key === "y" ? series.guide : undefined];
  }

  // The range that an axis has by itself; bands are to be seen whatever the values are.
  function home(series, shape, key) {
    const axis = shape[key];
    if (axis.range) return axis.range.map((value) => axes.inner(axis.log, value));
    const bands = key === "y" ? (shape.bands ?? []).flatMap(([from, to]) => [from, to]) : [];
    return axes.range(axis.log, [...series.flatMap((one) => numbers(one, key)), ...bands]);
  }

  // Ticks and labels: an axis's own, or even ones. Below the least value nothing is told apart, and its label says so.
  function ticks(axis, range, count, floored) {
    if (axis.ticks) {
      const found = axis.ticks.filter(([value]) => axes.fits(axis.log, value)).map(([value, ...label]) => ({ value, label, place: axes.inner(axis.log, value) }));
      const kept = found.filter(({ place }) => place >= range[0] && place <= range[1]);
      return { major: kept.map(({ value }) => value), minor: [], labels: kept.map(({ label }) => label) };
    }
    const above = (value) => !floored || value > 0.99 * axis.least;
    const found = axes.ticks(axis.log, range, Math.floor(count));
    const major = found.major.filter(above);
    const labels = axes.labels(major).map(([words, ...exponent], index) => [(floored && major[index] < 1.01 * axis.least ? "≤ " : "") + words, ...exponent]);
    return { major, minor: found.minor.filter(above), labels };
  }

  const widest = (labels) => Math.max(0, ...labels.map((label) => measure(label, SMALL)));

  // Scales, ticks, and the box between the axes; null where no point has a place.
  function plan({ series, shape, zoom, width, height }) {
    const placed = (point) => axes.fits(shape.x.log, point.x) && axes.fits(shape.y.log, point.y);
    if (!series.some((one) => one.points.some(placed))) return null;
    const [across, up] = [zoom?.x ?? home(series, shape, "x"), zoom?.y ?? home(series, shape, "y")];
    const own = (shape.x.ticks ?? []).map(([, ...label]) => label);
    const turned = Boolean(shape.x.turn) && (widest(own) + 10) * own.length > width - 80;
    const slope = (SLOPE * Math.PI) / 180;
    const tall = turned ? widest(own) * Math.sin(slope) + 18 : 22;
    const box = { top: shape.y.title ? 34 : 12, bottom: height - tall - (shape.x.title ? 26 : 6), right: width - 14 };
    const floored = shape.y.least !== undefined && series.some((one) => one.points.some((point) => point.y <= shape.y.least));
    const yTicks = ticks(shape.y, up, (box.bottom - box.top) / 38, floored);
    // The first label that stands aslant needs room on the left.
    box.left = Math.max(36, widest(yTicks.labels) + 14, turned ? measure(own[0], SMALL) * Math.cos(slope) - 10 : 0);
    const xTicks = ticks(shape.x, across, (box.right - box.left) / 75, false);
    return { box, turned, tall, xTicks, yTicks, x: axes.scale(shape.x.log, across, box.left, box.right), y: axes.scale(shape.y.log, up, box.bottom, box.top) };
  }

  // --- Axes.

  function drawGrid({ box, x, y, xTicks, yTicks }) {
    const up = (value) => `M${x.at(value).toFixed(1)} ${box.top}V${box.bottom}`;
    const across = (value) => `M${box.left} ${y.at(value).toFixed(1)}H${box.right}`;
    const lines = (kind) => [...xTicks[kind].map(up), ...yTicks[kind].map(across)].join("");
    const ends = [...xTicks.major.map((value) => `M${x.at(value).toFixed(1)} ${box.bottom}v5`), ...yTicks.major.map((value) => `M${box.left} ${y.at(value).toFixed(1)}h-5`)];
    return svg("g", { fill: "none" },
      svg("path", { class: "minor", d: lines("minor"), stroke: variable("--line"), opacity: 0.45 }),
      svg("path", { class: "major", d: lines("major"), stroke: variable("--line") }),
      svg("path", { d: `${ends.join("")}M${box.left} ${box.top}V${box.bottom}H${box.right}`, stroke: variable("--soft"), opacity: 0.7 }));
  }

  // Labels from left to right; one that would touch its neighbour is left out.
  function drawAcross({ box, x, xTicks, turned }) {
    const group = svg("g", { class: "xticks", fill: variable("--soft"), "font-size": SMALL, "text-anchor": turned ? "end" : "middle" });
    let end = -Infinity;
    xTicks.major.forEach((value, index) => {
      const [place, half] = [x.at(value), turned ? SMALL * 0.55 : 4 + measure(xTicks.labels[index], SMALL) / 2];
      if (place - half < end) return;
      end = place + half;
      const below = box.bottom + (turned ? 14 : 19);
      group.append(text(xTicks.labels[index], place, below, turned ? { transform: `rotate(${-SLOPE} ${place.toFixed(1)} ${below})` } : {}));
    });
    return group;
  }

  function drawUp({ box, y, yTicks }) {
    const group = svg("g", { class: "yticks", fill: variable("--soft"), "font-size": SMALL, "text-anchor": "end" });
    yTicks.major.forEach((value, index) => group.append(text(yTicks.labels[index], box.left - 9, y.at(value) + 4, {})));
    return group;
  }

  // A title over its axis lies flat: long ones have room, and no head is turned. The other is in the middle of its axis, never beyond the edge.
  function drawTitles({ shape, width }, { box, tall }) {
    const style = { fill: variable("--ink"), "font-size": SIZE };
    const [words, above] = [shape.x.title, shape.y.title].map((title) => shorten(title ?? "", SIZE, width - 4));
    const half = measure([words], SIZE) / 2;
    const middle = Math.min(Math.max((box.left + box.right) / 2, half), width - half);
    return [text([above], 0, 15, { class: "ytitle", ...style }), text([words], middle, box.bottom + tall + 18, { class: "xtitle", "text-anchor": "middle", ...style })];
  }

  // --- Series.

  const inside = (box, x, y) => x >= box.left - 0.5 && x <= box.right + 0.5 && y >= box.top - 0.5 && y <= box.bottom + 0.5;

  function drawBands(bands, { box, y }) {
    return bands.map(([from, to, ink]) => {
      const [top, bottom] = [y.at(to), y.at(from)];
      return svg("rect", { class: "band", x: box.left, width: box.right - box.left, y: top.toFixed(1), height: Math.max(1, bottom - top).toFixed(1), fill: ink, opacity: 0.7 });
    });
  }

  // Broad lines, guides, and lines, in this order. A point that has no place is left out of its line.
  function drawLines(series, { box, x, y }) {
    const place = (points) => points.filter(([a, b]) => axes.fits(x.log, a) && axes.fits(y.log, b)).map(([a, b]) => [x.at(a), y.at(b)]);
    const guide = (value) => (axes.fits(y.log, value) ? [[box.left, y.at(value)], [box.right, y.at(value)]] : []);
    const all = [
      ...series.map((one) => [one, place(one.broad ?? []), { width: 5, opacity: 0.18 }]),
      ...series.map((one) => [one, guide(one.guide), one.line]),
      ...series.map((one) => [one, place(path(one)), one.line]),
    ];
    return all.filter(([, points]) => points.length > 1).map(([one, points, style]) => tagged(line(points, style, one.ink), one));
  }

  // What belongs to a series can be found by its number.
  function tagged(element, series) {
    element.setAttribute("data-k", series.k);
    return element;
  }

  // An interval whose end has no place goes on to the edge; one that is absent ends at the mark.
  function drawBars(series, point, { box, x, y }) {
    const end = (scale, value, other, edge) => (value === null || value === undefined ? scale.at(other) : axes.fits(scale.log, value) ? scale.at(value) : edge);
    const found = [];
    const has = (...values) => values.some((value) => value !== null && value !== undefined);
    if (has(point.left, point.right)) found.push(bar(true, y.at(point.y), end(x, point.left, point.x, box.left), end(x, point.right, point.x, box.right), series.ink));
    if (has(point.low, point.high)) found.push(bar(false, x.at(point.x), end(y, point.low, point.y, box.bottom), end(y, point.high, point.y, box.top), series.ink));
    return found.map((element) => tagged(element, series));
  }

  // The marks that are inside the box, from the undermost to the uppermost, with their places.
  function spotsOf(series, { box, x, y }) {
    const found = [];
    for (const one of series) {
      for (const point of one.points) {
        if (!axes.fits(x.log, point.x) || !axes.fits(y.log, point.y)) continue;
        const spot = { series: one, point, x: x.at(point.x), y: y.at(point.y) };
        if (inside(box, spot.x, spot.y)) found.push(spot);
      }
    }
    return found;
  }

  function drawMark({ series, point, x, y }, paper) {
    const { symbol, size, opacity } = series.mark;
    const element = mark({ symbol: point.symbol ?? symbol, hollow: point.hollow, size, ink: series.ink, paper }, x, y);
    element.setAttribute("class", "mark");
    if (opacity !== undefined) element.setAttribute("opacity", opacity);
    return tagged(element, series);
  }

  // Labels beside their marks: the first of six places that touches no other label, no mark and no edge; the first place where all do.
  function drawLabels(spots, box) {
    const taken = spots.map((spot) => [spot.x - 7, spot.y - 7, spot.x + 7, spot.y + 7]);
    const touches = ([left, top, right, bottom]) => left < box.left || right > box.right || top < box.top || bottom > box.bottom
      || taken.some(([l, t, r, b]) => left < r && right > l && top < b && bottom > t);
    // From right to left: the first place, on the right, is then free for the mark that has nothing beside it.
    const labelled = spots.filter(({ point }) => point.label).sort((a, b) => b.x - a.x);
    return labelled.map(({ series, point, x, y }) => {
      const width = measure([point.label], SMALL);
      const around = [[10, -10], [10, 19], [-10 - width, -10], [-10 - width, 19], [-width / 2, -14], [-width / 2, 23]];
      const boxes = around.map(([dx, dy]) => [x + dx, y + dy - SMALL, x + dx + width, y + dy + 2]);
      const chosen = Math.max(0, boxes.findIndex((one) => !touches(one)));
      taken.push(boxes[chosen]);
      const [dx, dy] = around[chosen];
      return tagged(text([point.label], x + dx, y + dy, { "font-size": SMALL, fill: variable(point.soft ? "--soft" : "--ink") }), series);
    });
  }

  // --- The whole.

  function nothing({ shape, width, height }) {
    const words = shorten(shape.empty ?? "no values to draw", SIZE, width - 4);
    return text([words], width / 2, height / 2, { class: "nothing", "text-anchor": "middle", "font-size": SIZE, fill: variable("--soft") });
  }

  // The elements, the marks' places and the scales of a view.
  function draw(view) {
    const whole = plan(view);
    if (!whole) return { elements: [nothing(view)], spots: [], whole };
    const { box } = whole;
    const spots = spotsOf(view.series, whole);
    const paper = variable("--panel");
    // A zoom cuts through lines and bars.
    const clip = svg("clipPath", { id: view.clip }, svg("rect", { x: box.left, y: box.top, width: box.right - box.left, height: box.bottom - box.top }));
    const cut = (name, children) => svg("g", { class: name, "clip-path": `url(#${view.clip})` }, ...children);
    const marked = spots.filter(({ series }) => series.mark);
    const elements = [
      svg("defs", {}, clip), cut("bands", drawBands(view.shape.bands ?? [], whole)), drawGrid(whole), drawAcross(whole), drawUp(whole), ...drawTitles(view, whole),
      cut("lines", drawLines(view.series, whole)), svg("g", { class: "marks" }, ...marked.map((spot) => drawMark(spot, paper))),
      // Above the marks, because an interval may be shorter than its mark.
      cut("bars", spots.flatMap(({ series, point }) => drawBars(series, point, whole))), svg("g", { class: "labels" }, ...drawLabels(marked, box)),
    ];
    return { elements, spots: marked, whole };
  }

  return { draw, home };
})();
// Charts on the page: featherbench.chart(element, series, shape, open) draws into an element, and again when its width changes. What series and shapes
// are stands in the file of `draw`. The names of series switch them on and off, a rectangle zooms, and `open` is called with a clicked point's target.
featherbench.chart = (() => {
  const { drawing, make, variable } = featherbench;
  const { svg, sample, text, measure } = featherbench.marks;
  const NAMES = 12.5;
  // Marks answer within this many pixels; a pointer that moves less than DRAG is a click; a rectangle thinner than THIN means its length alone.
  const NEAR = 24;
  const DRAG = 5;
  const THIN = 10;

  const charts = new WeakMap();

  function chart(element, series, shape, open) {
    const state = charts.get(element) ?? create(element);
    const numbered = series.map((one, k) => ({ ...one, points: one.points ?? [], k }));
    Object.assign(state, { series: numbered, shape, open });
    // A zoom outlives another theme, not other numbers.
    const key = JSON.stringify([shape.x.title, shape.y.title, drawing.home(numbered, shape, "x"), drawing.home(numbered, shape, "y")]);
    if (key !== state.key) state.zoom = null;
    state.key = key;
    list(state);
    render(state);
  }

  function create(element) {
    const state = { element, hidden: new Set(), zoom: null, spots: [], spot: null, start: null };
    state.svg = svg("svg", { role: "img", tabindex: 0 });
    state.over = svg("g", { class: "over", "pointer-events": "none" });
    state.tip = make("div", { className: "chart-tip", role: "status", hidden: true });
    state.names = make("div", { className: "chart-names", role: "group", ariaLabel: "Series" });
    state.back = make("button", { type: "button", className: "chart-back", hidden: true }, "Reset zoom");
    const kept = make("button", { type: "button", className: "chart-save" }, "Save as SVG");
    state.figure = make("div", { className: "chart-figure" }, state.svg, state.tip);
    element.replaceChildren(state.figure, make("div", { className: "chart-side" }, state.names, make("div", { className: "chart-tools" }, state.back, kept)));
    state.back.addEventListener("click", () => zoom(state, null));
    kept.addEventListener("click", () => save(state));
    listen(state);
    new ResizeObserver(() => { if (state.series && state.figure.clientWidth !== state.width) render(state); }).observe(state.figure);
    charts.set(element, state);
    return state;
  }

  function render(state) {
    const { element, figure, shape } = state;
    const [width, height] = [figure.clientWidth, figure.clientHeight];
    hide(state);
    // What is not on the page has no size; it is drawn when it gets one.
    if (width < 60 || height < 60) return;
    const series = state.series.filter((one) => !state.hidden.has(one.name));
    const { elements, spots, whole } = drawing.draw({ series, shape, zoom: state.zoom, width, height, clip: `${element.id}-clip` });
    Object.assign(state, { width, height, spots, whole });
    const about = `${element.getAttribute("aria-label") ?? "Chart"}: ${spots.length} points in ${new Set(spots.map((spot) => spot.series)).size} series`;
    const attributes = { viewBox: `0 0 ${width} ${height}`, "aria-label": about, "font-family": variable("--sans"), fill: variable("--ink") };
    for (const [name, value] of Object.entries(attributes)) state.svg.setAttribute(name, value);
    state.svg.replaceChildren(...elements, state.over);
    state.back.hidden = state.zoom === null;
  }

  // --- The names of the series.

  function list(state) {
    state.names.replaceChildren(...state.series.filter((one) => one.name).map((one) => entry(state, one)));
  }

  function entry(state, one) {
    const picture = svg("svg", { width: 28, height: 16, "aria-hidden": "true" }, sample(one, variable("--panel")));
    const button = make("button", { type: "button", title: "Click: on or off. Double click: alone." }, picture, make("span", {}, one.name), make("i", {}, one.note ?? ""));
    button.setAttribute("aria-pressed", String(!state.hidden.has(one.name)));
    button.addEventListener("click", () => {
      if (!state.hidden.delete(one.name)) state.hidden.add(one.name);
      press(state);
    });
    button.addEventListener("dblclick", () => {
      const others = state.series.map(({ name }) => name).filter((name) => name && name !== one.name);
      // A second double click brings all back.
      const alone = !state.hidden.has(one.name) && others.every((name) => state.hidden.has(name));
      state.hidden = new Set(alone ? [] : others);
      press(state);
    });
    for (const [kind, pale] of [["pointerenter", true], ["focus", true], ["pointerleave", false], ["blur", false]]) {
      button.addEventListener(kind, () => dim(state, pale ? one.k : null));
    }
    return button;
  }

  function press(state) {
    const named = state.series.filter((one) => one.name);
    [...state.names.children].forEach((button, index) => button.setAttribute("aria-pressed", String(!state.hidden.has(named[index].name))));
    render(state);
  }

  // All but one series become pale, as long as its name is pointed at.
  function dim(state, k) {
    const known = k !== null && state.svg.querySelector(`[data-k="${k}"]`) !== null;
    for (const part of state.svg.querySelectorAll("[data-k]")) part.style.opacity = known && part.dataset.k !== String(k) ? 0.12 : "";
  }

  // --- Pointing, clicking, walking.

  function listen(state) {
    const on = (kind, task) => state.svg.addEventListener(kind, task);
    on("pointerdown", (event) => {
      if (event.button !== 0) return;
      state.start = position(state, event);
      // A finger scrolls the page; a mouse that leaves the figure goes on drawing its rectangle.
      if (event.pointerType !== "touch") state.svg.setPointerCapture(event.pointerId);
    });
    const zooms = (event) => event.pointerType !== "touch" && state.whole && dragged(state, event);
    on("pointermove", (event) => (zooms(event) ? stretch(state, event) : point(state, event)));
    on("pointerup", (event) => {
      if (zooms(event)) zoom(state, corners(state, event));
      else if (state.start && !dragged(state, event)) choose(state, near(state, ...position(state, event)));
      state.start = null;
    });
    for (const kind of ["pointercancel", "pointerleave"]) on(kind, () => { state.start = null; hide(state); });
    on("blur", () => hide(state));
    on("dblclick", () => zoom(state, null));
    state.element.addEventListener("keydown", (event) => walk(state, event));
  }

  // Where an event is, in the units of the drawing.
  function position(state, event) {
    const box = state.svg.getBoundingClientRect();
    return [((event.clientX - box.left) * state.width) / box.width, ((event.clientY - box.top) * state.height) / box.height];
  }

  function dragged(state, event) {
    if (!state.start) return false;
    const [x, y] = position(state, event);
    return Math.hypot(x - state.start[0], y - state.start[1]) >= DRAG;
  }

  // The nearest mark; of those at one place the uppermost.
  function near(state, x, y) {
    let [found, least] = [null, NEAR];
    for (const spot of state.spots) {
      const distance = Math.hypot(spot.x - x, spot.y - y);
      if (distance <= least) [found, least] = [spot, distance];
    }
    return found;
  }

  function point(state, event) {
    const spot = near(state, ...position(state, event));
    if (spot !== state.spot) show(state, spot);
  }

  function choose(state, spot) {
    if (!spot?.point.target || !state.open) return;
    hide(state);
    state.open(spot.point.target);
  }

  function hide(state) {
    show(state, null);
  }

  // A ring about the mark, and beside it its lines and the name of its series.
  function show(state, spot) {
    state.spot = spot;
    state.over.replaceChildren();
    state.svg.style.cursor = spot?.point.target ? "pointer" : "";
    state.tip.hidden = !spot;
    if (!spot) return;
    const { series, x, y } = spot;
    state.over.append(svg("circle", { cx: x, cy: y, r: 4 + series.mark.size / 2, fill: "none", stroke: variable("--ink"), "stroke-width": 1.5 }));
    const picture = svg("svg", { width: 28, height: 16, "aria-hidden": "true" }, sample(series, variable("--panel")));
    const lines = (spot.point.tip ?? []).map((words, index) => make("div", {}, index === 0 ? make("b", {}, words) : words));
    state.tip.replaceChildren(...lines, make("div", { className: "chart-whose" }, picture, series.name));
    // Right of the mark and above it, on the other side where there is no room.
    const { offsetWidth: width, offsetHeight: height } = state.tip;
    state.tip.style.left = `${Math.max(0, x + 14 + width <= state.width ? x + 14 : x - 14 - width)}px`;
    state.tip.style.top = `${y - 10 - height >= 0 ? y - 10 - height : y + 14}px`;
  }

  // Arrows along a series, and to the nearest mark of the next one; Enter opens, Escape goes back to the whole.
  function walk(state, event) {
    if (event.key === "Escape" && state.zoom) {
      zoom(state, null);
    } else if (event.key === "Escape") {
      hide(state);
    } else if (event.target === state.svg && event.key === "Enter") {
      choose(state, state.spot);
    } else if (event.target === state.svg && event.key.startsWith("Arrow")) {
      event.preventDefault();
      const next = neighbour(state, event.key);
      if (next) show(state, next);
    }
  }

  function neighbour(state, key) {
    const { spot, spots } = state;
    if (!spot) return spots[0];
    const forward = key === "ArrowRight" || key === "ArrowDown" ? 1 : -1;
    if (key === "ArrowRight" || key === "ArrowLeft") {
      const own = spots.filter(({ series }) => series === spot.series).sort((a, b) => a.x - b.x);
      return own[own.indexOf(spot) + forward];
    }
    const series = [...new Set(spots.map((one) => one.series))];
    const other = series[series.indexOf(spot.series) + forward];
    return spots.filter((one) => one.series === other).sort((a, b) => Math.abs(a.x - spot.x) - Math.abs(b.x - spot.x))[0];
  }

  // --- Zoom.

  // The rectangle from where the drag began, inside the box; a thin one goes over all of the box in the other direction.
  function corners(state, event) {
    const { box } = state.whole;
    const [x, y] = position(state, event);
    const within = (value, least, most) => Math.min(Math.max(value, least), most);
    const between = (a, b, least, most) => (Math.abs(a - b) < THIN ? [least, most] : [a, b].map((value) => within(value, least, most)).sort((one, other) => one - other));
    const [left, right] = between(state.start[0], x, box.left, box.right);
    const [top, bottom] = between(state.start[1], y, box.top, box.bottom);
    return { left, right, top, bottom };
  }

  function stretch(state, event) {
    hide(state);
    const { left, right, top, bottom } = corners(state, event);
    state.over.append(svg("rect", { class: "zoom", x: left, y: top, width: right - left, height: bottom - top, fill: variable("--accent"), "fill-opacity": 0.12, stroke: variable("--accent") }));
  }

  // To a rectangle on the screen, or back to the whole.
  function zoom(state, rectangle) {
    if (rectangle) {
      const { x, y } = state.whole;
      const wanted = { x: [x.back(rectangle.left), x.back(rectangle.right)], y: [y.back(rectangle.bottom), y.back(rectangle.top)] };
      // Beyond a millionth of the range numbers and labels are rounding alone.
      const enough = (range) => range[1] - range[0] > 1e-6 * Math.max(1, Math.abs(range[0]));
      if (enough(wanted.x) && enough(wanted.y)) state.zoom = wanted;
    } else {
      state.zoom = null;
    }
    render(state);
  }

  // --- The figure as a file.

  // The drawing with its names on the right, on paper of the page's colour: it needs nothing of the page.
  function figure(state) {
    const series = state.series.filter((one) => one.name && !state.hidden.has(one.name));
    const widest = (texts) => Math.max(0, ...texts.map((words) => measure([words ?? ""], NAMES)));
    const notes = widest(series.map((one) => one.note));
    const side = 40 + widest(series.map((one) => one.name)) + (notes > 0 ? notes + 14 : 0);
    const edge = 16;
    const [width, height] = [state.width + side + 2 * edge, Math.max(state.height, 50 + 21 * series.length) + 2 * edge].map(Math.ceil);
    const copy = state.svg.cloneNode(true);
    copy.querySelector(".over").remove();
    for (const name of ["tabindex", "style"]) copy.removeAttribute(name);
    for (const [name, value] of Object.entries({ width, height, viewBox: `${-edge} ${-edge} ${width} ${height}` })) copy.setAttribute(name, value);
    copy.prepend(svg("title", {}, state.svg.getAttribute("aria-label")), svg("rect", { x: -edge, y: -edge, width, height, fill: variable("--panel") }));
    series.forEach((one, index) => {
      const row = svg("g", { transform: `translate(${state.width} ${34 + 21 * index})` }, sample(one, variable("--panel")));
      row.append(text([one.name], 34, 12, { "font-size": NAMES }));
      if (one.note) row.append(text([one.note], side, 12, { "font-size": NAMES, "font-style": "italic", "text-anchor": "end", fill: variable("--soft") }));
      copy.append(row);
    });
    return new XMLSerializer().serializeToString(copy);
  }

  function save(state) {
    const address = URL.createObjectURL(new Blob([figure(state)], { type: "image/svg+xml" }));
    make("a", { href: address, download: `featherbench-${state.element.id}.svg` }).click();
    setTimeout(() => URL.revokeObjectURL(address), 1000);
  }

  return Object.assign(chart, { figure: (element) => figure(charts.get(element)) });
})();
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
// Figures for papers: the button that copies a figure's data. Where the browser forbids the clipboard, the file with the data is beside it.
document.addEventListener("click", async (event) => {
  const button = event.target.closest("button.copy-data");
  if (!button) return;
  const words = "Copy data";
  try {
    const data = await featherbench.load("figure-data");
    await navigator.clipboard.writeText(data[button.dataset.figure]);
    button.textContent = "Copied";
  } catch {
    button.textContent = "Not allowed: save it instead";
  }
  setTimeout(() => { button.textContent = words; }, 1500);
});
// Robots that turn: the picture that the page has already, projected again. `featherbench.robot(figure)` does it for one figure.
(() => {
  const round = (value) => value.toFixed(1);

  // A direction in the picture's axes: right, down, towards the reader. The same as in crates/report/src/robot/project.rs.
  function turned([x, y, z], turn, tilt) {
    const right = Math.cos(turn) * x - Math.sin(turn) * y, back = Math.sin(turn) * x + Math.cos(turn) * y;
    return [right, -Math.cos(tilt) * z - Math.sin(tilt) * back, Math.sin(tilt) * z - Math.cos(tilt) * back];
  }

  function outline(axes, scale) {
    const sum = (i, j) => axes.reduce((total, axis) => total + axis[i] * axis[j], 0);
    const xx = sum(0, 0), xy = sum(0, 1), yy = sum(1, 1);
    const mean = (xx + yy) / 2, half = Math.hypot((xx - yy) / 2, xy);
    const root = (square) => Math.max(1.5, Math.sqrt(Math.max(0, square)) * scale);
    return [root(mean + half), root(mean - half), Math.atan2(2 * xy, xx - yy) * 90 / Math.PI];
  }

  function robot(figure) {
    const svg = figure.querySelector("svg");
    if (!svg || figure.dataset.turns) return;
    figure.dataset.turns = "yes";
    const { bodies, middle, scale, size, ...view } = JSON.parse(figure.dataset.robot);
    const place = (point) => {
      const [right, down, near] = turned(point.map((x, k) => x - middle[k]), view.turn, view.tilt);
      return [size[0] / 2 + scale * right, size[1] / 2 + scale * down, near];
    };
    const all = (name) => [...svg.querySelectorAll(name)];
    const set = (element, values) => Object.entries(values).forEach(([name, value]) => element.setAttribute(name, value));

    function draw() {
      const near = new Map();
      for (const element of all("ellipse")) {
        const [, , centre, axes] = bodies[element.dataset.body];
        const [x, y, depth] = place(centre);
        const [rx, ry, angle] = outline(axes.map((axis) => turned(axis, view.turn, view.tilt)), scale);
        set(element, { rx: round(rx), ry: round(ry), transform: `translate(${round(x)} ${round(y)}) rotate(${round(angle)})` });
        near.set(element, depth);
      }
      // The farthest first: nearer ones stand before it.
      svg.querySelector(".bodies").append(...[...near.keys()].sort((a, b) => near.get(a) - near.get(b)));
      for (const element of all("line")) {
        const [[x1, y1], [x2, y2]] = bodies[element.dataset.body].slice(0, 2).map(place);
        set(element, { x1: round(x1), y1: round(y1), x2: round(x2), y2: round(y2) });
      }
      for (const element of all("circle")) {
        const [cx, cy] = place(bodies[element.dataset.body][1]);
        set(element, { cx: round(cx), cy: round(cy) });
      }
      for (const element of all("text")) {
        const [x, y] = place(bodies[element.dataset.body][2]);
        set(element, { x: round(x + 6), y: round(y - 6) });
      }
    }

    function move(across, up) {
      view.turn += across;
      view.tilt = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, view.tilt + up));
      draw();
    }

    svg.addEventListener("pointerdown", (event) => svg.setPointerCapture(event.pointerId));
    svg.addEventListener("pointermove", (event) => { if (svg.hasPointerCapture(event.pointerId)) move(event.movementX * 0.01, event.movementY * 0.01); });
    const keys = { ArrowLeft: [-0.15, 0], ArrowRight: [0.15, 0], ArrowUp: [0, -0.15], ArrowDown: [0, 0.15] };
    svg.addEventListener("keydown", (event) => {
      if (!keys[event.key]) return;
      event.preventDefault();
      move(...keys[event.key]);
    });
  }

  featherbench.robot = robot;
  // A section with robots may be brought later than the page.
  featherbench.dressed((root) => root.querySelectorAll("figure.robot").forEach(robot));
})();
featherbench.section("agreement", () => {
// The heatmap: the worst of each engine, or the quantities of one.
featherbench.ready(() => {
  const { byId, bring } = featherbench;
  const list = byId("heat-engine");
  if (!list) return;

  async function show() {
    const chosen = byId(`of-${list.value}`);
    byId("heat-whole").hidden = chosen !== null;
    for (const box of document.querySelectorAll(".heat-of")) box.hidden = box !== chosen;
    const place = chosen?.querySelector("[data-part]");
    if (place) await bring(place);
  }

  list.addEventListener("change", show);
  // The heads of the columns open the quantities here; the engine's own page is one click further.
  byId("heat").tHead.addEventListener("click", (event) => {
    const head = event.target.closest("th.engine");
    const option = head && [...list.options].find(({ textContent }) => textContent === head.title);
    if (!option) return;
    event.preventDefault();
    list.value = option.value;
    show();
  });
});
});
featherbench.section("depth", () => {
// Error against depth.
featherbench.ready(() => {
  const { byId, chunks, short, variable } = featherbench;
  const { choices, dash, draw, ink, joined, layout, least, live, mark } = featherbench.plots;
  const overview = chunks.get("overview");
  const plots = chunks.get("figures")?.depth;
  if (!overview || !plots || !byId("depth-plot")) return;

  const HALF_ULP = 2 ** -53;

  function drawDepth() {
    const plot = plots[byId("depth-quantity").value];
    const family = byId("depth-family").value;
    const kind = byId("depth-case").value;
    const gates = new Map();
    const methods = new Map();
    const series = [];
    for (const trace of plot.traces) {
      const index = methods.get(trace.engine) ?? 0;
      methods.set(trace.engine, index + 1);
      // A robot's worst row.
      const worst = new Map();
      for (const [robot, pointCase, value, bound] of trace.points) {
        const about = overview.robots[robot];
        if ((family !== "" && about.family !== family) || (kind !== "" && pointCase !== kind)) continue;
        if (bound !== null) gates.set(about.depth, Math.min(bound, gates.get(about.depth) ?? Infinity));
        if (!worst.has(robot) || worst.get(robot).value < value) worst.set(robot, { robot, depth: about.depth, kind: pointCase, value, bound });
      }
      if (worst.size === 0) continue;
      const points = [...worst.values()].sort((a, b) => a.depth - b.depth || a.value - b.value);
      const name = joined(overview.engines[trace.engine], trace.method, trace.scalar === "f64" ? "" : trace.scalar);
      const envelope = new Map(points.map((point) => [point.depth, least(point.value)]));
      series.push({
        name, ink: ink(trace.engine), mark: { symbol: mark(trace.engine, index), size: 8, opacity: 0.9 }, line: { width: 1.2, dash: dash(index), opacity: 0.6, path: [...envelope] },
        points: points.map((point) => ({
          x: point.depth, y: least(point.value), hollow: point.value === 0,
          tip: [`${overview.robots[point.robot].name}, depth ${point.depth}`, short(point.value) + (point.bound === null ? "" : `, gate ${short(point.bound)}`), point.kind].filter(Boolean),
          target: {
            robot: point.robot,
            filters: { study: "agreement", engine: overview.engines[trace.engine], quantity: plot.quantity, metric: plot.metric, states: point.kind, method: trace.method },
          },
        })),
      });
    }
    if (gates.size > 0) {
      const depths = [...gates.keys()].sort((a, b) => a - b);
      series.push({
        name: "gate", ink: variable("--ink"), line: { width: 1.5, dash: "dash" }, mark: { symbol: "tick", size: depths.length > 1 ? 9 : 16 },
        points: depths.map((depth) => ({ x: depth, y: gates.get(depth), tip: [`gate ${short(gates.get(depth))}`, `the tightest at depth ${depth}`] })),
      });
    }
    series.push({ name: "2⁻⁵³", ink: variable("--soft"), guide: HALF_ULP, line: { width: 1.2, dash: "dot" } });
    draw("depth-plot", series, layout("depth: joints from the base to the farthest leaf", plot.title, true));
  }

  const used = plots.flatMap((plot) => plot.traces.flatMap((trace) => trace.points));
  choices(byId("depth-family"), new Set(used.map(([robot]) => overview.robots[robot].family)));
  choices(byId("depth-case"), new Set(used.map(([, kind]) => kind)));
  live(drawDepth, "depth-quantity", "depth-family", "depth-case");
});
});
featherbench.section("time", () => {
// Time against size.
featherbench.ready(() => {
  const { byId, chunks, short } = featherbench;
  const { colour, dash, draw, exponent, fitted, joined, layout, live, symbol } = featherbench.plots;
  const overview = chunks.get("overview");
  const times = chunks.get("figures")?.time;
  if (!overview || !times || !byId("time-plot")) return;

  function drawTime() {
    const joint = byId("time-unit").value === "joint";
    const kind = byId("time-case").value;
    const family = byId("time-family").value;
    const lines = times.filter((line) => line.cache === kind && (family === "" || line.family === family));
    const algorithms = [...new Set(times.map((line) => line.algorithm))];
    const families = [...new Set(lines.map((line) => line.family))];
    const engines = new Set(lines.map((line) => line.engine));
    const series = [];
    const styles = new Map();
    const per = (point, ns) => (joint && ns !== null ? ns / point.joints : ns);
    // The interval of the median where the run has it, its deciles otherwise.
    const end = (point, ...keys) => per(point, keys.map((key) => point[key]).find((ns) => ns !== null) ?? null);
    for (const line of lines) {
      // Lines of one colour are told apart by dashes and symbols, whether they differ in engine, method or family.
      const ink = colour(algorithms.indexOf(line.algorithm));
      const style = styles.get(ink) ?? 0;
      styles.set(ink, style + 1);
      const name = joined(engines.size > 1 ? overview.engines[line.engine] : "", line.algorithm, line.method === line.algorithm ? "" : line.method,
        families.length > 1 ? line.family : "", line.scalar === "f64" ? "" : line.scalar);
      const fit = joint ? line.per_joint : line.per_call;
      const ends = [line.points[0].size, line.points[line.points.length - 1].size];
      series.push({
        name, note: exponent(fit?.slope), ink, line: { width: 1.2, dash: dash(style) }, mark: { symbol: symbol(style), size: 8 },
        broad: fit && byId("time-fit").checked ? fitted(fit, ends) : [],
        points: line.points.map((point) => ({
          x: point.size, y: per(point, point.ns), low: end(point, "low", "p10"), high: end(point, "high", "p90"), symbol: point.estimated ? "cross" : undefined, hollow: !point.valid,
          tip: [`${overview.robots[point.robot].name}, nv ${point.size}`, `${short(point.ns)} ns per call`, `${short(point.ns / point.joints)} ns per joint`, point.estimated ? "estimate" : "", point.valid ? "" : "does not count"].filter(Boolean),
          target: { robot: point.robot, filters: { study: "timing", engine: overview.engines[line.engine], quantity: line.algorithm, cache: line.cache } },
        })),
      });
    }
    draw("time-plot", series, layout("degrees of freedom nv", joint ? "ns per joint" : "ns per call"));
  }

  live(drawTime, "time-unit", "time-case", "time-family", "time-fit");
});
});
