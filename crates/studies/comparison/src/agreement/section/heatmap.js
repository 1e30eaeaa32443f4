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
