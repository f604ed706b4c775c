// Labs in a page that has no Python: each place becomes a lab, from what stands in `perceptObs`, compressed.
(() => {
  const unpacked = async (text) => {
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
  };

  /** A widget that nobody listens to: it holds what the lab is made of, and cannot save. */
  const widgetOf = (state) => ({ get: (name) => state[name], set: (name, value) => (state[name] = value), on() {}, off() {} });

  const open = async () => {
    const { bundle, texts } = window.perceptObs;
    const source = new Blob([await unpacked(bundle)], { type: "text/javascript" });
    const lab = (await import(URL.createObjectURL(source))).default;
    for (const place of document.querySelectorAll("[data-percept-obs]")) {
      const state = JSON.parse(place.querySelector("script").textContent);
      const bytes = Uint8Array.from(atob(texts[state.texts]), (letter) => letter.charCodeAt(0));
      place.replaceChildren();
      await lab.render({ model: widgetOf({ ...state, texts: new DataView(bytes.buffer) }), el: place });
    }
  };
  if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", open);
  else open();
})();
