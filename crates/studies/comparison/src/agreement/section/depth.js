// Error against depth: the marks of one family.
featherbench.ready(() => {
  const { byId, chunks } = featherbench;
  const [root, list] = [byId("depth-choices"), byId("depth-family")];
  const robots = chunks.get("overview")?.robots;
  if (!root || !list || !robots) return;
  // Marks without rows are gates.
  root.only = ({ rows }) => list.value === "" || !rows || robots[rows.replace("robot-", "")].family === list.value;
  list.addEventListener("change", () => { for (const drawing of root.querySelectorAll(".drawing")) drawing.place?.(); });
});
