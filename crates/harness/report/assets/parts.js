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
