// A page with one lab, whose widget is spoken to by the test: what Python hands over stands in it.
import bundle from "/lab.js";

const given = STATE_OF_THE_LAB;
window.refused = [];
document.addEventListener("securitypolicyviolation", (event) => window.refused.push(event.violatedDirective));
const binary = (text) => new DataView(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
const frames = given.frames.map((film) => ({ ...film, images: film.images.map(binary) }));
const state = { ...given, texts: binary(given.texts), frames };
const listeners = {};
const TOLD = ["view", "settings", "summary"];
window.held = null;  // a list, while answers are to be held back
window.heard = (found) => {
    Object.assign(state, found);
    for (const name of Object.keys(found)) for (const hear of listeners[`change:${name}`] ?? []) hear();
};
const model = {
    get: (name) => state[name],
    set: (name, value) => (state[name] = value),
    save_changes: () => window.toPython?.(Object.fromEntries(TOLD.map((name) => [name, state[name] ?? {}])))
        .then((found) => (window.held ? window.held.push(found) : window.heard(found))),
    on: (event, listener) => (listeners[event] ??= []).push(listener),
    off: (event, listener) => (listeners[event] = listeners[event].filter((each) => each !== listener)),
};
bundle.render({ model, el: document.body });
