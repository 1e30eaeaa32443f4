// Conditioning.
featherbench.ready(() => {
  const { byId, chunks, short, variable } = featherbench;
  const { colour, dash, draw, exponent, joined, layout, live, symbol } = featherbench.plots;
  const overview = chunks.get("overview");
  const figures = chunks.get("figures")?.conditioning;
  if (!overview || !figures) return;
  const { families, bases } = figures;

  const HALF_ULP = 2 ** -53;

  // κ on the left, what it would excuse and what is unavoidable on the right.

  function line(family, index, key, label, fit, style, scale) {
    const points = family.points.filter((point) => point[key] !== null);
    return {
      name: joined(label, families.length > 1 ? family.name : ""), note: exponent(fit?.slope), ink: key === "floor" ? variable("--ink") : colour(style),
      line: { width: 1.4, dash: dash(index) }, mark: { size: 8, symbol: symbol(style) },
      points: points.map((point) => ({
        x: point.size, y: scale * point[key], tip: [overview.robots[point.robot].name, short(scale * point[key])], target: { robot: point.robot, filters: { study: "conditioning" } },
      })),
    };
  }

  function drawConditions() {
    const [left, right] = [[], []];
    families.forEach((family, index) => {
      left.push(line(family, index, "raw", "κ(M)", family.raw, 0, 1), line(family, index, "scaled", "κ scaled", family.scaled, 1, 1));
      right.push(line(family, index, "raw", "κ(M)·2⁻⁵³", null, 0, HALF_ULP), line(family, index, "scaled", "κ scaled·2⁻⁵³", null, 1, HALF_ULP), line(family, index, "floor", "conditioning bound", null, 2, 1));
    });
    for (const [id, series, title] of [["conditioning-plot", left, "condition number"], ["floor-plot", right, "relative error"]]) {
      const shape = layout("degrees of freedom n", title);
      const places = new Set(families.flatMap((family) => family.points.map((point) => point.size)));
      shape.x.ticks = [...places].sort((a, b) => a - b).map((size) => [size, String(size)]);
      draw(id, series, shape);
    }
  }

  // A mark for each matrix of each robot: κ before and after scaling to a unit diagonal.

  function drawBases() {
    const series = ["κ(M)", "κ(S_bb)", "κ(S_jj)"].map((name, place) => ({
      name, ink: colour(place), mark: { size: 9, symbol: symbol(place) },
      points: bases.filter((base) => base.kappa[2 * place] !== null).map((base) => {
        const [raw, scaled] = base.kappa.slice(2 * place);
        const robot = overview.robots[base.robot].name;
        return { x: raw, y: scaled, tip: [`${robot}, ${name}`, `${short(raw)}, scaled ${short(scaled)}`], target: { robot: base.robot, filters: { study: "conditioning" } } };
      }),
    }));
    draw("floating-base-plot", series, layout("condition number κ", "κ after scaling"));
  }

  if (byId("conditioning-plot")) live(drawConditions);
  if (byId("floating-base-plot")) live(drawBases);
});
