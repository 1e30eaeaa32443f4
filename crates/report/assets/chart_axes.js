// Axes of charts: ranges, scales, ticks and their labels. Nothing here touches the page.
featherbench.axes = (() => {
  // Enough for every decade of a double; a loop over ticks ends here whatever its range is.
  const MOST = 700;

  // Exact, which 10 ** n is not everywhere.
  const ten = (n) => Number(`1e${n}`);

  // A logarithm needs a positive number.
  const fits = (log, value) => typeof value === "number" && Number.isFinite(value) && (!log || value > 0);

  // Ranges are in values on a linear axis, in decades on a logarithmic one.
  const inner = (log, value) => (log ? Math.log10(value) : value);

  // The range of all values that fit, with air at both ends; null where none fits.
  function range(log, values) {
    let [least, most] = [Infinity, -Infinity];
    for (const value of values) {
      if (!fits(log, value)) continue;
      const place = inner(log, value);
      [least, most] = [Math.min(least, place), Math.max(most, place)];
    }
    if (least > most) return null;
    // Values that are one up to rounding have a range without length: it is opened.
    const length = most - least > 1e-9 * Math.abs(most) ? most - least : 0;
    const air = length > 0 ? 0.05 * length : log ? 0.5 : 0.1 * Math.abs(most) || 1;
    return [least - air, most + air];
  }

  // From values to positions between two places on the screen, and back into the range.
  function scale(log, [least, most], from, to) {
    return {
      log, range: [least, most], from, to,
      at: (value) => from + ((to - from) * (inner(log, value) - least)) / (most - least),
      back: (position) => least + ((most - least) * (position - from)) / (to - from),
    };
  }

  // 1, 2 or 5 times a power of ten, at least as large as asked.
  function nice(least) {
    const unit = ten(Math.floor(Math.log10(least)));
    return unit * ([1, 2, 5].find((digit) => digit * unit >= least * (1 - 1e-9)) ?? 10);
  }

  function multiples(step, least, most) {
    const found = [];
    for (let n = Math.ceil(least / step - 1e-9), i = 0; n <= most / step + 1e-9 && i < MOST; n += 1, i += 1) {
      // 3 / 10 is 0.3, 3 · 0.1 is not.
      found.push(step < 1 ? n / Math.round(1 / step) : n * step);
    }
    return found;
  }

  function linear(least, most, count) {
    const step = nice((most - least) / count);
    return { major: multiples(step, least, most), minor: [] };
  }

  // Decades where there are many; 1, 2 and 5 where there is room; even steps of the value within less than a decade.
  function logarithmic(least, most, count) {
    const length = most - least;
    if (length < 0.5 || (length < 1 && count >= 8)) {
      const [low, high] = [10 ** least, 10 ** most];
      const step = nice((high - low) / count);
      const major = multiples(step, low, high);
      return { major, minor: multiples(step / 5, low, high).filter((value) => !major.some((other) => Math.abs(other - value) < step / 10)) };
    }
    const decades = multiples(1, Math.floor(least), most);
    const within = (value) => Math.log10(value) >= least - 1e-9 && Math.log10(value) <= most + 1e-9;
    const times = (digits) => decades.flatMap((decade) => digits.map((digit) => digit * ten(decade))).filter(within);
    if (length < 2 || 3 * length <= count) return { major: times([1, 2, 5]), minor: times([3, 4, 6, 7, 8, 9]) };
    const step = [1, 2, 3, 4, 5, 10, 20, 50, 100].find((decade) => length / decade <= count) ?? 200;
    const major = decades.filter((decade) => decade % step === 0).map(ten).filter(within);
    // Nine lines to a decade need more room than its label.
    if (step === 1) return { major, minor: times(2 * length <= count ? [2, 3, 4, 5, 6, 7, 8, 9] : [2, 5]) };
    return { major, minor: times([1]).filter((value) => !major.includes(value)) };
  }

  const ticks = (log, [least, most], count) => (log ? logarithmic : linear)(least, most, Math.max(2, count));

  // A number in full, with narrow spaces between thousands from ten thousand on.
  function full(value) {
    const text = String(Number(value.toPrecision(10))).replace("-", "−");
    return Math.abs(value) < 1e4 ? text : text.replace(/\B(?=(\d{3})+(?!\d))/g, "\u202f");
  }

  // A number as a power of ten: the text, and the exponent that stands above it.
  function power(value) {
    const exponent = Math.floor(Math.log10(Math.abs(value)) + 1e-9);
    const digits = Number((value / ten(exponent)).toPrecision(6));
    return [digits === 1 ? "10" : `${digits}×10`.replace("-", "−"), String(exponent).replace("-", "−")];
  }

  // All labels of an axis are of one kind: powers as soon as one number is too long in full.
  function labels(values) {
    const long = (value) => value !== 0 && (Math.abs(value) < 0.99e-4 || Math.abs(value) > 1.01e6);
    const powers = values.some(long);
    return values.map((value) => (powers && value !== 0 ? power(value) : [full(value)]));
  }

  return { fits, inner, range, scale, ticks, labels, power };
})();
