// Labs in a page that has no Python: each place becomes a lab, from what stands in `perceptObs`, compressed.
(() => {
  const bytesOf = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const viewOf = (text) => new DataView(bytesOf(text).buffer);
  const unpacked = (text) =>
    new Response(new Blob([bytesOf(text)]).stream().pipeThrough(new DecompressionStream("gzip"))).text();

  const inBytes = (_, value) => (value?.base64 === undefined ? value : viewOf(value.base64));
  const nameOf = ({ kind }) => kind.replace("_lab", "");

  /** What the page's address calls its labs: observer, points, and a second one observer-2. */
  const namesOf = (states) =>
    states.map((state, k) => {
      const before = states.slice(0, k).filter(({ kind }) => kind === state.kind).length;
      return before ? `${nameOf(state)}-${before + 1}` : nameOf(state);
    });

  /** A widget that nobody listens to: it holds what the lab is made of, and cannot save. */
  const widgetOf = (state) => ({ get: (name) => state[name], set: (name, value) => (state[name] = value), on() {}, off() {} });

  const open = async () => {
    const { bundle, texts } = window.perceptObs;
    const _esm = await unpacked(bundle);
    const lab = (await import(URL.createObjectURL(new Blob([_esm], { type: "text/javascript" })))).default;
    const places = [...document.querySelectorAll("[data-percept-obs]")];
    const states = places.map((place) => JSON.parse(place.querySelector("script").textContent, inBytes));
    const names = namesOf(states);
    for (const [k, state] of states.entries()) {
      places[k].replaceChildren();
      const address = { name: names[k], names };
      await lab.render({ model: widgetOf({ ...state, address, _esm, texts: viewOf(texts[state.texts]) }), el: places[k] });
    }
  };
  if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", open);
  else open();
})();
