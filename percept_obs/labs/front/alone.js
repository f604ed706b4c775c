// Labs in a page that has no Python: each place becomes a lab, from what stands in `perceptObs`, compressed.
(() => {
  const bytesOf = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const viewOf = (text) => new DataView(bytesOf(text).buffer);
  const unpacked = (text) =>
    new Response(new Blob([bytesOf(text)]).stream().pipeThrough(new DecompressionStream("gzip"))).text();

  /** A widget that nobody listens to: it holds what the lab is made of, and cannot save. */
  const widgetOf = (state) => ({ get: (name) => state[name], set: (name, value) => (state[name] = value), on() {}, off() {} });

  const open = async () => {
    const { bundle, texts } = window.perceptObs;
    const _esm = await unpacked(bundle);
    const lab = (await import(URL.createObjectURL(new Blob([_esm], { type: "text/javascript" })))).default;
    for (const place of document.querySelectorAll("[data-percept-obs]")) {
      const told = place.querySelector("script").textContent;
      const state = JSON.parse(told, (_, value) => (value?.base64 === undefined ? value : viewOf(value.base64)));
      place.replaceChildren();
      await lab.render({ model: widgetOf({ ...state, _esm, texts: viewOf(texts[state.texts]) }), el: place });
    }
  };
  if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", open);
  else open();
})();
