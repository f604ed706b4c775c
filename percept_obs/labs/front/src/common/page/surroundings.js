// What changes around a lab: the sizes of its pictures, and whether the page is dark.

/** Tell of sizes and themes from now on; returns what ends it. */
export function surround(root, { figures, onSize, onTheme }) {
  const sized = new ResizeObserver((entries) => {
    for (const { target, contentRect } of entries) onSize(target, { width: contentRect.width, height: contentRect.height });
  });
  for (const node of [...figures, root]) sized.observe(node);
  const scheme = window.matchMedia("(prefers-color-scheme: dark)");
  const retheme = () => {
    const light = document.body.dataset.jpThemeLight;
    root.classList.toggle("dark", light ? light === "false" : scheme.matches);
    onTheme();
  };
  retheme();
  const themed = new MutationObserver(retheme);
  themed.observe(document.body, { attributes: true, attributeFilter: ["data-jp-theme-light", "class"] });
  scheme.addEventListener("change", retheme);
  return () => {
    sized.disconnect();
    themed.disconnect();
    scheme.removeEventListener("change", retheme);
  };
}
