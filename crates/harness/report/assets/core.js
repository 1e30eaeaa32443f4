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
