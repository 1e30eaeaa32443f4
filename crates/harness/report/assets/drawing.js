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
