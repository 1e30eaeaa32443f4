// What all plots share: colours, marks, axes, and the click on a mark that opens its rows.
featherbench.plots = (() => {
  const { byId, chunks, variable, make } = featherbench;
  const SYMBOLS = ["circle", "square", "diamond", "triangle-up", "cross", "star", "pentagon", "hexagram"];
  const DASHES = ["solid", "dash", "dot", "dashdot", "longdash", "longdashdot"];
  const COLOURS = 8;
  // Logarithms have no place for zero: what is smaller stands here, hollow.
  const ZERO = 1e-18;
  const colour = (index) => variable(`--series-${index % COLOURS}`);
  const symbol = (index) => SYMBOLS[index % SYMBOLS.length];
  const dash = (index) => DASHES[index % DASHES.length];
  // The plotting script reads a little markup in its texts: names are data and must stay text.
  const plain = (text) => String(text).replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");
  const joined = (...parts) => plain(parts.filter(Boolean).join(" · "));

  // Narrow windows have their legend below the plot.
  const narrow = matchMedia("(max-width: 760px)");

  function layout(x, y) {
    const axis = (title) => ({
      title: { text: title, standoff: 12 }, type: "log", exponentformat: "power", gridcolor: variable("--line"), zeroline: false,
      linecolor: variable("--soft"), ticks: "outside", tickcolor: variable("--soft"), minor: { ticks: "outside", ticklen: 2, tickcolor: variable("--line") },
    });
    return {
      paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
      font: { family: variable("--sans"), size: 13, color: variable("--ink") },
      margin: { l: 76, r: 16, t: 34, b: 56 },
      modebar: { bgcolor: "rgba(0,0,0,0)", color: variable("--soft"), activecolor: variable("--accent") },
      hovermode: "closest", hoverlabel: { bgcolor: variable("--panel"), bordercolor: variable("--line"), font: { color: variable("--ink") }, align: "left" },
      legend: narrow.matches ? { orientation: "h", y: -0.22 } : { x: 1.01, y: 1 },
      xaxis: axis(x), yaxis: axis(y),
    };
  }

  function draw(id, traces, shape) {
    const element = byId(id);
    if (typeof Plotly === "undefined") {
      element.replaceChildren(make("p", { className: "empty" }, "plotly.min.js is missing: the plot cannot be drawn."));
      return;
    }
    const config = { responsive: true, displaylogo: false, modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"] };
    Plotly.react(element, traces, shape, config);
    if (!element.dataset.live) {
      element.dataset.live = "yes";
      element.on("plotly_click", (event) => {
        const target = event.points[0]?.customdata;
        if (target) featherbench.open(`model-${target.model}`, target.filters, chunks.get("overview").models[target.model].name);
      });
    }
  }

  // Bars from one quantile to another about the marks, kept on the paper of a logarithmic axis.
  function bars(points, low, middle, high, ink) {
    if (!points.some((point) => low(point) !== null && high(point) !== null)) return undefined;
    const least = (value) => Math.max(value, ZERO);
    const end = (point, of) => (of(point) === null ? 0 : Math.abs(least(of(point)) - least(middle(point))));
    return { type: "data", symmetric: false, thickness: 1, width: 2, color: ink, array: points.map((point) => end(point, high)), arrayminus: points.map((point) => end(point, low)) };
  }

  // The broad line of a power law from one end to another.
  const fitted = (fit, ends, ink, group) => ({
    x: ends, y: ends.map((x) => 10 ** (fit.intercept + fit.slope * Math.log10(x))), mode: "lines", hoverinfo: "skip",
    showlegend: false, legendgroup: group, line: { color: ink, width: 5 }, opacity: 0.18,
  });

  function choices(select, values) {
    for (const value of values) if (value !== "") select.append(make("option", { value }, value));
  }

  // Draws now, when a control changes, when the theme does, and when the window becomes narrow or wide.
  function live(task, ...controls) {
    narrow.addEventListener("change", task);
    for (const id of controls) byId(id).addEventListener("change", task);
    document.addEventListener("themechange", task);
    task();
  }

  return { ZERO, colour, symbol, dash, plain, joined, layout, draw, bars, fitted, choices, live };
})();
