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

  // Runs a task when the page and its data are complete; each on its own, so that one that fails leaves the others.
  const ready = (task) => { if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", task); else task(); };

  // Runs a task on the page, and on each piece that is brought later.
  const dressers = [];
  const dress = (root) => { for (const task of dressers) task(root); };
  const dressed = (task) => { dressers.push(task); ready(() => task(document)); };

  return { chunk, load, make, short, decades, glyphs, variable, byId, ready, dress, dressed, chunks };
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

// On a narrow screen the navigation is a menu, which closes when a section is chosen.
document.addEventListener("click", (event) => event.target.closest("nav a")?.closest(":popover-open")?.hidePopover());

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
  const { byId, chunks, dress, load, ready } = featherbench;
  const scripts = new Map();
  const NEAR = "300px";
  // The section that the reader went to, until the reader scrolls: what is brought above it must not push it away.
  let goal = "";

  const loaded = (name) => load(`part-${name}`, `sections/${name}.js`);

  // Puts a piece in its place, and returns what stands there now.
  function put(place, markup) {
    const box = document.createElement("template");
    box.innerHTML = markup;
    const pieces = [...box.content.children];
    const seen = goal ? null : [...document.querySelectorAll("main > section")].find((section) => section.getBoundingClientRect().bottom > 0);
    const before = seen?.getBoundingClientRect().top;
    place.replaceWith(box.content);
    if (goal) byId(goal)?.scrollIntoView({ behavior: "instant" });
    else if (seen?.isConnected) scrollBy({ top: seen.getBoundingClientRect().top - before, behavior: "instant" });
    for (const piece of pieces) dress(piece);
    return pieces[0];
  }

  async function bring(place) {
    const name = place.dataset.part;
    if (!name || place.ariaBusy === "true") return place;
    place.ariaBusy = "true";
    try {
      const markup = await loaded(name);
      // Meanwhile print may have brought it.
      return place.isConnected ? put(place, markup) : place;
    } catch (error) {
      // The link to the piece's page stays.
      place.ariaBusy = "false";
      place.append(featherbench.make("p", { className: "note" }, error.message));
      return place;
    }
  }

  // Runs the script of a section, once. One section that fails leaves the others.
  function run(section) {
    const script = scripts.get(section.id);
    scripts.delete(section.id);
    try {
      script?.();
    } catch (error) {
      reportError(error);
    }
  }

  async function show(section) {
    const there = await bring(section);
    if (!scripts.has(there.id)) return;
    try {
      await load("figures");
    } catch (error) {
      reportError(error);
      return;
    }
    run(there);
  }

  // Paper has every section. The browser waits for nothing before it prints, so their scripts are loaded when it has nothing else to do.
  function print() {
    if (!chunks.has("figures")) return;
    for (const section of document.querySelectorAll("main > section")) {
      const markup = chunks.get(`part-${section.dataset.part}`);
      if (markup !== undefined) run(put(section, markup));
      else if (!section.dataset.part) run(section);
    }
  }
  const idle = globalThis.requestIdleCallback ?? ((task) => setTimeout(task, 1000));
  addEventListener("beforeprint", print);
  addEventListener("load", () => idle(() => {
    const names = [...document.querySelectorAll("main > section[data-part]")].map((section) => section.dataset.part);
    // One that is missing is told where it is brought.
    if (names.length > 0) for (const piece of [load("figures"), ...names.map(loaded)]) piece.catch(() => {});
  }));

  // Every section and piece, for the browser's search.
  async function everything() {
    await Promise.all([...document.querySelectorAll("main > section")].map(show));
    // What is not chosen is not printed either.
    const wanted = [...document.querySelectorAll("[data-part]")].filter((place) => !place.closest("[data-choice][hidden]"));
    await Promise.all(wanted.map(bring));
  }

  // What the address names: an element, or a drawing with what is chosen.
  function named() {
    const text = decodeURIComponent(location.hash.slice(1));
    if (!text.startsWith("figure=")) return text.startsWith("rows=") ? "" : text;
    try { return String(JSON.parse(text.slice(7))[0]); } catch { return ""; }
  }

  // It may be in a section that is not here yet.
  async function follow() {
    const id = named();
    if (id === "") return;
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
// Drawings on the page are made by the report, and are whole without this script. It adds tips, arrow keys, rows behind marks, names that switch
// series on and off, a zoom, and copies. Lists choose which drawing is shown.
(() => {
  const { bring, byId, dressed, make, open } = featherbench;
  // Marks answer within this many pixels; a pointer that moves less than DRAG is a click; a rectangle thinner than THIN means its length alone.
  const [NEAR, DRAG, THIN] = [24, 5, 10];
  const numbers = (element, ...names) => names.map((name) => Number(element.getAttribute(name)));
  const shift = (element) => element.getAttribute("transform").match(/-?[\d.]+/g).map(Number);
  const move = (element, x, y) => element.setAttribute("transform", `translate(${x.toFixed(1)} ${y.toFixed(1)})`);
  const show = (element, shown) => { element.style.display = shown ? "" : "none"; };
  let count = 0;

  function enliven(drawing) {
    const svg = drawing.querySelector("svg");
    if (!svg) return;
    const all = (selector) => [...svg.querySelectorAll(selector)];
    const element = (tag, attributes) => {
      const made = document.createElementNS(svg.namespaceURI, tag);
      for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
      return made;
    };
    const [left, top, width, height] = numbers(svg.querySelector(".box"), "x", "y", "width", "height");
    const whole = [left, top, left + width, top + height];
    const names = all(".legend .entry");
    const series = all(".series");
    const named = names.map((name) => name.querySelector("text").textContent);
    // A title in the drawing would be a second tip beside ours.
    const spots = all(".series .mark").map((mark) => {
      const title = mark.querySelector("title");
      title.remove();
      const [x, y] = shift(mark);
      return { mark, x, y, home: [x, y], k: series.indexOf(mark.closest(".series")), tip: title.textContent.split("\n") };
    });
    const ticks = all(".xticks .tick, .yticks .tick").map((tick) => ({ tick, home: shift(tick), across: tick.parentElement.matches(".xticks") }));
    // Ticks between the others say their numbers where a zoom has made room.
    for (const { tick, across } of ticks) {
      if (!tick.dataset.label) continue;
      const label = element("text", { class: "between", display: "none", ...(across ? { y: 20 } : { x: -9, y: 4 }) });
      label.textContent = tick.dataset.label;
      tick.append(label);
    }
    const off = new Set(names.flatMap((name, k) => ("off" in name.dataset ? [k] : [])));
    let [view, spot, start] = [whole, null, null];

    const back = make("button", { type: "button", className: "chart-back", hidden: true }, "Reset zoom");
    const every = make("button", { type: "button", className: "chart-every" }, `All ${names.length} series`);
    const kept = make("button", { type: "button", className: "chart-save" }, "Save as SVG");
    const copied = make("button", { type: "button", className: "chart-copy" }, "Copy data");
    const tip = make("div", { className: "chart-tip", role: "status", hidden: true });
    const over = element("g", { class: "over", "pointer-events": "none" });
    const link = make("a", { className: "chart-link", href: address(drawing) }, "Link");
    link.addEventListener("pointerdown", () => { link.href = address(drawing); });
    link.addEventListener("focus", () => { link.href = address(drawing); });
    drawing.append(tip, make("p", { className: "chart-tools" }, back, every, kept, copied, link));
    svg.append(over);
    svg.setAttribute("role", "group");
    svg.setAttribute("tabindex", "0");

    // A section may show some marks only.
    const only = (one) => drawing.closest("[data-lists]")?.only?.(one.mark.dataset) ?? true;
    const visible = (one) => !off.has(one.k) && only(one) && one.x >= whole[0] - 0.5 && one.x <= whole[2] + 0.5 && one.y >= whole[1] - 0.5 && one.y <= whole[3] + 0.5;
    const shown = () => spots.filter(visible);

    // Puts everything where the view has it.
    function place() {
      const [a, d] = [width / (view[2] - view[0]), height / (view[3] - view[1])];
      const [x, y] = [(value) => left + a * (value - view[0]), (value) => top + d * (value - view[1])];
      for (const one of spots) {
        [one.x, one.y] = [x(one.home[0]), y(one.home[1])];
        move(one.mark, one.x, one.y);
        show(one.mark, visible(one));
      }
      series.forEach((group, k) => show(group, !off.has(k)));
      for (const lines of all(".lines")) lines.setAttribute("transform", `matrix(${a} 0 0 ${d} ${left - a * view[0]} ${top - d * view[1]})`);
      for (const band of all(".band")) band.setAttribute("transform", `matrix(1 0 0 ${d} 0 ${top - d * view[1]})`);
      for (const { tick, home, across } of ticks) {
        const [u, v] = across ? [x(home[0]), home[1]] : [home[0], y(home[1])];
        move(tick, u, v);
        show(tick, across ? u >= whole[0] - 0.5 && u <= whole[2] + 0.5 : v >= whole[1] - 0.5 && v <= whole[3] + 0.5);
      }
      const roomy = Math.min(a, d) > 3;
      for (const label of all(".between")) label.setAttribute("display", roomy ? "inline" : "none");
      back.hidden = view === whole;
      const there = shown();
      svg.setAttribute("aria-label", `${svg.querySelector(":scope > title").textContent}: ${there.length} points in ${new Set(there.map(({ k }) => k)).size} series`);
      point(null);
    }

    // Lines and bands end at the box.
    const clip = element("clipPath", { id: `clip-${count += 1}` });
    clip.append(element("rect", { x: left, y: top, width, height }));
    svg.prepend(clip);
    for (const cut of all(".lines, .band")) {
      const box = element("g", { "clip-path": `url(#${clip.id})` });
      cut.replaceWith(box);
      box.append(cut);
      for (const path of cut.querySelectorAll("path")) path.setAttribute("vector-effect", "non-scaling-stroke");
    }

    // --- Pointing, and walking with the arrow keys.

    function point(next) {
      spot = next;
      over.replaceChildren();
      tip.hidden = !spot;
      svg.style.cursor = spot?.mark.dataset.rows ? "pointer" : "";
      if (!spot) return;
      over.append(element("circle", { cx: spot.x, cy: spot.y, r: 8, fill: "none", stroke: "#17212b", "stroke-width": 1.5 }));
      tip.replaceChildren(...spot.tip.map((line, index) => make("div", {}, index === 0 ? make("b", {}, line) : line)), make("div", {}, named[spot.k]));
      // Right of the mark and above it, on the other side where there is no room.
      const [frame, paper] = [drawing.getBoundingClientRect(), svg.getBoundingClientRect()];
      const scale = paper.width / svg.viewBox.baseVal.width;
      const [x, y] = [paper.left - frame.left + spot.x * scale, paper.top - frame.top + spot.y * scale];
      tip.style.left = `${Math.max(0, x + 14 + tip.offsetWidth <= frame.width ? x + 14 : x - 14 - tip.offsetWidth)}px`;
      tip.style.top = `${y - 10 - tip.offsetHeight >= 0 ? y - 10 - tip.offsetHeight : y + 14}px`;
    }

    function position(event) {
      const box = svg.getBoundingClientRect();
      const scale = svg.viewBox.baseVal.width / box.width;
      return [(event.clientX - box.left) * scale, (event.clientY - box.top) * scale];
    }

    // The nearest mark; of those at one place the uppermost.
    function near([x, y]) {
      let [found, least] = [null, NEAR];
      for (const one of shown()) {
        const distance = Math.hypot(one.x - x, one.y - y);
        if (distance <= least) [found, least] = [one, distance];
      }
      return found;
    }

    function choose(one) {
      const { rows, title, filter } = one?.mark.dataset ?? {};
      if (!rows) return;
      point(null);
      const filters = [series[one.k].dataset.filter, filter].filter(Boolean).join("\n").split("\n").filter(Boolean);
      open(rows, Object.fromEntries(filters.map((line) => [line.slice(0, line.indexOf("=")), line.slice(line.indexOf("=") + 1)])), title ?? one.tip[0]);
    }

    function neighbour(key) {
      if (!spot) return shown()[0];
      const forward = key === "ArrowRight" || key === "ArrowDown" ? 1 : -1;
      const of = (k) => shown().filter((one) => one.k === k);
      if (key === "ArrowRight" || key === "ArrowLeft") {
        const own = of(spot.k).sort((a, b) => a.x - b.x);
        return own[own.indexOf(spot) + forward];
      }
      const ks = [...new Set(shown().map(({ k }) => k))];
      return of(ks[ks.indexOf(spot.k) + forward]).sort((a, b) => Math.abs(a.x - spot.x) - Math.abs(b.x - spot.x))[0];
    }

    // --- Zoom: to a rectangle, or back to the whole.

    function corners([x, y]) {
      const within = (value, k) => Math.min(Math.max(value, whole[k]), whole[k + 2]);
      const pair = (a, b, k) => (Math.abs(a - b) < THIN ? [whole[k], whole[k + 2]] : [within(a, k), within(b, k)].sort((one, other) => one - other));
      const [[x0, x1], [y0, y1]] = [pair(start[0], x, 0), pair(start[1], y, 1)];
      return [x0, y0, x1, y1];
    }

    function zoom(box) {
      const at = (value, k) => view[k] + ((value - whole[k]) * (view[k + 2] - view[k])) / (whole[k + 2] - whole[k]);
      const next = box && [at(box[0], 0), at(box[1], 1), at(box[2], 0), at(box[3], 1)];
      // Coordinates have one decimal: below this the zoom shows rounding alone.
      if (next && (next[2] - next[0] < 1 || next[3] - next[1] < 1)) return;
      view = next ?? whole;
      place();
    }

    const dragged = (event) => start && Math.hypot(...position(event).map((value, k) => value - start[k])) >= DRAG;
    // A finger scrolls the page; a mouse that leaves the drawing goes on with its rectangle.
    const zooms = (event) => event.pointerType !== "touch" && dragged(event);
    const on = (kind, task) => svg.addEventListener(kind, task);
    on("pointerdown", (event) => {
      if (event.button !== 0 || event.target.closest(".entry")) return;
      start = position(event);
      if (event.pointerType !== "touch") svg.setPointerCapture(event.pointerId);
    });
    on("pointermove", (event) => {
      if (!zooms(event)) { const next = near(position(event)); if (next !== spot) point(next); return; }
      point(null);
      const [x0, y0, x1, y1] = corners(position(event));
      over.append(element("rect", { x: x0, y: y0, width: x1 - x0, height: y1 - y0, fill: "#0072b2", "fill-opacity": 0.12, stroke: "#0072b2" }));
    });
    on("pointerup", (event) => {
      if (zooms(event)) zoom(corners(position(event)));
      else if (start) choose(near(position(event)));
      start = null;
    });
    for (const kind of ["pointercancel", "pointerleave"]) on(kind, () => { start = null; point(null); });
    on("blur", () => point(null));
    on("dblclick", (event) => { if (!event.target.closest(".entry")) zoom(null); });
    back.addEventListener("click", () => zoom(null));
    drawing.addEventListener("keydown", (event) => {
      if (event.key === "Escape") (view === whole ? point : zoom)(null);
      if (event.target !== svg) return;
      if (event.key === "Enter") choose(spot);
      if (!event.key.startsWith("Arrow")) return;
      event.preventDefault();
      const next = neighbour(event.key);
      if (next) point(next);
    });

    // --- Names: a click switches a series, a double click leaves it alone.

    function press() {
      names.forEach((name, k) => name.setAttribute("aria-pressed", String(!off.has(k))));
      every.hidden = off.size === 0;
      place();
    }
    names.forEach((name, k) => {
      const toggle = () => { if (!off.delete(k)) off.add(k); press(); };
      for (const [key, value] of Object.entries({ role: "button", tabindex: 0, "aria-label": named[k] })) name.setAttribute(key, value);
      name.addEventListener("click", toggle);
      name.addEventListener("keydown", (event) => { if (event.key === "Enter" || event.key === " ") { event.preventDefault(); toggle(); } });
      name.addEventListener("dblclick", () => {
        const alone = names.every((_, other) => (other === k) !== off.has(other));
        off.clear();
        if (!alone) names.forEach((_, other) => { if (other !== k) off.add(other); });
        press();
      });
    });

    every.addEventListener("click", () => { off.clear(); press(); });

    // --- Copies.

    kept.addEventListener("click", () => {
      const address = URL.createObjectURL(new Blob([saved()], { type: "image/svg+xml" }));
      make("a", { href: address, download: `featherbench-${drawing.dataset.name}.svg` }).click();
      setTimeout(() => URL.revokeObjectURL(address), 1000);
    });
    // The drawing as it is seen, without what only the page needs.
    function saved() {
      const copy = svg.cloneNode(true);
      copy.querySelector(".over").remove();
      for (const name of ["tabindex", "style", "aria-label"]) copy.removeAttribute(name);
      for (const name of copy.querySelectorAll('.entry[aria-pressed="false"]')) name.remove();
      for (const part of copy.querySelectorAll("*")) {
        for (const { name } of [...part.attributes]) if (/^(data-|aria-|tabindex|role$)/.test(name)) part.removeAttribute(name);
        if (part.style.display === "none") part.remove();
      }
      copy.setAttribute("role", "img");
      return new XMLSerializer().serializeToString(copy);
    }
    copied.addEventListener("click", async () => {
      const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
      const titles = [".xtitle", ".ytitle"].map((selector) => svg.querySelector(selector).textContent);
      const lines = [["series", "name", ...titles], ...shown().map((one) => [named[one.k], one.tip[0], ...one.mark.dataset.value.split(" ")])];
      try {
        await navigator.clipboard.writeText(lines.map((line) => line.map(quoted).join(",")).join("\n") + "\n");
        copied.textContent = "Copied";
      } catch {
        copied.textContent = "Not allowed";
      }
      setTimeout(() => { copied.textContent = "Copy data"; }, 1500);
    });

    Object.assign(drawing, { saved, place });
    press();
  }

  // --- Lists: of what has `data-choice` the choice is seen. Values that lead to nothing cannot be chosen.

  const lines = (element) => element.dataset.choice.split("\n");

  function choose(root) {
    const lists = root.dataset.lists.split(" ").map(byId);
    const all = [...root.querySelectorAll("[data-choice]")];
    const known = all.flatMap(lines).map((line) => line.split("\t"));
    lists.forEach((list, k) => {
      const before = lists.slice(0, k).map(({ value }) => value);
      const there = new Set(known.filter((line) => before.every((value, i) => line[i] === value)).map((line) => line[k]));
      for (const option of list.options) option.hidden = option.disabled = !there.has(option.value);
      if (!there.has(list.value)) list.value = [...list.options].find((option) => !option.disabled)?.value ?? "";
    });
    const chosen = lists.map(({ value }) => value).join("\t");
    for (const element of all) element.hidden = !lines(element).includes(chosen);
    for (const place of root.querySelectorAll("[data-choice]:not([hidden]) > [data-part]")) bring(place);
  }

  // The address of a drawing: its lists, and what is chosen in them.
  function address(drawing) {
    const chosen = drawing.closest("[data-lists]");
    if (!chosen) return `#${drawing.closest("[id]")?.id ?? ""}`;
    const values = chosen.dataset.lists.split(" ").map((id) => byId(id)?.value ?? "");
    return `#figure=${encodeURIComponent(JSON.stringify([chosen.id, ...values]))}`;
  }

  // The drawing that the page's address names, until it is there.
  let asked = null;

  function read() {
    if (!location.hash.startsWith("#figure=")) return;
    try { asked = JSON.parse(decodeURIComponent(location.hash.slice(8))); } catch { asked = null; }
    if (Array.isArray(asked) && byId(asked[0])) seek(byId(asked[0]));
  }

  function seek(chosen) {
    const [id, ...values] = Array.isArray(asked) ? asked : [];
    if (!chosen || id !== chosen.id || !chosen.dataset.lists) return;
    asked = null;
    chosen.dataset.lists.split(" ").forEach((list, k) => { if (byId(list) && values[k] !== undefined) byId(list).value = values[k]; });
    choose(chosen);
    chosen.scrollIntoView();
  }

  addEventListener("hashchange", read);
  read();

  // A finding leads to the drawing that shows it. Its choice is made when the list is there.
  const wanted = new Map();

  function take(list) {
    if (!list || !wanted.has(list.id)) return;
    list.value = wanted.get(list.id);
    wanted.delete(list.id);
    list.dispatchEvent(new Event("change", { bubbles: true }));
  }

  document.addEventListener("click", (event) => {
    const { list, value } = event.target.closest?.("a.figure[data-list]")?.dataset ?? {};
    if (!list) return;
    wanted.set(list, value);
    take(byId(list));
  });

  dressed((root) => {
    const find = (selector) => [...root.querySelectorAll(selector), ...(root.matches?.(selector) ? [root] : [])];
    for (const chosen of find("[data-lists]")) {
      for (const id of chosen.dataset.lists.split(" ")) byId(id).addEventListener("change", () => choose(chosen));
      choose(chosen);
      for (const id of chosen.dataset.lists.split(" ")) take(byId(id));
      seek(chosen);
    }
    const around = root.parentElement?.closest("[data-lists]");
    if (around) choose(around);
    for (const drawing of find(".drawing")) enliven(drawing);
  });
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

  // A direction in the picture's axes: right, down, towards the reader. The same as in crates/harness/report/src/robot/project.rs.
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
  featherbench.dressed((root) => [...root.querySelectorAll("figure.robot"), ...(root.matches?.("figure.robot") ? [root] : [])].forEach(robot));
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
// Error against depth: the marks of one family.
featherbench.ready(() => {
  const { byId, chunks } = featherbench;
  const [root, list] = [byId("depth-choices"), byId("depth-family")];
  const robots = chunks.get("overview")?.robots;
  if (!root || !list || !robots) return;
  // Marks without rows are gates.
  root.only = ({ rows }) => list.value === "" || !rows || robots[rows.replace("robot-", "")].family === list.value;
  list.addEventListener("change", () => { for (const drawing of root.querySelectorAll(".drawing")) drawing.place?.(); });
});
});
