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
