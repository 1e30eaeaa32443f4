// Figures for papers: the button that copies a figure's data. Where the browser forbids the clipboard, the file with the data is beside it.
document.addEventListener("click", async (event) => {
  const button = event.target.closest("button.copy-data");
  if (!button) return;
  const words = "Copy data";
  try {
    const data = await featherbench.load("figure-data");
    await navigator.clipboard.writeText(data[button.dataset.figure]);
    button.textContent = "Copied";
  } catch {
    button.textContent = "Not allowed: save it instead";
  }
  setTimeout(() => { button.textContent = words; }, 1500);
});
