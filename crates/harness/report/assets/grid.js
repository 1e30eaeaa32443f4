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
