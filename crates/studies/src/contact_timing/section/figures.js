// Contact timing: solution times of the standing quadruped against its contacts.
featherbench.ready(() => {
  const { byId, chunks, short } = featherbench;
  const { colour, draw, layout, symbol } = featherbench.plots;
  const times = chunks.get("figures")?.contact_timing;
  if (!times || !byId("contact-times")) return;

  const of = (time) => `${time.engine} ${time.method}`;
  const quadrupeds = times.filter((time) => time.robot.startsWith("quadruped"));
  const solvers = [...new Set(quadrupeds.map(of))];
  const series = solvers.map((name, index) => ({
    name, ink: colour(index), line: { width: 1.4 }, mark: { size: 8, symbol: symbol(index) },
    points: quadrupeds.filter((time) => of(time) === name)
      .map((time) => ({ x: time.contacts, y: time.ns * 1e-3, tip: [name, `${time.contacts} contacts`, `${short(time.ns * 1e-3)} µs`] })),
  }));
  draw("contact-times", series, layout("contacts of the quadruped", "time of a solution, µs", true));
});
