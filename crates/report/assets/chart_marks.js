// What charts are drawn with: elements of SVG, symbols, dashes, texts and their widths.
featherbench.marks = (() => {
  const { make, variable } = featherbench;
  // Read from an element, so that no script of a report holds an address.
  const SPACE = make("template", { innerHTML: "<svg></svg>" }).content.firstChild.namespaceURI;

  // An element of SVG with attributes and children; null leaves an attribute out.
  function svg(tag, attributes = {}, ...children) {
    const element = document.createElementNS(SPACE, tag);
    for (const [name, value] of Object.entries(attributes)) if (value !== null && value !== undefined) element.setAttribute(name, value);
    element.append(...children);
    return element;
  }

  // A tenth of a pixel is enough, and keeps saved figures small.
  const round = (value) => Math.round(value * 10) / 10;

  // Corners about the origin: two radii in turn make a star, one a polygon.
  function corners(count, ...radii) {
    return Array.from({ length: count * radii.length }, (_, index) => {
      const angle = (2 * Math.PI * index) / (count * radii.length) - Math.PI / 2;
      const radius = radii[index % radii.length];
      return [radius * Math.cos(angle), radius * Math.sin(angle)];
    });
  }
  const turned = (points) => points.map(([x, y]) => [(x - y) * Math.SQRT1_2, (x + y) * Math.SQRT1_2]);
  const PLUS = [[-0.4, -1.15], [0.4, -1.15], [0.4, -0.4], [1.15, -0.4], [1.15, 0.4], [0.4, 0.4], [0.4, 1.15], [-0.4, 1.15], [-0.4, 0.4], [-1.15, 0.4], [-1.15, -0.4], [-0.4, -0.4]];
  // Radii differ so that all symbols look equally large.
  const SHAPES = {
    square: turned(corners(4, 1.25)), diamond: corners(4, 1.3), triangle: corners(3, 1.35), plus: PLUS, star: corners(5, 1.45, 0.62),
    pentagon: corners(5, 1.15), hexagram: corners(6, 1.35, 0.78), cross: turned(PLUS),
  };

  function outline(symbol, size) {
    const radius = size / 2;
    if (symbol === "circle") return `M${-radius} 0a${radius} ${radius} 0 1 0 ${size} 0a${radius} ${radius} 0 1 0 ${-size} 0z`;
    if (symbol === "tick") return `M${-radius} 0h${size}`;
    const points = SHAPES[symbol] ?? SHAPES.square;
    return `M${points.map(([x, y]) => `${Math.round(100 * x * radius) / 100} ${Math.round(100 * y * radius) / 100}`).join("L")}z`;
  }

  // A mark at a place. Filled ones have a thin edge of the paper's colour, so that marks on one another can be told apart.
  function mark({ symbol, hollow, size, ink, paper }, x, y) {
    const line = hollow || symbol === "tick";
    return svg("path", {
      d: outline(symbol, size), transform: `translate(${round(x)} ${round(y)})`, fill: hollow ? paper : ink,
      stroke: line ? ink : paper, "stroke-width": line ? 1.4 : 0.7, "stroke-linejoin": "round",
    });
  }

  // Dashes in units of the line's width.
  const DASHES = { solid: null, dash: [6, 4], dot: [1.5, 3], dashdot: [6, 3, 1.5, 3], longdash: [11, 4], longdashdot: [11, 3, 1.5, 3] };
  const dashes = (name, width) => DASHES[name]?.map((part) => part * Math.max(1, width)).join(" ");

  // A line through points on the screen; a step goes across first, then up or down.
  function line(points, style, ink) {
    const [first, ...rest] = points.map(([x, y]) => [round(x), round(y)]);
    const way = rest.map(([x, y]) => (style.step ? `H${x}V${y}` : `L${x} ${y}`)).join("");
    const width = style.width ?? 1.4;
    return svg("path", {
      d: `M${first.join(" ")}${way}`, fill: "none", stroke: ink, "stroke-width": width, "stroke-dasharray": dashes(style.dash, width),
      "stroke-linejoin": "round", opacity: style.opacity,
    });
  }

  // The bar from one place to another with an end across each: along x where `flat`.
  function bar(flat, across, from, to, ink) {
    const [a, b, at] = [from, to, across].map(round);
    const end = 2.5;
    const path = flat ? `M${a} ${at}H${b}M${a} ${at - end}v${2 * end}M${b} ${at - end}v${2 * end}` : `M${at} ${a}V${b}M${at - end} ${a}h${2 * end}M${at - end} ${b}h${2 * end}`;
    return svg("path", { class: "bar", d: path, fill: "none", stroke: ink, "stroke-width": 1.2 });
  }

  // A text, with an exponent above the line where there is one.
  function text([words, exponent], x, y, attributes) {
    const element = svg("text", { x: round(x), y: round(y), ...attributes }, words);
    if (exponent !== undefined) element.append(svg("tspan", { dy: "-0.42em", "font-size": "0.76em" }, exponent));
    return element;
  }

  const context = document.createElement("canvas").getContext("2d");

  // The width of a text as the function above draws it.
  function measure([words, exponent], size) {
    context.font = `${size}px ${variable("--sans")}`;
    const width = context.measureText(words).width;
    return exponent === undefined ? width : width + 0.76 * context.measureText(exponent).width;
  }

  // The longest beginning of a text that has room.
  function shorten(words, size, room) {
    if (measure([words], size) <= room) return words;
    let count = words.length - 1;
    while (count > 0 && measure([`${words.slice(0, count)}…`], size) > room) count -= 1;
    return `${words.slice(0, count)}…`;
  }

  // The sample of a series that stands beside its name.
  function sample(series, paper, x = 14, y = 8) {
    const group = svg("g");
    const style = series.line;
    if (style) group.append(line([[x - 13, y], [x + 13, y]], { ...style, step: false, width: Math.min(style.width ?? 1.4, 5) }, series.ink));
    // On a dashed line a level stroke would close the gaps.
    if (series.mark && !(style && series.mark.symbol === "tick")) {
      // As the points are where all are alike.
      const [first] = series.points;
      const alike = (key) => first !== undefined && series.points.every((point) => point[key] === first[key]);
      const symbol = (alike("symbol") && first.symbol) || series.mark.symbol;
      group.append(mark({ symbol, hollow: alike("hollow") && first.hollow, size: Math.min(series.mark.size, 9), ink: series.ink, paper }, x, y));
    }
    return group;
  }

  return { svg, round, mark, line, bar, text, measure, shorten, sample };
})();
