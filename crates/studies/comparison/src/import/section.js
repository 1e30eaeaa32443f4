// How engines read a robot's file: the differences of one robot in one engine, below the matrix.
featherbench.ready(() => {
  const { byId, load, make, short } = featherbench;
  const place = byId("import-details");
  if (!place) return;
  const HEADS = ["body", "field", "the reference reads", "it reads", "cause", "inverse dynamics", "M"];

  const spaced = (text) => (text ?? "").replaceAll("_", " ");

  // Rows of a chunk as objects.
  function objects(table) {
    return table.rows.map((row) => Object.fromEntries(table.columns.map((column, index) => [column, row[index]])));
  }

  function head() {
    return make("thead", {}, make("tr", {}, ...HEADS.map((text, index) => make("th", { scope: "col", className: index > 4 ? "number" : "" }, text))));
  }

  function line(row) {
    const params = JSON.parse(row.params);
    const cause = make("td", {}, params.cause === "number" ? "" : spaced(params.cause));
    if (params.note) cause.append(make("small", {}, params.note));
    const effect = (value) => make("td", { className: "number" }, params.weight === "dynamics" ? short(value) : "");
    return make("tr", { className: params.weight },
      make("th", { scope: "row" }, row.body || "the robot"), make("td", {}, spaced(row.quantity)), make("td", {}, params.ours), make("td", {}, params.theirs),
      cause, effect(params.id), effect(params.mass_matrix));
  }

  // What is left when the differences are taken into account.
  function verdict(rows) {
    const row = rows.find(({ metric }) => metric === "unexplained");
    if (!row) return "";
    if (row.value === 0) return "Our kernels on what it read give its answers: the differences are all there are.";
    const trees = JSON.parse(row.params).unexplained ?? [];
    return `Unexplained: ${trees.map((tree) => `${spaced(tree.quantity)} off by ${short(Number(tree.error))} in the sub-tree ${tree.bodies.join(", ")}`).join("; ") || row.reason}.`;
  }

  async function show(button) {
    const engine = button.dataset.engine;
    const table = await load(button.dataset.import);
    const rows = objects(table).filter((row) => row.study === "import" && row.engine === engine);
    const read = rows.find(({ metric, quantity }) => metric === "differences" && quantity === "import");
    if (!read) return;
    const worst = (row) => { const params = JSON.parse(row.params); return Math.max(params.mass_matrix ?? 0, params.id ?? 0); };
    const found = rows.filter(({ metric }) => metric === "difference").sort((a, b) => worst(b) - worst(a));
    place.replaceChildren(make("h3", {}, `${read.robot} as ${engine} reads it`));
    if (read.value === null) place.append(make("p", {}, `Not read: ${read.reason}`));
    if (found.length > 0) {
      const frame = make("div", { className: "scroll tall" });
      frame.append(make("table", { className: "compact" }, head(), make("tbody", {}, ...found.map(line))));
      place.append(frame);
    } else if (read.value !== null) {
      place.append(make("p", {}, "Like the reference in every body and field."));
    }
    const all = make("button", { type: "button", className: "open" }, "all rows");
    all.addEventListener("click", () => featherbench.open(button.dataset.import, { study: "import", engine }, `${read.robot} as ${engine} reads it`));
    place.append(make("p", {}, `${verdict(rows)} `, all));
    place.focus({ preventScroll: true });
    place.scrollIntoView({ block: "nearest" });
  }

  for (const button of document.querySelectorAll("button[data-import]")) button.addEventListener("click", () => show(button));
});
