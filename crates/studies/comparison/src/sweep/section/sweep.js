// Quantile maps: which quantity and which quantile are shown.
featherbench.ready(() => {
  const { byId } = featherbench;
  const [quantity, quantile] = [byId("sweep-quantity"), byId("sweep-quantile")];
  if (!quantity || !quantile) return;

  // Digits lost: decades above 2⁻⁵², in the steps of the legend.
  const step = (error) => [1, 2, 4, 6, 9].filter((digits) => Math.log10(error / 2 ** -52) >= digits).length;

  function show() {
    for (const map of document.querySelectorAll("#sweep [data-quantity]")) map.hidden = map.dataset.quantity !== quantity.value;
    const at = Number(quantile.value);
    for (const spot of document.querySelectorAll("#sweep td[data-errors]")) {
      const error = Number(spot.dataset.errors.split(" ")[at]);
      spot.className = `d${step(error)}`;
      spot.firstElementChild.textContent = error === 0 ? "0" : error.toExponential(1);
    }
  }

  for (const control of [quantity, quantile]) control.addEventListener("change", show);
  show();
});
