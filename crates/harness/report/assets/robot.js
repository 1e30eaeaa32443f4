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
